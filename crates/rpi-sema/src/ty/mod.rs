//! Types of flows: what a value is, without whether it is present.
//!
//! Composite types are exploded into their [leaves](Ty::leaves) when a program becomes a net; nothing after the
//! elaboration knows of them. This module must not know syntax.

mod fit;
mod machine;
mod print;
mod subrange;

pub use fit::{Misfit, Subst, fit, join};
pub use machine::MachineInt;
pub use subrange::Subrange;

use crate::units::Dim;
use rpi_image::{Scalar, Value};
use rpi_syntax::Name;
use std::rc::Rc;

/// The type of a flow, a constant or a port.
#[derive(Clone, PartialEq, Debug)]
pub enum Ty {
    /// Not known, after a fault or for `none`: fits everything, so that one fault gives one message.
    Unknown,
    /// Truth value.
    Bool,
    /// 64-bit integer.
    Int,
    /// Machine integer of Kind 2, in Lustre only.
    Machine(MachineInt),
    /// `subrange [0, 7] of int`: what is declared so. The value of an expression is an `int`.
    Subrange(Subrange),
    /// IEEE double of a dimension, in coherent SI units.
    Real(Dim),
    /// Point in time.
    Time,
    /// Exact time, `time`: a count of ticks.
    Duration,
    /// Text: parameters only.
    Text,
    /// `Vector`, `Rotation`, `Pose`, `Twist`, `Wrench` with what is known of its geometry.
    Spatial(Scalar, Rc<Geometry>),
    /// One of several named values.
    Enum(Rc<EnumTy>),
    /// Named fields.
    Struct(Rc<StructTy>),
    /// So many elements.
    Array(Rc<Ty>, u32),
    /// What a call with several out-ports gives; out-ports have names, elements of `(x, y)` have none.
    Tuple(Rc<[Member]>),
    /// A device that a command names.
    Device(Rc<DeviceTy>),
    /// How a command ended: the value of `predecessor`.
    Result,
    /// A static parameter that is a type, before it is known.
    Generic(Name),
}

/// What is known of a spatial value. Unknown parts meet everything.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Geometry {
    /// Dimension of a vector's components.
    pub dim: Option<Dim>,
    /// The frame that is located or that moves.
    pub of: Option<Name>,
    /// The frame in which it is given.
    pub in_frame: Option<Name>,
}

/// An enum.
#[derive(PartialEq, Eq, Debug)]
pub struct EnumTy {
    /// Its name.
    pub name: Name,
    /// Its values in text order.
    pub values: Vec<Name>,
    /// Their places, by name.
    by_name: Vec<u32>,
}

impl EnumTy {
    /// An enum with these values.
    #[must_use]
    pub fn new(name: Name, values: Vec<Name>) -> EnumTy {
        let mut by_name: Vec<u32> = (0..).take(values.len()).collect();
        by_name.sort_by_key(|place| values[*place as usize].as_str());
        EnumTy {
            name,
            values,
            by_name,
        }
    }

    /// The place of a value: the number that stands for it.
    #[must_use]
    pub fn place_of(&self, value: &str) -> Option<u32> {
        let name = |place: &u32| self.values[*place as usize].as_str();
        let at = self.by_name.partition_point(|place| name(place) < value);
        let place = self.by_name.get(at)?;
        (name(place) == value).then_some(*place)
    }
}

/// A struct with its static parameters resolved.
#[derive(PartialEq, Debug)]
pub struct StructTy {
    /// Its name.
    pub name: Name,
    /// Its fields in text order.
    pub fields: Vec<Member>,
    /// What a field is where a value leaves it out, leaf by leaf.
    pub defaults: Vec<Option<Rc<[Value]>>>,
}

/// A field of a struct, or an element of a tuple.
#[derive(Clone, PartialEq, Debug)]
pub struct Member {
    /// The name; none for an element of `(x, y)`.
    pub name: Option<Name>,
    /// The type.
    pub ty: Ty,
}

/// A device type with its static parameters resolved.
#[derive(PartialEq, Debug)]
pub struct DeviceTy {
    /// Its name.
    pub name: Name,
    /// Its ports in text order.
    pub ports: Vec<DevicePortTy>,
    /// Frames that its ports name and no declaration does: each device has its own.
    pub frames: Vec<Name>,
}

/// A port of a device type.
#[derive(PartialEq, Debug)]
pub struct DevicePortTy {
    /// The name.
    pub name: Name,
    /// What it carries; none if its size is known only with the cell.
    pub ty: Option<Ty>,
    /// Whether it may have no sample in a cycle.
    pub optional: bool,
    /// Whether it is written.
    pub is_actuator: bool,
    /// Which actuator of the device it belongs to: ports with the same number exclude one another.
    pub actuator: u32,
}

impl DeviceTy {
    /// The port of this name.
    #[must_use]
    pub fn port(&self, name: &str) -> Option<&DevicePortTy> {
        self.ports.iter().find(|port| port.name == name)
    }
}

impl Ty {
    /// A plain number.
    pub const REAL: Ty = Ty::Real(Dim::ONE);

    /// A spatial type of which nothing more is known.
    #[must_use]
    pub fn spatial(scalar: Scalar) -> Ty {
        Ty::Spatial(scalar, Rc::default())
    }

    /// A tuple of unnamed elements.
    #[must_use]
    pub fn tuple(elements: impl IntoIterator<Item = Ty>) -> Ty {
        let member = |ty| Member { name: None, ty };
        Ty::Tuple(elements.into_iter().map(member).collect())
    }

    /// Whether nothing is known of it.
    #[must_use]
    pub fn is_unknown(&self) -> bool {
        matches!(self, Ty::Unknown)
    }

    /// Whether some part of it is not known.
    #[must_use]
    pub fn has_unknown(&self) -> bool {
        match self {
            Ty::Unknown => true,
            Ty::Array(element, _) => element.has_unknown(),
            _ => self.members().iter().any(|member| member.ty.has_unknown()),
        }
    }

    /// Whether a type parameter stands in it.
    #[must_use]
    pub fn is_open(&self) -> bool {
        match self {
            Ty::Generic(_) => true,
            Ty::Array(element, _) => element.is_open(),
            _ => self.members().iter().any(|member| member.ty.is_open()),
        }
    }

    /// Fields of a struct, elements of a tuple.
    #[must_use]
    pub fn members(&self) -> &[Member] {
        match self {
            Ty::Struct(s) => &s.fields,
            Ty::Tuple(members) => members,
            _ => &[],
        }
    }

    /// The machine type of a value that is carried by one link.
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

    /// Number of links that carry a value of this type.
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
    pub fn leaves(&self, visit: &mut impl FnMut(&str, &Ty)) {
        self.leaves_below(&mut String::new(), visit);
    }

    /// The path of the part that begins at a leaf and has so many: `[2].x`, `[1..3]`.
    #[must_use]
    pub fn path_of(&self, mut at: usize, count: usize) -> String {
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

    /// The member that a leaf belongs to, and its first leaf.
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
        ty.leaves(&mut |path, leaf| seen.push(format!("{path}: {leaf}")));
        assert_eq!(
            seen,
            ["[0].x: int", "[0].on: bool", "[1].x: int", "[1].on: bool"]
        );
        assert_eq!(ty.leaf_count(), 4);
        let parts = [(0, 4), (1, 1), (2, 2), (3, 1)].map(|(at, count)| ty.path_of(at, count));
        assert_eq!(parts, ["", "[0].on", "[1]", "[1].on"]);
        assert_eq!(Ty::Array(Rc::new(Ty::Int), 5).path_of(1, 3), "[1..3]");
    }
}
