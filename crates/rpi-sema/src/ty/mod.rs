//! Types of flows, without their presence.
//!
//! Composite types are split into their [leaves](Ty::for_each_leaf) when a program is elaborated to a net. Nothing after the
//! elaboration knows composite types. This module must not know syntax.

pub(crate) mod assignable;
pub(crate) mod machine_int;
pub(crate) mod machine_types;
mod print;
pub(crate) mod subrange;

pub use crate::ty::assignable::{Substitution, TypeMismatchError, check_assignable, join};
pub use crate::ty::machine_int::MachineInt;
pub use subrange::Subrange;

use crate::units::Dimension;
use rpi_image::{Scalar, Value};
use rpi_syntax::Name;
use std::rc::Rc;

/// Type of a flow, a constant or a port.
#[derive(Clone, PartialEq, Debug)]
pub enum Ty {
    /// Unknown type, after an error or for `none`. It matches every type, so that one error causes one message.
    Unknown,
    /// Type `bool`.
    Bool,
    /// Type `int`: 64-bit signed integers.
    Int,
    /// Machine integer of Kind 2, only in Lustre.
    Machine(MachineInt),
    /// `subrange [0, 7] of int`. Only declarations have this type: an expression that reads such a flow is an `int`.
    Subrange(Subrange),
    /// IEEE 754 double with a dimension, in coherent SI units.
    Real(Dimension),
    /// Type of a point in time.
    Time,
    /// Type `time`: a duration in ticks.
    Duration,
    /// Type of texts, only for parameters.
    Text,
    /// `Vector`, `Rotation`, `Pose`, `Twist` or `Wrench`, with its known geometry.
    Spatial(Scalar, Rc<Geometry>),
    /// Enum type.
    Enum(Rc<EnumTy>),
    /// Struct type.
    Struct(Rc<StructTy>),
    /// Array type: element type and number of elements.
    Array(Rc<Ty>, u32),
    /// Tuple type, also that of the results of a call with several outputs. Outputs have names, elements of `(x, y)`
    /// have none.
    Tuple(Rc<[Member]>),
    /// Device type, only for parameters of a command.
    Device(Rc<DeviceTy>),
    /// Type of `predecessor`: the result with which a command ended.
    Result,
    /// Static type parameter that is not bound yet.
    Generic(Name),
}

/// Unit and frames of a spatial value, as far as they are known. An unknown part matches everything.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Geometry {
    /// Dimension of a vector's components.
    pub dim: Option<Dimension>,
    /// Frame whose position, orientation or velocity the value describes.
    pub of: Option<Name>,
    /// Frame in whose coordinates the value is given.
    pub in_frame: Option<Name>,
}

/// Type with a fixed list of named values.
#[derive(PartialEq, Eq, Debug)]
pub struct EnumTy {
    /// Name of the enum.
    pub name: Name,
    /// Values in text order.
    pub values: Vec<Name>,
    /// Indices of the values, sorted by name.
    indices_by_name: Vec<u32>,
}

impl EnumTy {
    /// Creates an enum with these values.
    #[must_use]
    pub fn new(name: Name, values: Vec<Name>) -> EnumTy {
        let mut by_name: Vec<u32> = (0..).take(values.len()).collect();
        by_name.sort_by_key(|place| values[*place as usize].as_str());
        EnumTy {
            name,
            values,
            indices_by_name: by_name,
        }
    }

    /// Returns the index of a value, which represents it at run time.
    #[must_use]
    pub fn index_of(&self, value: &str) -> Option<u32> {
        let name = |place: &u32| self.values[*place as usize].as_str();
        let at = self
            .indices_by_name
            .partition_point(|place| name(place) < value);
        let place = self.indices_by_name.get(at)?;
        (name(place) == value).then_some(*place)
    }
}

/// Struct type with its static parameters bound.
#[derive(PartialEq, Debug)]
pub struct StructTy {
    /// Name of the struct.
    pub name: Name,
    /// Fields in text order.
    pub fields: Vec<Member>,
    /// Default of each field, leaf by leaf; none for a field without a default.
    pub defaults: Vec<Option<Rc<[Value]>>>,
}

/// Field of a struct, or element of a tuple.
#[derive(Clone, PartialEq, Debug)]
pub struct Member {
    /// Name; none for an element of `(x, y)`.
    pub name: Option<Name>,
    /// Type.
    pub ty: Ty,
}

/// Device type with its static parameters bound.
#[derive(PartialEq, Debug)]
pub struct DeviceTy {
    /// Name of the device type.
    pub name: Name,
    /// Ports in text order.
    pub ports: Vec<DevicePortTy>,
    /// Frames that its ports name but no declaration does. Each device has its own frames of these names.
    pub frames: Vec<Name>,
    /// Values of the device type's static parameters, in the order of their declaration; none if only the robot cell
    /// gives it.
    pub sizes: Vec<Option<u32>>,
}

/// Port of a device type.
#[derive(PartialEq, Debug)]
pub struct DevicePortTy {
    /// Name of the port.
    pub name: Name,
    /// Type of the port; none if its size is known only with the robot cell.
    pub ty: Option<Ty>,
    /// Whether the port may have no sample in a cycle.
    pub optional: bool,
    /// Whether the port is an actuator port, which programs write.
    pub is_actuator: bool,
    /// Index of the actuator that the port drives. Ports with the same actuator exclude one another.
    pub actuator: u32,
}

impl DeviceTy {
    /// Returns the actuator, sensor or status port of a device type with this name.
    #[must_use]
    pub fn port(&self, name: &str) -> Option<&DevicePortTy> {
        self.ports.iter().find(|port| port.name == name)
    }
}

impl Ty {
    /// Dimensionless real.
    pub const REAL: Ty = Ty::Real(Dimension::ONE);

    /// Returns a spatial type with unknown unit and frames.
    #[must_use]
    pub fn spatial(scalar: Scalar) -> Ty {
        Ty::Spatial(scalar, Rc::default())
    }

    /// Returns a tuple type of unnamed elements.
    #[must_use]
    pub fn tuple(elements: impl IntoIterator<Item = Ty>) -> Ty {
        let member = |ty| Member { name: None, ty };
        Ty::Tuple(elements.into_iter().map(member).collect())
    }

    /// Returns whether the type is unknown.
    #[must_use]
    pub fn is_unknown(&self) -> bool {
        matches!(self, Ty::Unknown)
    }

    /// Returns whether the type or a part of it is unknown.
    #[must_use]
    pub fn has_unknown(&self) -> bool {
        match self {
            Ty::Unknown => true,
            Ty::Array(element, _) => element.has_unknown(),
            _ => self.members().iter().any(|member| member.ty.has_unknown()),
        }
    }

    /// Returns whether the type contains an unbound type parameter.
    #[must_use]
    pub fn has_generic(&self) -> bool {
        match self {
            Ty::Generic(_) => true,
            Ty::Array(element, _) => element.has_generic(),
            _ => self.members().iter().any(|member| member.ty.has_generic()),
        }
    }

    /// Returns the fields of a struct or the elements of a tuple; empty for other types.
    #[must_use]
    pub fn members(&self) -> &[Member] {
        match self {
            Ty::Struct(s) => &s.fields,
            Ty::Tuple(members) => members,
            _ => &[],
        }
    }

    /// Returns the machine type of a type with a single leaf; none for other types.
    #[must_use]
    pub fn scalar(&self) -> Option<Scalar> {
        Some(match self {
            Ty::Bool => Scalar::Bool,
            Ty::Int | Ty::Machine(_) | Ty::Subrange(_) => Scalar::Int,
            Ty::Duration | Ty::Enum(_) | Ty::Result => Scalar::Int,
            Ty::Real(_) => Scalar::Real,
            Ty::Time => Scalar::Time,
            Ty::Spatial(scalar, _) => *scalar,
            _ => return None,
        })
    }

    /// Returns the number of leaves (scalar parts) of the type, each carried by one link of the net.
    #[must_use]
    pub fn leaf_count(&self) -> usize {
        match self {
            Ty::Unknown | Ty::Generic(_) => 0,
            Ty::Array(element, n) => element.leaf_count().saturating_mul(*n as usize),
            Ty::Struct(_) | Ty::Tuple(_) => {
                let counts = self.members().iter().map(|member| member.ty.leaf_count());
                counts.fold(0, usize::saturating_add)
            }
            _ => 1,
        }
    }

    /// Calls `visit` with each leaf's path (`.x[2]`) and type, in order.
    pub fn for_each_leaf(&self, visit: &mut impl FnMut(&str, &Ty)) {
        self.leaves_below(&mut String::new(), visit);
    }

    /// Returns the path of the part with `count` leaves from leaf `at` on: `[2].x`, `[1..3]`.
    #[must_use]
    pub fn part_path(&self, mut at: usize, count: usize) -> String {
        let (mut ty, mut path) = (self, String::new());
        while at != 0 || ty.leaf_count() != count {
            let (inner, first) = match ty {
                Ty::Array(element, _) => {
                    let size = element.leaf_count().max(1);
                    let (k, last) = (at / size, (at + count.max(1) - 1) / size);
                    if k != last {
                        return format!("{path}[{k}..{last}]");
                    }
                    path.push_str(&format!("[{k}]"));
                    (&**element, k * size)
                }
                Ty::Struct(_) | Ty::Tuple(_) => match ty.member_at(at) {
                    Some((member, first)) => {
                        let name = member.name.as_deref().unwrap_or_default();
                        path.push_str(&format!(".{name}"));
                        (&member.ty, first)
                    }
                    None => return path,
                },
                _ => return path,
            };
            (ty, at) = (inner, at - first);
        }
        path
    }

    /// Returns the member that contains a leaf, and the index of that member's first leaf.
    fn member_at(&self, at: usize) -> Option<(&Member, usize)> {
        let mut first = 0;
        self.members().iter().find_map(|member| {
            let begins = first;
            first += member.ty.leaf_count();
            (at < first).then_some((member, begins))
        })
    }

    fn leaves_below(&self, path: &mut String, visit: &mut impl FnMut(&str, &Ty)) {
        let length = path.len();
        match self {
            Ty::Unknown | Ty::Generic(_) => {}
            Ty::Array(element, n) => {
                for k in 0..*n {
                    path.push_str(&format!("[{k}]"));
                    element.leaves_below(path, visit);
                    path.truncate(length);
                }
            }
            Ty::Struct(_) | Ty::Tuple(_) => {
                for (k, member) in self.members().iter().enumerate() {
                    match &member.name {
                        Some(name) => path.push_str(&format!(".{name}")),
                        None => path.push_str(&format!(".{k}")),
                    }
                    member.ty.leaves_below(path, visit);
                    path.truncate(length);
                }
            }
            leaf => visit(path, leaf),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn leaves_have_paths() {
        let inner = Ty::Tuple(
            [
                Member {
                    name: Some("x".into()),
                    ty: Ty::Int,
                },
                Member {
                    name: Some("on".into()),
                    ty: Ty::Bool,
                },
            ]
            .into(),
        );
        let ty = Ty::Array(Rc::new(inner), 2);
        let mut seen = Vec::new();
        ty.for_each_leaf(&mut |path, leaf| seen.push(format!("{path}: {leaf}")));
        assert_eq!(
            seen,
            ["[0].x: int", "[0].on: bool", "[1].x: int", "[1].on: bool"]
        );
        assert_eq!(ty.leaf_count(), 4);
        let parts = [(0, 4), (1, 1), (2, 2), (3, 1)].map(|(at, count)| ty.part_path(at, count));
        assert_eq!(parts, ["", "[0].on", "[1]", "[1].on"]);
        assert_eq!(Ty::Array(Rc::new(Ty::Int), 5).part_path(1, 3), "[1..3]");
    }
}
