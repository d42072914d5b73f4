//! Parts of spatial values: read by name, construction (`Pose{position = p; rotation = r}`) and replacement
//! (`Pose{p with position = q}`, `(p with .position.z = 0[m])`).

use crate::check::bodies::body::Body;
use crate::check::bodies::statement;
use crate::check::calls::prim;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::ExpectationReason;
use crate::check::diagnostics::report::join_names;
use crate::check::diagnostics::report::no_member;
use crate::check::exprs::expr;
use crate::check::exprs::spatial_ops;
use crate::check::types;
use crate::ty::{Geometry, Ty, join};
use crate::typed::ExprId;
use crate::typed::TypedKind;
use crate::units::{BaseDim, Dimension};
use rpi_diag::{Code, Diagnostic, Fix, Quote, Span};
use rpi_image::Scalar;
use rpi_syntax::ast::{FieldValue, Ident, StructExpr};
use std::rc::Rc;

/// Parts of spatial values: the type of the value, the name of the part, the primitive that decomposes the value, and
/// the index of the primitive's out-port with the part.
pub(crate) const SPATIAL_PARTS: &[(Scalar, &str, &str, u32)] = &[
    (Scalar::Vector, "x", "World::VectorToXYZ", 0),
    (Scalar::Vector, "y", "World::VectorToXYZ", 1),
    (Scalar::Vector, "z", "World::VectorToXYZ", 2),
    (Scalar::Pose, "position", "World::FrameToPosRot", 0),
    (Scalar::Pose, "rotation", "World::FrameToPosRot", 1),
    (Scalar::Twist, "linear", "World::TwistToVelocities", 0),
    (Scalar::Twist, "angular", "World::TwistToVelocities", 1),
    (Scalar::Wrench, "force", "Rpi::WrenchToParts", 0),
    (Scalar::Wrench, "torque", "Rpi::WrenchToParts", 1),
];

/// Primitives that compose a spatial value of each type. Their in-ports are the parts in the order of
/// [`SPATIAL_PARTS`].
const COMPOSE_PRIMS: &[(Scalar, &str)] = &[
    (Scalar::Vector, "World::VectorFromXYZ"),
    (Scalar::Pose, "World::FrameFromPosRot"),
    (Scalar::Twist, "World::TwistFromVelocities"),
    (Scalar::Wrench, "Rpi::WrenchFromParts"),
];

/// Returns the names of the parts of a spatial type, such as `x`, `y` and `z`; none for a rotation.
fn part_names(scalar: Scalar) -> impl Iterator<Item = &'static str> {
    let rows = SPATIAL_PARTS.iter().filter(move |row| row.0 == scalar);
    rows.map(|row| row.1)
}

/// Checks a read of the part `field` of a spatial value, as in `p.position`, and returns its typed expression. Reports
/// an unknown part.
pub(crate) fn spatial_part(
    cx: &mut Body<'_, '_>,
    base: ExprId,
    field: &Ident,
    span: Span,
) -> ExprId {
    let Ty::Spatial(scalar, geometry) = cx.ty_of(base).clone() else {
        return cx.error_expr(span);
    };
    let named = |row: &&(Scalar, &str, &str, u32)| row.0 == scalar && field.name == row.1;
    let Some((_, _, prim, port)) = SPATIAL_PARTS.iter().find(named) else {
        return cx.report_error_expr(unknown_part(scalar, field, PartSyntax::Path), span);
    };
    let base = prim::prim_by_position(cx, prim, &[base], span);
    let ty = part_type(scalar, &geometry, &field.name);
    cx.add(TypedKind::Part { base, at: *port }, ty, span)
}

/// Returns the spatial type whose name a struct literal such as `Pose{...}` has. `None` for other names, or if a
/// declaration of the program has the name.
pub(crate) fn spatial_struct_type(cx: &Body<'_, '_>, value: &StructExpr) -> Option<Scalar> {
    let is_it = |row: &&(Scalar, &str)| row.0.name() == value.ty.name.as_str();
    let (scalar, _) = COMPOSE_PRIMS.iter().find(is_it)?;
    types::is_undeclared_type(cx, &value.ty.name).then_some(*scalar)
}

/// Checks `Pose{position = p; rotation = r}` or `Pose{p with rotation = r}` and returns its typed expression.
pub(crate) fn spatial_value<'a>(
    cx: &mut Body<'_, 'a>,
    scalar: Scalar,
    value: &'a StructExpr,
    span: Span,
) -> ExprId {
    let dim = spatial_ops::component_dim(cx, scalar, &value.statics);
    let wanted = Ty::Spatial(
        scalar,
        Rc::new(Geometry {
            dim,
            ..Geometry::default()
        }),
    );
    let base = value.base.as_ref().map(|base| expr::check_expr(cx, base));
    let given: Vec<(&FieldValue, ExprId)> = value
        .fields
        .iter()
        .map(|field| (field, expr::check_expr(cx, &field.value)))
        .collect();
    if base.is_some_and(|base| {
        !statement::expect_type(cx, base, &wanted, &ExpectationReason::Unexplained)
    }) {
        return cx.error_expr(span);
    }
    let known = base.map_or(wanted, |base| cx.ty_of(base).clone());
    let Some(parts) = given_parts(cx, scalar, &given, base, span) else {
        return cx.add(TypedKind::Error, known, span);
    };
    compose_spatial(cx, &known, &parts, span)
}

/// Returns the parts of a spatial value in their order. Parts that are not given are taken from the value `base`.
/// Reports missing and unknown parts and returns `None`.
fn given_parts(
    cx: &mut Body<'_, '_>,
    scalar: Scalar,
    given: &[(&FieldValue, ExprId)],
    base: Option<ExprId>,
    span: Span,
) -> Option<Vec<ExprId>> {
    let before = cx.diagnostics.len();
    let mut left_out = Vec::new();
    let mut parts = Vec::new();
    for name in part_names(scalar) {
        let mut named = given.iter().filter(|(field, _)| field.field.name == name);
        let part = named.next().map(|(_, id)| *id);
        if let (Some(first), Some((again, _))) = (part, named.next()) {
            let first = cx.span_of(first);
            let diagnostic =
                crate::program::duplicate_name_error(&again.field.name, again.field.span, first);
            report::report_diagnostic(cx, diagnostic);
        }
        match (part, base) {
            (Some(part), _) => parts.push(part),
            (None, Some(base)) => parts.push(base_part(cx, base, name, span)),
            (None, None) => left_out.push(name),
        }
    }
    for (field, _) in given {
        if part_names(scalar).all(|name| field.field.name != name) {
            let at = PartSyntax::Literal {
                base: base.map(|base| cx.span_of(base)),
                value: field.value.span,
            };
            report::report_diagnostic(cx, unknown_part(scalar, &field.field, at));
        }
    }
    if !left_out.is_empty() && !report::has_error_since(cx, before) {
        let example = format!("{scalar}{{...; {} = ...}}", left_out[0]);
        let message = format!("missing {} of `{scalar}`", join_names(left_out));
        let diagnostic = Diagnostic::new(Code::RPI1010, message)
            .primary(span, "all parts are required")
            .help(format!("add it: `{example}`"));
        report::report_diagnostic(cx, diagnostic);
    }
    (!report::has_error_since(cx, before)).then_some(parts)
}

fn base_part(cx: &mut Body<'_, '_>, base: ExprId, name: &str, span: Span) -> ExprId {
    let name = name.into();
    spatial_part(cx, base, &Ident { name, span }, span)
}

/// Adds an expression that composes a spatial value from all its parts, and returns it. `known` is the type as far as
/// it is known. Units and frames of the parts must be compatible; they complete the type.
fn compose_spatial(cx: &mut Body<'_, '_>, known: &Ty, parts: &[ExprId], span: Span) -> ExprId {
    let Ty::Spatial(scalar, geometry) = known else {
        return cx.error_expr(span);
    };
    let mut geometry = (**geometry).clone();
    let mut wanted = ExpectationReason::Unexplained;
    for (part, name) in parts.iter().zip(part_names(*scalar)) {
        // The first component decides the unit of the others.
        if let (Ty::Real(dim), None) = (cx.ty_of(*part), geometry.dim) {
            geometry.dim = Some(*dim);
        }
        let expected = part_type(*scalar, &Rc::new(geometry.clone()), name);
        if !statement::expect_type(cx, *part, &expected, &wanted) {
            return cx.add(TypedKind::Error, known.clone(), span);
        }
        wanted =
            ExpectationReason::Because(cx.span_of(*part), format!("this is `{}`", cx.ty_of(*part)));
        if let Ok(Ty::Spatial(_, of)) = join(&expected, cx.ty_of(*part)) {
            geometry.of = geometry.of.or_else(|| of.of.clone());
            geometry.in_frame = geometry.in_frame.or_else(|| of.in_frame.clone());
        }
    }
    let whole = COMPOSE_PRIMS.iter().find(|row| row.0 == *scalar);
    let whole = whole.and_then(|row| rpi_prims::PrimId::from_name(row.1));
    match whole {
        Some(prim) => {
            let ty = Ty::Spatial(*scalar, Rc::new(geometry));
            prim::add_prim(cx, prim, parts, ty, span)
        }
        None => cx.error_expr(span),
    }
}

/// Returns an expression for the spatial value `base` with the part `field` replaced by `new`. The type of `base` must
/// have this part.
pub(crate) fn replace_part(
    cx: &mut Body<'_, '_>,
    base: ExprId,
    field: &Ident,
    new: ExprId,
    span: Span,
) -> ExprId {
    let known = cx.ty_of(base).clone();
    let Ty::Spatial(scalar, _) = known else {
        return cx.error_expr(span);
    };
    let mut parts = Vec::new();
    for name in part_names(scalar) {
        parts.push(match field.name == name {
            true => new,
            false => base_part(cx, base, name, span),
        });
    }
    compose_spatial(cx, &known, &parts, span)
}

/// Syntax with which a program names a part of a spatial value, for messages.
#[derive(Clone, Copy, PartialEq)]
enum PartSyntax {
    /// As a path: `p.x`, `(p with .x = ..)`.
    Path,
    /// Literal: `Pose{x = ..}` or `Pose{base with x = ..}`.
    Literal { base: Option<Span>, value: Span },
}

/// Returns the diagnostic for a part `field` that a spatial type does not have. `at` is the syntax in which the part is
/// named.
fn unknown_part(scalar: Scalar, field: &Ident, at: PartSyntax) -> Diagnostic {
    let near = rpi_diag::suggest(&field.name, part_names(scalar));
    let unlike = near.is_none();
    let diagnostic = no_member(&format!("a `{scalar}`"), &field.name, field.span, near);
    match (scalar, field.name.as_str(), at) {
        (Scalar::Pose, "x" | "y" | "z", PartSyntax::Path) => {
            let meant = format!("position.{}", field.name);
            diagnostic.fix(Fix::sure(format!("write `{meant}`")).replace(field.span, meant))
        }
        (
            Scalar::Pose,
            "x" | "y" | "z",
            PartSyntax::Literal {
                base: Some(base),
                value,
            },
        ) => diagnostic.help(format!(
            "a single coordinate is replaced by `({} with .position.{} = {})`",
            Quote::text(base),
            field.name,
            Quote::text(value)
        )),
        (Scalar::Rotation, ..) => diagnostic
            .help("a rotation has no named parts; `rotation_about(axis, angle)` makes one"),
        _ if unlike => diagnostic.help(report::members_help("part", part_names(scalar))),
        _ => diagnostic,
    }
}

/// Returns the dimension of a force: mass times acceleration.
fn force_dimension() -> Option<Dimension> {
    let acceleration = Dimension::LENGTH
        .divided_by(Dimension::TIME)?
        .divided_by(Dimension::TIME)?;
    Dimension::base(BaseDim::Mass).times(acceleration)
}

/// Returns the type of the part `field` of a spatial value. Its unit and frames follow from `geometry`, those of the
/// whole value.
fn part_type(scalar: Scalar, geometry: &Rc<Geometry>, field: &str) -> Ty {
    let in_frame = geometry.in_frame.clone();
    let vector = |dim| {
        let in_frame = in_frame.clone();
        Ty::Spatial(
            Scalar::Vector,
            Rc::new(Geometry {
                dim,
                of: None,
                in_frame,
            }),
        )
    };
    let speed = |dim: Dimension| dim.divided_by(Dimension::TIME);

    match (scalar, field) {
        (Scalar::Vector, _) => Ty::Real(geometry.dim.unwrap_or(Dimension::ONE)),
        (_, "rotation") => Ty::Spatial(Scalar::Rotation, geometry.clone()),
        (_, "linear") => vector(speed(Dimension::LENGTH)),
        (_, "angular") => vector(speed(Dimension::ANGLE)),
        (_, "force") => vector(force_dimension()),
        (_, "torque") => vector(force_dimension().and_then(|dim| dim.times(Dimension::LENGTH))),
        _ => vector(Some(Dimension::LENGTH)),
    }
}
