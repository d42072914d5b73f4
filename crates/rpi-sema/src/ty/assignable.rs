//! Assignability of types, and the join of two types.

use crate::ty::{Geometry, Member, StructTy, Ty};
use crate::units::Dimension;
use rpi_syntax::Name;
use std::collections::BTreeMap;
use std::rc::Rc;

/// Types and frames that one call gives to the names that the ports of a callee leave open.
#[derive(Clone, Default, Debug)]
pub struct Substitution {
    /// Type for each type parameter of the callee that is known so far.
    pub types: BTreeMap<Name, Ty>,
    /// Frame for each frame name that the ports of the callee do not declare; `None` if it is not known yet.
    pub frames: BTreeMap<Name, Option<Name>>,
}

/// Reason why a value of one type cannot be assigned where another type is expected.
#[derive(Clone, PartialEq, Debug)]
pub enum TypeMismatchError {
    /// The types are of different kinds, such as a real and a Boolean.
    Kind,
    /// The types are reals of different dimensions.
    Dimension {
        /// Dimension that the context requires.
        expected: Dimension,
        /// Dimension that the value has.
        found: Dimension,
    },
    /// The types are spatial values in different frames, or of different frames.
    Frame {
        /// Frame that the context requires.
        expected: Name,
        /// Frame that the value has.
        found: Name,
    },
    /// The types are arrays of different sizes.
    Size {
        /// Number of elements that the context requires.
        expected: u32,
        /// Number of elements that the value has.
        found: u32,
    },
}

impl TypeMismatchError {
    /// Returns the mismatch for the opposite direction, with the expected and the found type exchanged.
    #[must_use]
    pub fn swapped(self) -> TypeMismatchError {
        match self {
            TypeMismatchError::Kind => TypeMismatchError::Kind,
            TypeMismatchError::Dimension { expected, found } => TypeMismatchError::Dimension {
                expected: found,
                found: expected,
            },
            TypeMismatchError::Frame { expected, found } => TypeMismatchError::Frame {
                expected: found,
                found: expected,
            },
            TypeMismatchError::Size { expected, found } => TypeMismatchError::Size {
                expected: found,
                found: expected,
            },
        }
    }
}

/// Checks that a value of the type `found` can be assigned where `expected` is required. Type parameters and open
/// frames in `expected` get the types and frames of `found`, which are stored in `subst`.
///
/// # Errors
///
/// Returns the reason for the mismatch.
pub fn check_assignable(
    expected: &Ty,
    found: &Ty,
    subst: &mut Substitution,
) -> Result<(), TypeMismatchError> {
    match (expected, found) {
        (Ty::Unknown, _) | (_, Ty::Unknown) => Ok(()),
        (Ty::Generic(name), found) => assign_generic(name, found, subst),
        (Ty::Int | Ty::Subrange(_), Ty::Int | Ty::Subrange(_)) => Ok(()),
        (Ty::Real(expected), Ty::Real(found)) => check_dim(*expected, *found),
        (Ty::Spatial(a, expected), Ty::Spatial(b, found)) if a == b => {
            check_geometry(expected, found, subst)
        }
        (Ty::Array(a, expected), Ty::Array(b, found)) => match expected == found {
            true => check_assignable(a, b, subst),
            false => Err(TypeMismatchError::Size {
                expected: *expected,
                found: *found,
            }),
        },
        (Ty::Tuple(expected), Ty::Tuple(found)) => check_tuples(expected, found, subst),
        (Ty::Struct(a), Ty::Struct(b)) if a.name == b.name || is_instance(b, a) => {
            check_members(&a.fields, &b.fields, subst)
        }
        (Ty::Device(a), Ty::Device(b)) if a.name == b.name => Ok(()),
        _ if expected == found => Ok(()),
        _ => Err(TypeMismatchError::Kind),
    }
}

/// Returns whether the struct type `closed` is an instance of the generic struct `open`, whose type parameters are
/// still open.
fn is_instance(closed: &StructTy, open: &StructTy) -> bool {
    open.fields.iter().any(|field| field.ty.has_generic())
        && declaration_name(closed) == declaration_name(open)
}

/// Returns the name of a struct's declaration, without static arguments; `None` if it is empty.
fn declaration_name(of: &StructTy) -> Option<&str> {
    of.name.split("<<").next()
}

fn assign_generic(
    name: &Name,
    found: &Ty,
    subst: &mut Substitution,
) -> Result<(), TypeMismatchError> {
    match subst.types.get(name).cloned() {
        // Free names in `found` belong to the caller, even if they have the same name as a parameter here. So they are
        // not bound in `subst`.
        Some(bound) => check_assignable(&bound, found, &mut Substitution::default()),
        None => {
            subst.types.insert(name.clone(), found.clone().widened());
            Ok(())
        }
    }
}

fn check_dim(expected: Dimension, found: Dimension) -> Result<(), TypeMismatchError> {
    match expected.is_compatible(found) {
        true => Ok(()),
        false => Err(TypeMismatchError::Dimension { expected, found }),
    }
}

fn check_geometry(
    expected: &Geometry,
    found: &Geometry,
    subst: &mut Substitution,
) -> Result<(), TypeMismatchError> {
    if let (Some(a), Some(b)) = (expected.dim, found.dim) {
        check_dim(a, b)?;
    }
    check_frame(&expected.of, &found.of, subst)?;
    check_frame(&expected.in_frame, &found.in_frame, subst)
}

fn check_frame(
    expected: &Option<Name>,
    found: &Option<Name>,
    subst: &mut Substitution,
) -> Result<(), TypeMismatchError> {
    let Some(name) = expected else {
        return Ok(());
    };
    let wanted = match subst.frames.get_mut(name) {
        Some(bound @ None) => {
            bound.clone_from(found);
            return Ok(());
        }
        Some(Some(bound)) => bound.clone(),
        None => name.clone(),
    };
    match found {
        Some(found) if *found != wanted => Err(TypeMismatchError::Frame {
            expected: wanted,
            found: found.clone(),
        }),
        _ => Ok(()),
    }
}

/// Checks that a value of one tuple type can be assigned where another tuple type is required. Nesting does not matter:
/// `(a, (b, c))` has the same elements in the same order as `(a, b, c)`.
fn check_tuples(
    expected: &[Member],
    found: &[Member],
    subst: &mut Substitution,
) -> Result<(), TypeMismatchError> {
    if expected.len() == found.len() {
        // The flattened comparison below must start without the bindings of a failed attempt.
        let mut tried = subst.clone();
        let fits = check_members(expected, found, &mut tried);
        let is_nested = |members: &[Member]| members.iter().any(|m| matches!(m.ty, Ty::Tuple(_)));
        if fits.is_ok() || !is_nested(expected) && !is_nested(found) {
            *subst = tried;
            return fits;
        }
    }
    let (mut wanted, mut given) = (Vec::new(), Vec::new());
    expected
        .iter()
        .for_each(|member| flatten(&member.ty, &mut wanted));
    found
        .iter()
        .for_each(|member| flatten(&member.ty, &mut given));
    if wanted.len() != given.len() {
        return Err(TypeMismatchError::Kind);
    }
    let mut pairs = wanted.into_iter().zip(given);
    pairs.try_for_each(|(wanted, given)| check_assignable(wanted, given, subst))
}

fn flatten<'t>(ty: &'t Ty, parts: &mut Vec<&'t Ty>) {
    match ty {
        Ty::Tuple(members) => members.iter().for_each(|member| flatten(&member.ty, parts)),
        other => parts.push(other),
    }
}

fn check_members(
    expected: &[Member],
    found: &[Member],
    subst: &mut Substitution,
) -> Result<(), TypeMismatchError> {
    if expected.len() != found.len() {
        return Err(TypeMismatchError::Kind);
    }
    let mut pairs = expected.iter().zip(found);
    pairs.try_for_each(|(a, b)| check_assignable(&a.ty, &b.ty, subst))
}

/// Returns the common type of two values, such as the branches of an `if`. Parts that are unknown in one type are taken
/// from the other.
///
/// # Errors
///
/// Returns the reason if the types do not match.
pub fn join(a: &Ty, b: &Ty) -> Result<Ty, TypeMismatchError> {
    check_assignable(a, b, &mut Substitution::default())?;
    Ok(match (a, b) {
        (Ty::Unknown, known) => known.clone(),
        (Ty::Real(a), Ty::Real(b)) => Ty::Real(join_dim(*a, *b)),
        (Ty::Spatial(scalar, a), Ty::Spatial(_, b)) => {
            Ty::Spatial(*scalar, Rc::new(join_geometry(a, b)))
        }
        (Ty::Array(a, n), Ty::Array(b, _)) => Ty::Array(Rc::new(join(a, b)?), *n),
        (Ty::Tuple(a), Ty::Tuple(b)) if a.len() == b.len() => {
            let member = |(a, b): (&Member, &Member)| Member {
                name: a.name.clone(),
                ty: join(&a.ty, &b.ty).unwrap_or_else(|_| a.ty.clone()),
            };
            Ty::Tuple(a.iter().zip(b.iter()).map(member).collect())
        }
        _ => a.clone(),
    })
}

/// Returns the more specific of two compatible dimensions: an angle is more specific than a plain number.
fn join_dim(a: Dimension, b: Dimension) -> Dimension {
    match a == Dimension::ONE {
        true => b,
        false => a,
    }
}

fn join_geometry(a: &Geometry, b: &Geometry) -> Geometry {
    Geometry {
        dim: a.dim.or(b.dim),
        of: a.of.clone().or_else(|| b.of.clone()),
        in_frame: a.in_frame.clone().or_else(|| b.in_frame.clone()),
    }
}

impl Ty {
    /// Returns the type with type parameters and open frames replaced by those in `subst`. A type parameter without a
    /// type there becomes unknown.
    #[must_use]
    pub fn substituted(&self, subst: &Substitution) -> Ty {
        let members = |members: &[Member]| -> Vec<Member> {
            let member = |m: &Member| Member {
                name: m.name.clone(),
                ty: m.ty.substituted(subst),
            };
            members.iter().map(member).collect()
        };
        match self {
            Ty::Generic(name) => subst.types.get(name).cloned().unwrap_or(Ty::Unknown),
            Ty::Spatial(scalar, geometry) => {
                Ty::Spatial(*scalar, Rc::new(geometry.substituted(subst)))
            }
            Ty::Array(element, n) => Ty::Array(Rc::new(element.substituted(subst)), *n),
            Ty::Tuple(parts) => Ty::Tuple(members(parts).into()),
            Ty::Struct(s) => Ty::Struct(Rc::new(crate::ty::StructTy {
                name: s.name.clone(),
                fields: members(&s.fields),
                defaults: s.defaults.clone(),
            })),
            other => other.clone(),
        }
    }
}

impl Geometry {
    fn substituted(&self, subst: &Substitution) -> Geometry {
        let frame = |name: &Option<Name>| match name.as_ref().map(|n| (n, subst.frames.get(n))) {
            Some((_, Some(bound))) => bound.clone(),
            Some((name, None)) => Some(name.clone()),
            None => None,
        };
        Geometry {
            dim: self.dim,
            of: frame(&self.of),
            in_frame: frame(&self.in_frame),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rpi_image::Scalar;

    fn pose(of: &str, in_frame: &str) -> Ty {
        let name = |text: &str| (!text.is_empty()).then(|| Name::from(text));
        Ty::Spatial(
            Scalar::Pose,
            Rc::new(Geometry {
                dim: None,
                of: name(of),
                in_frame: name(in_frame),
            }),
        )
    }

    #[test]
    fn frames_that_are_left_out_meet_all_others_must_agree() {
        let mut none = Substitution::default();
        assert_eq!(
            check_assignable(&pose("", ""), &pose("a", "b"), &mut none),
            Ok(())
        );
        assert_eq!(
            check_assignable(&pose("a", "b"), &pose("", ""), &mut none),
            Ok(())
        );
        assert!(matches!(
            check_assignable(&pose("a", "b"), &pose("a", "c"), &mut none),
            Err(TypeMismatchError::Frame { .. })
        ));
        assert_eq!(join(&pose("a", ""), &pose("", "b")), Ok(pose("a", "b")));
    }

    #[test]
    fn free_frames_are_bound_by_the_first_argument() {
        let mut subst = Substitution::default();
        subst.frames.insert("tool".into(), None);
        let wanted = pose("tool", "");
        assert_eq!(
            check_assignable(&wanted, &pose("arm.tool", "arm.base"), &mut subst),
            Ok(())
        );
        assert!(check_assignable(&wanted, &pose("other.tool", ""), &mut subst).is_err());
        assert_eq!(wanted.substituted(&subst), pose("arm.tool", ""));
    }

    #[test]
    fn type_parameters_are_bound_by_the_first_argument() {
        let mut subst = Substitution::default();
        let t = Ty::Generic("t".into());
        assert_eq!(
            check_assignable(&t, &Ty::Real(Dimension::LENGTH), &mut subst),
            Ok(())
        );
        assert!(check_assignable(&t, &Ty::REAL, &mut subst).is_err());
        assert_eq!(t.substituted(&subst), Ty::Real(Dimension::LENGTH));
    }

    #[test]
    fn a_plain_number_takes_on_an_angle() {
        assert_eq!(
            join(&Ty::REAL, &Ty::Real(Dimension::ANGLE)),
            Ok(Ty::Real(Dimension::ANGLE))
        );
    }
}
