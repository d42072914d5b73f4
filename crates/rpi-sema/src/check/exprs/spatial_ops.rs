//! Operators on vectors, rotations and poses in call syntax: units and frames of their results.
//!
//! A vector has one unit for its three components, and one frame in which they are expressed.

use crate::check::bodies::body::Body;
use crate::check::bodies::statement;
use crate::check::calls::prim;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::ExpectationReason;
use crate::check::signatures::static_args;
use crate::ty::{Geometry, Ty, join};
use crate::typed::ExprId;
use crate::units::Dimension;
use rpi_diag::{Code, Diagnostic, Span};
use rpi_image::Scalar;
use rpi_net::prim;
use rpi_prims::PrimId;
use rpi_syntax::ast::StaticArg;
use std::rc::Rc;

/// Operator on vectors, rotations and poses in call syntax.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) enum SpatialOp {
    /// `vector(x, y, z)`: vector of three reals with the same unit.
    Vector,
    /// `dot(a, b)`: scalar product; the units are multiplied.
    Dot,
    /// `cross(a, b)`: vector product; the units are multiplied.
    Cross,
    /// `norm(v)`: length of a vector, in its own unit.
    Norm,
    /// `inverse(p)`: the inverse of a pose or rotation. The pose of `a` in `b` gives the pose of `b` in `a`.
    Inverse,
}

/// Table of the spatial operators: operator, name, number of operands, and description for help texts.
const SPATIAL_OPS: &[(SpatialOp, &str, usize, &str)] = &[
    (
        SpatialOp::Vector,
        "vector",
        3,
        "`vector(x, y, z)`: three reals of one unit",
    ),
    (SpatialOp::Dot, "dot", 2, "`dot(a, b)`: two vectors"),
    (SpatialOp::Cross, "cross", 2, "`cross(a, b)`: two vectors"),
    (SpatialOp::Norm, "norm", 1, "`norm(v)`: a vector"),
    (
        SpatialOp::Inverse,
        "inverse",
        1,
        "`inverse(p)`: a pose or a rotation",
    ),
];

impl SpatialOp {
    fn entry(self) -> &'static (SpatialOp, &'static str, usize, &'static str) {
        let row = SPATIAL_OPS.iter().find(|row| row.0 == self);
        row.unwrap_or(&SPATIAL_OPS[0])
    }

    pub(crate) fn name(self) -> &'static str {
        self.entry().1
    }

    pub(crate) fn operand_count(self) -> usize {
        self.entry().2
    }

    pub(crate) fn usage(self) -> &'static str {
        self.entry().3
    }
}

/// Returns the dimension in the static argument of a spatial type, as in `Vector<<real[m/s]>>`. `None` without static
/// arguments or after an error. Spatial types other than vectors take no static arguments.
pub(crate) fn component_dim<'a>(
    cx: &mut Body<'_, 'a>,
    scalar: Scalar,
    statics: &'a [StaticArg],
) -> Option<Dimension> {
    let [of, more @ ..] = statics else {
        return None;
    };
    let ty = static_args::static_type(cx, of)?;
    match (scalar, ty, more) {
        (Scalar::Vector, Ty::Real(dim), []) => return Some(dim),
        (_, Ty::Unknown, _) => return None,
        _ => {}
    }
    let (message, label, help) = match scalar {
        Scalar::Vector => (
            "the components of a vector must be reals".to_owned(),
            "not a type of reals",
            "give the type of the components, such as `Vector<<real[m/s]>>` for a velocity"
                .to_owned(),
        ),
        _ => (
            format!("`{scalar}` has no static arguments"),
            "unexpected static argument",
            format!("write `{scalar}` alone"),
        ),
    };
    let diagnostic = Diagnostic::new(Code::RPI1010, message)
        .primary(of.span, label)
        .help(help);
    report::report_diagnostic(cx, diagnostic);
    None
}

/// Checks an operator on spatial values and returns its typed expression. The caller has checked the number of
/// operands.
pub(crate) fn spatial_op(
    cx: &mut Body<'_, '_>,
    op: SpatialOp,
    operands: &[ExprId],
    span: Span,
) -> ExprId {
    match op {
        SpatialOp::Vector => vector_op(cx, operands, span),
        SpatialOp::Inverse => inverse(cx, operands[0], span),
        SpatialOp::Norm => match common_vector_geometry(cx, operands) {
            Some(of) => {
                let ty = Ty::Real(of.dim.unwrap_or(Dimension::ONE));
                prim::add_prim(cx, prim!("Rpi::VectorNorm"), operands, ty, span)
            }
            None => cx.error_expr(span),
        },
        SpatialOp::Dot => vector_product(cx, prim!("World::VectorDot"), operands, span),
        SpatialOp::Cross => vector_product(cx, prim!("World::VectorCross"), operands, span),
    }
}

fn vector_op(cx: &mut Body<'_, '_>, parts: &[ExprId], span: Span) -> ExprId {
    let Ty::Real(dim) = *cx.ty_of(parts[0]) else {
        statement::expect_type(cx, parts[0], &Ty::REAL, &ExpectationReason::Unexplained);
        return cx.error_expr(span);
    };
    let fits: Vec<bool> = parts[1..]
        .iter()
        .map(|part| {
            statement::expect_type(cx, *part, &Ty::Real(dim), &ExpectationReason::Unexplained)
        })
        .collect();
    if fits.contains(&false) {
        return cx.error_expr(span);
    }
    let geometry = Geometry {
        dim: Some(dim),
        ..Geometry::default()
    };
    let ty = Ty::Spatial(Scalar::Vector, Rc::new(geometry));
    prim::add_prim(cx, prim!("World::VectorFromXYZ"), parts, ty, span)
}

/// Checks `inverse(p)` and returns its typed expression. A pose `(a in b)` becomes `(b in a)`.
fn inverse(cx: &mut Body<'_, '_>, operand: ExprId, span: Span) -> ExprId {
    let (prim, scalar, geometry) = match cx.ty_of(operand).clone() {
        Ty::Spatial(Scalar::Pose, of) => (prim!("World::FrameInvert"), Scalar::Pose, of),
        Ty::Spatial(Scalar::Rotation, of) => (prim!("World::RotationInvert"), Scalar::Rotation, of),
        Ty::Unknown => return cx.error_expr(span),
        ty => {
            let diagnostic =
                Diagnostic::new(Code::RPI2006, format!("`inverse` cannot take `{ty}`"))
                    .primary(cx.span_of(operand), format!("this is `{ty}`"))
                    .help("only poses and rotations have an inverse");
            return cx.report_error_expr(diagnostic, span);
        }
    };
    let turned = Geometry {
        dim: None,
        of: geometry.in_frame.clone(),
        in_frame: geometry.of.clone(),
    };
    prim::add_prim(
        cx,
        prim,
        &[operand],
        Ty::Spatial(scalar, Rc::new(turned)),
        span,
    )
}

/// Checks a product of two vectors, computed by the primitive `prim`, and returns its typed expression. The units are
/// multiplied, and both vectors must be in the same frame.
fn vector_product(cx: &mut Body<'_, '_>, prim: PrimId, operands: &[ExprId], span: Span) -> ExprId {
    let dims = operands.iter().map(|id| match cx.ty_of(*id) {
        Ty::Spatial(_, geometry) => geometry.dim,
        _ => None,
    });
    let dims: Vec<Option<Dimension>> = dims.collect();
    let Some(common) = common_vector_geometry(cx, operands) else {
        return cx.error_expr(span);
    };
    let dim = match dims[..] {
        [Some(a), Some(b)] => a.times(b),
        _ => None,
    };
    let ty = match prim == prim!("World::VectorDot") {
        true => Ty::Real(dim.unwrap_or(Dimension::ONE)),
        false => Ty::Spatial(Scalar::Vector, Rc::new(Geometry { dim, ..common })),
    };
    prim::add_prim(cx, prim, operands, ty, span)
}

/// Returns the frame and, for a single operand, the unit that the vectors have in common. Reports vectors in different
/// frames and returns `None`.
fn common_vector_geometry(cx: &mut Body<'_, '_>, operands: &[ExprId]) -> Option<Geometry> {
    let mut common = Ty::spatial(Scalar::Vector);
    for operand in operands {
        let found = cx.ty_of(*operand).clone();
        if found.is_unknown() {
            return None;
        }
        // Only the frames must be equal; the units may differ.
        let frames_only = match (&found, operands.len()) {
            (Ty::Spatial(Scalar::Vector, of), 2..) => {
                let geometry = Geometry {
                    dim: None,
                    ..(**of).clone()
                };
                Ty::Spatial(Scalar::Vector, Rc::new(geometry))
            }
            _ => found,
        };
        match join(&common, &frames_only) {
            Ok(joined) => common = joined,
            Err(misfit) => {
                report::type_mismatch(
                    cx,
                    *operand,
                    &common,
                    &misfit,
                    &ExpectationReason::Unexplained,
                );
                return None;
            }
        }
    }
    match common {
        Ty::Spatial(_, geometry) => Some((*geometry).clone()),
        _ => None,
    }
}
