//! Assignability of types, and the join of two types.

use crate::ty::{Geometry, Member, StructTy, Ty};
use crate::units::Dim;
use rpi_syntax::Name;
use std::collections::BTreeMap;
use std::rc::Rc;

/// Bindings of the free names of a signature in one call: types and frames.
#[derive(Clone, Default, Debug)]
pub struct Subst {
    /// Static parameters that are types.
    pub types: BTreeMap<Name, Ty>,
    /// Frames that the signature names but no declaration does; none if not bound yet.
    pub frames: BTreeMap<Name, Option<Name>>,
}

/// Reason for a type mismatch.
#[derive(Clone, PartialEq, Debug)]
pub enum Misfit {
    /// Different kinds of types.
    Kind,
    /// Reals of different dimensions.
    Dimension {
        /// Expected dimension.
        expected: Dim,
        /// Dimension found.
        found: Dim,
    },
    /// Spatial values in different frames.
    Frame {
        /// Expected frame.
        expected: Name,
        /// Frame found.
        found: Name,
    },
    /// Arrays of different sizes.
    Size {
        /// Expected number of elements.
        expected: u32,
        /// Number of elements found.
        found: u32,
    },
}

impl Misfit {
    /// Returns the mismatch with expected and found exchanged.
    #[must_use]
    pub fn turned(self) -> Misfit {
        match self {
            Misfit::Kind => Misfit::Kind,
            Misfit::Dimension { expected, found } => Misfit::Dimension {
                expected: found,
                found: expected,
            },
            Misfit::Frame { expected, found } => Misfit::Frame {
                expected: found,
                found: expected,
            },
            Misfit::Size { expected, found } => Misfit::Size {
                expected: found,
                found: expected,
            },
        }
    }
}

/// Checks that `found` is assignable to `expected`. Free names of `expected` are bound in `subst`.
///
/// # Errors
/// Returns the reason for the mismatch.
pub fn fit(expected: &Ty, found: &Ty, subst: &mut Subst) -> Result<(), Misfit> {
    match (expected, found) {
        (Ty::Unknown, _) | (_, Ty::Unknown) => Ok(()),
        (Ty::Generic(name), found) => fit_generic(name, found, subst),
        (Ty::Int | Ty::Subrange(_), Ty::Int | Ty::Subrange(_)) => Ok(()),
        (Ty::Real(expected), Ty::Real(found)) => fit_dim(*expected, *found),
        (Ty::Spatial(a, expected), Ty::Spatial(b, found)) if a == b => {
            fit_geometry(expected, found, subst)
        }
        (Ty::Array(a, expected), Ty::Array(b, found)) => match expected == found {
            true => fit(a, b, subst),
            false => Err(Misfit::Size {
                expected: *expected,
                found: *found,
            }),
        },
        (Ty::Tuple(expected), Ty::Tuple(found)) => fit_tuples(expected, found, subst),
        (Ty::Struct(a), Ty::Struct(b)) if a.name == b.name || is_instance(b, a) => {
            fit_members(&a.fields, &b.fields, subst)
        }
        (Ty::Device(a), Ty::Device(b)) if a.name == b.name => Ok(()),
        _ if expected == found => Ok(()),
        _ => Err(Misfit::Kind),
    }
}

/// Returns whether a struct type is an instance of the generic declaration of another one whose parameters are not
/// bound.
fn is_instance(closed: &StructTy, open: &StructTy) -> bool {
    open.fields.iter().any(|field| field.ty.is_open()) && declared(closed) == declared(open)
}

/// Name of the struct's declaration, without static arguments.
fn declared(of: &StructTy) -> Option<&str> {
    of.name.split("<<").next()
}

fn fit_generic(name: &Name, found: &Ty, subst: &mut Subst) -> Result<(), Misfit> {
    match subst.types.get(name).cloned() {
        // Free names in `found` belong to the caller, even if they have the same name as a parameter here. So they are
        // not bound in `subst`.
        Some(bound) => fit(&bound, found, &mut Subst::default()),
        None => {
            subst.types.insert(name.clone(), found.clone().widened());
            Ok(())
        }
    }
}

fn fit_dim(expected: Dim, found: Dim) -> Result<(), Misfit> {
    match expected.meets(found) {
        true => Ok(()),
        false => Err(Misfit::Dimension { expected, found }),
    }
}

fn fit_geometry(expected: &Geometry, found: &Geometry, subst: &mut Subst) -> Result<(), Misfit> {
    if let (Some(a), Some(b)) = (expected.dim, found.dim) {
        fit_dim(a, b)?;
    }
    fit_frame(&expected.of, &found.of, subst)?;
    fit_frame(&expected.in_frame, &found.in_frame, subst)
}

fn fit_frame(
    expected: &Option<Name>,
    found: &Option<Name>,
    subst: &mut Subst,
) -> Result<(), Misfit> {
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
        Some(found) if *found != wanted => Err(Misfit::Frame {
            expected: wanted,
            found: found.clone(),
        }),
        _ => Ok(()),
    }
}

/// Tuples are flat: `(a, (b, c))` has the same leaves in the same order as `(a, b, c)`.
fn fit_tuples(expected: &[Member], found: &[Member], subst: &mut Subst) -> Result<(), Misfit> {
    if expected.len() == found.len() {
        // The flattened comparison below must start without the bindings of a failed attempt.
        let mut tried = subst.clone();
        let fits = fit_members(expected, found, &mut tried);
        let is_nested = |members: &[Member]| members.iter().any(|m| matches!(m.ty, Ty::Tuple(_)));
        if fits.is_ok() || !is_nested(expected) && !is_nested(found) {
            *subst = tried;
            return fits;
        }
    }
    let (mut wanted, mut given) = (Vec::new(), Vec::new());
    expected
        .iter()
        .for_each(|member| flat(&member.ty, &mut wanted));
    found.iter().for_each(|member| flat(&member.ty, &mut given));
    if wanted.len() != given.len() {
        return Err(Misfit::Kind);
    }
    let mut pairs = wanted.into_iter().zip(given);
    pairs.try_for_each(|(wanted, given)| fit(wanted, given, subst))
}

fn flat<'t>(ty: &'t Ty, parts: &mut Vec<&'t Ty>) {
    match ty {
        Ty::Tuple(members) => members.iter().for_each(|member| flat(&member.ty, parts)),
        other => parts.push(other),
    }
}

fn fit_members(expected: &[Member], found: &[Member], subst: &mut Subst) -> Result<(), Misfit> {
    if expected.len() != found.len() {
        return Err(Misfit::Kind);
    }
    let mut pairs = expected.iter().zip(found);
    pairs.try_for_each(|(a, b)| fit(&a.ty, &b.ty, subst))
}

/// Returns the type of a value that has both types. Parts unknown in one type are taken from the other.
///
/// # Errors
/// Returns the reason if the types do not match.
pub fn join(a: &Ty, b: &Ty) -> Result<Ty, Misfit> {
    fit(a, b, &mut Subst::default())?;
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

/// Returns the more specific of two compatible dimensions: an angle rather than a plain number.
fn join_dim(a: Dim, b: Dim) -> Dim {
    match a == Dim::ONE {
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
    /// Returns the type with the free names of a signature replaced by their bindings.
    #[must_use]
    pub fn substituted(&self, subst: &Subst) -> Ty {
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
    fn substituted(&self, subst: &Subst) -> Geometry {
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
        let mut none = Subst::default();
        assert_eq!(fit(&pose("", ""), &pose("a", "b"), &mut none), Ok(()));
        assert_eq!(fit(&pose("a", "b"), &pose("", ""), &mut none), Ok(()));
        assert!(matches!(
            fit(&pose("a", "b"), &pose("a", "c"), &mut none),
            Err(Misfit::Frame { .. })
        ));
        assert_eq!(join(&pose("a", ""), &pose("", "b")), Ok(pose("a", "b")));
    }

    #[test]
    fn free_frames_are_bound_by_the_first_argument() {
        let mut subst = Subst::default();
        subst.frames.insert("tool".into(), None);
        let wanted = pose("tool", "");
        assert_eq!(
            fit(&wanted, &pose("arm.tool", "arm.base"), &mut subst),
            Ok(())
        );
        assert!(fit(&wanted, &pose("other.tool", ""), &mut subst).is_err());
        assert_eq!(wanted.substituted(&subst), pose("arm.tool", ""));
    }

    #[test]
    fn type_parameters_are_bound_by_the_first_argument() {
        let mut subst = Subst::default();
        let t = Ty::Generic("t".into());
        assert_eq!(fit(&t, &Ty::Real(Dim::LENGTH), &mut subst), Ok(()));
        assert!(fit(&t, &Ty::REAL, &mut subst).is_err());
        assert_eq!(t.substituted(&subst), Ty::Real(Dim::LENGTH));
    }

    #[test]
    fn a_plain_number_takes_on_an_angle() {
        assert_eq!(
            join(&Ty::REAL, &Ty::Real(Dim::ANGLE)),
            Ok(Ty::Real(Dim::ANGLE))
        );
    }
}
