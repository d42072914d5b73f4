//! Coordinate frames: composition of poses, and diagnostics for frames that do not match.

use crate::check::bodies::body::Body;
use crate::check::diagnostics::report;
use crate::ty::{Geometry, Ty};
use crate::typed::TypedKind;
use crate::typed::{BlockId, ExprId};
use crate::units::Dimension;
use rpi_diag::{Code, Diagnostic, Fix, Quote};
use rpi_image::Scalar;
use rpi_net::prim;
use rpi_prims::PrimId;
use rpi_syntax::Name;
use std::rc::Rc;

/// Returns the type of `(b in a) * (c in b)`, which is `(c in a)`. The two frames `b` must be equal; a mismatch is
/// reported.
pub(crate) fn composed_pose_type(cx: &mut Body<'_, '_>, left: ExprId, right: ExprId) -> Ty {
    let (a, b) = (cx.ty_of(left).clone(), cx.ty_of(right).clone());
    let (Ty::Spatial(by, outer), Ty::Spatial(scalar, inner)) = (&a, &b) else {
        return Ty::Unknown;
    };
    if let (Scalar::Pose, Scalar::Vector, Some(dim)) = (by, scalar, inner.dim)
        && !dim.is_compatible(Dimension::LENGTH)
    {
        report_pose_of_non_position(cx, left, right, &b);
        return Ty::Unknown;
    }
    let meet = match (&outer.of, &inner.in_frame) {
        (Some(x), Some(y)) => x == y,
        _ => true,
    };
    if !meet {
        report_frame_mismatch(cx, (left, outer), (right, inner));
    }
    // After a mismatch of the inner frames, the outer ones are left open.
    let geometry = Geometry {
        dim: inner.dim,
        of: inner.of.clone().filter(|_| meet),
        in_frame: outer.in_frame.clone().filter(|_| meet),
    };
    Ty::Spatial(*scalar, Rc::new(geometry))
}

/// Reports a pose `left` that is applied to a vector `right` of the type `ty` other than a position. Directions,
/// velocities and forces are only rotated.
fn report_pose_of_non_position(cx: &mut Body<'_, '_>, left: ExprId, right: ExprId, ty: &Ty) {
    let diagnostic = Diagnostic::new(Code::RPI2002, format!("cannot apply a pose to `{ty}`"))
        .primary(cx.span_of(right), "not a position, which is in `m`")
        .secondary(cx.span_of(left), "this is a pose")
        .help(format!(
            "rotate directions, velocities and forces: `{}.rotation * {}`",
            Quote::operand(cx.span_of(left)),
            Quote::operand(cx.span_of(right))
        ));
    report::report_diagnostic(cx, diagnostic);
}

/// Reports a product of two poses whose inner frames, `b` in `(b in a) * (c in b)`, differ.
fn report_frame_mismatch(
    cx: &mut Body<'_, '_>,
    (left, outer): (ExprId, &Geometry),
    (right, inner): (ExprId, &Geometry),
) {
    let (Some(x), Some(y)) = (&outer.of, &inner.in_frame) else {
        return;
    };
    let (a, b) = (cx.ty_of(left), cx.ty_of(right));
    let message = format!("frame mismatch between `{a}` and `{b}`: `{x}` is not `{y}`");
    let diagnostic = Diagnostic::new(Code::RPI2005, message)
        .primary(cx.span_of(right), format!("this is relative to `{y}`"))
        .secondary(cx.span_of(left), format!("this is the pose of `{x}`"));
    let turned = inner.of.is_some() && inner.of == outer.in_frame;
    let diagnostic = match turned {
        true => with_exchange_fix(cx, diagnostic.help("exchange the operands"), left, right),
        // Both poses are in one frame: the inverse of the first leads from there to its own frame.
        false if outer.in_frame == inner.in_frame => diagnostic.help(format!(
            "for a pose in `{x}` write `inverse({left}) * {right}`; for one in `{y}`, `{left} *` needs a pose in `{x}`",
            left = Quote::text(cx.span_of(left)),
            right = Quote::operand(cx.span_of(right))
        )),
        false => diagnostic.help(format!("insert the pose of `{y}` in `{x}` between them")),
    };
    report::report_diagnostic(cx, diagnostic);
}

/// Adds a fix to a diagnostic that exchanges the operands of a product, if both are plain flows.
fn with_exchange_fix(
    cx: &Body<'_, '_>,
    diagnostic: Diagnostic,
    left: ExprId,
    right: ExprId,
) -> Diagnostic {
    let name = |id: ExprId| match &cx.unit.expr(id).kind {
        TypedKind::Flow(flow) => Some(cx.unit.flow(*flow).name.to_string()),
        _ => None,
    };
    match (name(left), name(right)) {
        (Some(a), Some(b)) => diagnostic.fix(
            Fix::maybe(format!("write `{b} * {a}`"))
                .replace(cx.span_of(left), b)
                .replace(cx.span_of(right), a),
        ),
        _ => diagnostic,
    }
}

/// Primitives that compute the inverse of a pose or rotation.
const INVERSES: [PrimId; 2] = [prim!("World::FrameInvert"), prim!("World::RotationInvert")];

/// Returns the operand of an expression `inverse(operand)`; `None` for other expressions.
fn inverse_operand(cx: &Body<'_, '_>, id: ExprId) -> Option<ExprId> {
    match &cx.unit.expr(id).kind {
        TypedKind::Prim(call) if INVERSES.contains(&call.prim) => *call.inputs.first()?,
        _ => None,
    }
}

/// Returns the diagnostic for a spatial value whose frames are not those of the expected type. `wanted` and `found` are
/// the first two frames that differ.
pub(crate) fn frame_mismatch(
    cx: &Body<'_, '_>,
    expected: &Ty,
    value: ExprId,
    (wanted, found): (&Name, &Name),
) -> Diagnostic {
    let (is, span) = (cx.ty_of(value), cx.span_of(value));
    let message = format!("expected `{expected}`, found `{is}`: `{found}` is not `{wanted}`");
    let diagnostic =
        Diagnostic::new(Code::RPI2005, message).primary(span, format!("this is `{is}`"));
    let diagnostic = with_frames_note(diagnostic, expected);
    // Frames of the same name in two devices (`left.tcp`, `right.tcp`) are not a spelling mistake.
    let frame = |name: &Name| name.rsplit('.').next().map(str::to_owned);
    let are_alike = frame(found) == frame(wanted);
    let near = rpi_diag::suggest(found, std::iter::once(wanted.as_str()));
    if let Some(near) = near.filter(|_| !are_alike) {
        let diagnostic = match cx.unit.expr(value).kind {
            TypedKind::Flow(flow) => {
                let flow = cx.unit.flow(flow);
                diagnostic.secondary(
                    flow.span,
                    format!("the type of `{}` names `{found}`", flow.name),
                )
            }
            _ => diagnostic,
        };
        return diagnostic.help(format!("did you mean `{near}` instead of `{found}`?"));
    }
    let (Ty::Spatial(scalar, expected), Ty::Spatial(_, is)) = (expected, is) else {
        return diagnostic;
    };
    let is_turned = expected.of == is.in_frame && expected.in_frame == is.of;
    if is_turned && expected.of.is_some() && expected.in_frame.is_some() {
        return diagnostic.help(match inverse_operand(cx, value) {
            Some(operand) => format!("omit the inverse: `{}`", Quote::text(cx.span_of(operand))),
            None => format!("use its inverse: `inverse({})`", Quote::text(span)),
        });
    }
    let meet = |a: &Option<Name>, b: &Option<Name>| a.is_none() || b.is_none() || a == b;
    let same_in = meet(&expected.in_frame, &is.in_frame);
    let same_of = meet(&expected.of, &is.of);
    let value = Quote::operand(span);
    let factor = factor_word(*scalar, is);
    match (same_in, same_of) {
        (true, _) => diagnostic.help(format!(
            "multiply it from the right by the pose of `{wanted}` in `{found}`: `{value} * {}`",
            known_pose(cx, wanted, found)
        )),
        (false, true) => diagnostic.help(format!(
            "multiply it from the left by the {factor} of `{found}` in `{wanted}`: `{} * {value}`",
            match factor {
                "pose" => known_pose(cx, found, wanted),
                _ => "...".to_owned(),
            }
        )),
        // No single pose corrects both frames.
        (false, false) => diagnostic,
    }
}

/// Returns the kind of value that brings a spatial value into another frame.
fn factor_word(scalar: Scalar, geometry: &Geometry) -> &'static str {
    match (scalar, geometry.dim) {
        (Scalar::Pose, _) => "pose",
        (Scalar::Vector, Some(dim)) if dim.is_compatible(Dimension::LENGTH) => "pose",
        _ => "rotation",
    }
}

/// Returns an expression for the pose of the frame `of` in the frame `seen`: a flow of the body or its inverse, else
/// `...`.
fn known_pose(cx: &Body<'_, '_>, of: &Name, seen: &Name) -> String {
    let flow = |of: &Name, seen: &Name| {
        let mut flows = cx.unit.flows.iter();
        let found = flows.find(|flow| {
            let frames = match &flow.ty {
                Ty::Spatial(Scalar::Pose, frames) => frames,
                _ => return false,
            };
            let is_here = flow.block == BlockId::ROOT && !flow.name.is_empty();
            is_here && frames.of.as_ref() == Some(of) && frames.in_frame.as_ref() == Some(seen)
        });
        found.map(|flow| flow.name.to_string())
    };
    let inverse = || Some(format!("inverse({})", flow(seen, of)?));
    flow(of, seen).or_else(inverse).unwrap_or("...".to_owned())
}

/// Returns the advice for two operands in the frames `a` and `b`, of which either may be the wrong one.
pub(crate) fn one_frame_help(
    cx: &Body<'_, '_>,
    (left, a): (ExprId, &Name),
    (right, b): (ExprId, &Name),
) -> String {
    let factor = match cx.ty_of(right) {
        Ty::Spatial(scalar, geometry) => factor_word(*scalar, geometry),
        _ => "pose",
    };
    let [left, right] = [left, right].map(|id| Quote::operand(cx.span_of(id)));
    format!(
        "bring both operands into one frame: `... * {right}` with the {factor} of `{b}` in `{a}`, or `... * {left}` with that of `{a}` in `{b}`"
    )
}

/// Adds a note that explains the frames in a type such as `Pose(tool in base)` or `Vector(base)`.
fn with_frames_note(diagnostic: Diagnostic, ty: &Ty) -> Diagnostic {
    let Ty::Spatial(scalar, frames) = ty else {
        return diagnostic;
    };
    match (scalar, &frames.of, &frames.in_frame) {
        (Scalar::Pose | Scalar::Rotation, Some(of), Some(seen)) => {
            let what = match scalar {
                Scalar::Pose => "position and orientation",
                _ => "orientation",
            };
            diagnostic.note(format!(
                "`{of} in {seen}`: the {what} of the frame `{of}`, as coordinates of the frame `{seen}`"
            ))
        }
        (Scalar::Vector, _, Some(seen)) => diagnostic.note(format!(
            "`Vector({seen})`: the components are along the axes of the frame `{seen}`"
        )),
        _ => diagnostic,
    }
}
