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
    /// Unknown type, after an error or for `none` (absent value). It matches every type, so that one error gives one
    /// diagnostic.
    Unknown,
    /// Type `bool` of truth values.
    Bool,
    /// Type `int`: 64-bit signed integers.
    Int,
    /// Machine integer of Kind 2, with a fixed number of bits. It exists only in Lustre.
    Machine(MachineInt),
    /// Integers in a range, as in `subrange [0, 7] of int`. Only declarations have this type: an expression that reads
    /// such a flow has the type `int`.
    Subrange(Subrange),
    /// 64-bit floating-point number with a physical dimension. The value is in coherent SI units.
    Real(Dimension),
    /// Point in time, as primitives provide it.
    Time,
    /// Type `time`: a duration that is a whole number of ticks (exact time).
    Duration,
    /// Type `text`, only for parameters.
    Text,
    /// Spatial value (`Vector`, `Rotation`, `Pose`, `Twist` or `Wrench`), with its unit and frames as far as they are
    /// known.
    Spatial(Scalar, Rc<Geometry>),
    /// Type with a fixed list of named values.
    Enum(Rc<EnumTy>),
    /// Struct type with named fields.
    Struct(Rc<StructTy>),
    /// Array type: element type and number of elements.
    Array(Rc<Ty>, u32),
    /// Tuple type. The results of a call with several outputs have such a type, in which the elements have the names of
    /// the outputs. Elements of `(x, y)` have no names.
    Tuple(Rc<[Member]>),
    /// Device type, only for parameters, such as those of a command.
    Device(Rc<DeviceTy>),
    /// Type of the predeclared flow `predecessor`: the result with which the preceding command ended.
    Result,
    /// Type parameter with this name, for which no type is known yet.
    Generic(Name),
}

/// Unit and frames of a spatial value, as far as they are known. A part that is `None` is unknown and matches
/// everything.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Geometry {
    /// Physical dimension of a vector's components; `None` if it is unknown or the value is no vector.
    pub dim: Option<Dimension>,
    /// Frame whose position, orientation or velocity the value describes; `None` if it is unknown.
    pub of: Option<Name>,
    /// Frame in whose coordinates the value is given; `None` if it is unknown.
    pub in_frame: Option<Name>,
}

/// Type with a fixed list of named values.
#[derive(PartialEq, Eq, Debug)]
pub struct EnumTy {
    /// Name of the enum.
    pub name: Name,
    /// Names of the values in text order. The index of a value represents it at run time.
    pub values: Vec<Name>,
    /// Indices of the values, sorted by the names of the values, for a binary search.
    indices_by_name: Vec<u32>,
}

impl EnumTy {
    /// Creates an enum with these values, given in text order.
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

    /// Returns the index of a value, which represents it at run time; `None` if the enum has no value with this name.
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

/// Struct type, for one choice of its type arguments.
#[derive(PartialEq, Debug)]
pub struct StructTy {
    /// Name of the struct with its type arguments.
    pub name: Name,
    /// Fields of the struct, in text order.
    pub fields: Vec<Member>,
    /// Default of each field as the values of its leaves (scalar parts); `None` for a field without a default.
    pub defaults: Vec<Option<Rc<[Value]>>>,
}

/// Field of a struct, element of a tuple, or output of a call.
#[derive(Clone, PartialEq, Debug)]
pub struct Member {
    /// Name of the field or output; `None` for an element of a tuple `(x, y)`.
    pub name: Option<Name>,
    /// Type of the field, element or output.
    pub ty: Ty,
}

/// Device type, for one choice of its static arguments.
#[derive(PartialEq, Debug)]
pub struct DeviceTy {
    /// Name of the device type.
    pub name: Name,
    /// Actuator, sensor and status ports in text order.
    pub ports: Vec<DevicePortTy>,
    /// Names of frames in the types of the ports that are not declared. Each device has frames of its own with these
    /// names, such as `arm.tcp`.
    pub frames: Vec<Name>,
    /// Values of the static parameters in the order of their declaration; `None` for a parameter whose value only the
    /// cell description gives.
    pub sizes: Vec<Option<u32>>,
}

/// Actuator, sensor or status port of a device type.
#[derive(PartialEq, Debug)]
pub struct DevicePortTy {
    /// Name of the port.
    pub name: Name,
    /// Type of the port; `None` if an array size in it is known only from the cell description.
    pub ty: Option<Ty>,
    /// Whether the port may have no value in a cycle.
    pub optional: bool,
    /// Whether the port is an actuator port, which commands write. Other ports are read.
    pub is_actuator: bool,
    /// Number of the actuator that the port drives. Ports with the same number exclude one another in a cycle. It has
    /// no meaning for ports that are read.
    pub actuator: u32,
}

impl DeviceTy {
    /// Returns the actuator, sensor or status port with this name; `None` if there is none.
    #[must_use]
    pub fn port(&self, name: &str) -> Option<&DevicePortTy> {
        self.ports.iter().find(|port| port.name == name)
    }
}

impl Ty {
    /// Type of reals without a unit.
    pub const REAL: Ty = Ty::Real(Dimension::ONE);

    /// Returns the type of spatial values of this machine type, with unknown unit and frames.
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

    /// Returns whether the type is unknown or contains an unknown type.
    #[must_use]
    pub fn has_unknown(&self) -> bool {
        match self {
            Ty::Unknown => true,
            Ty::Array(element, _) => element.has_unknown(),
            _ => self.members().iter().any(|member| member.ty.has_unknown()),
        }
    }

    /// Returns whether the type contains a type parameter for which no type is known yet.
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

    /// Returns the machine type of a type with a single leaf (scalar part); `None` for other types.
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

    /// Returns the number of leaves (scalar parts) of a value of the type, each carried by one link of the net; 0 for
    /// an unknown type.
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

    /// Calls `visit` with the path (such as `.x[2]`) and type of each leaf (scalar part), in order.
    pub fn for_each_leaf(&self, visit: &mut impl FnMut(&str, &Ty)) {
        self.leaves_below(&mut String::new(), visit);
    }

    /// Returns the path of the part that consists of `count` leaves (scalar parts) from leaf `at` on, such as `[2].x`
    /// or `[1..3]`.
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

    /// Returns the member that contains the leaf (scalar part) with index `at`, and the index of that member's first
    /// leaf; `None` if there is none.
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
