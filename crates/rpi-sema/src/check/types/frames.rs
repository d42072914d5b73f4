//! Coordinate frames: composition of poses, and diagnostics for frames that do not match.

use crate::check::bodies::body::Body;
use crate::check::diagnostics::report;
use crate::ty::{Geometry, Ty};
use crate::typed::ExprId;
use crate::typed::TypedKind;
use crate::units::Dimension;
use rpi_diag::{Code, Diagnostic, Fix, Span};
use rpi_image::Scalar;
use rpi_syntax::Name;
use std::rc::Rc;

/// Returns the type of `(b in a) * (c in b)`, which is `(c in a)`. The inner frames must match.
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

/// Reports a pose applied to a vector that is not a position. Other vectors are only rotated.
fn report_pose_of_non_position(cx: &mut Body<'_, '_>, left: ExprId, right: ExprId, ty: &Ty) {
    let diagnostic = Diagnostic::new(Code::RPI2002, format!("cannot apply a pose to `{ty}`"))
        .primary(cx.span_of(right), "not a position, which is in `m`")
        .secondary(cx.span_of(left), "this is a pose")
        .help("rotate directions, velocities and forces: `p.rotation * v`");
    report::report_diagnostic(cx, diagnostic);
}

/// Reports two poses whose inner frames differ.
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
        false => diagnostic.help(format!("insert the pose of `{y}` in `{x}` between them")),
    };
    report::report_diagnostic(cx, diagnostic);
}

/// Adds a fix that exchanges two operands, if both are plain flows.
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

/// Returns the diagnostic for a spatial value with other frames than expected; `wanted` and `found` are the two frames
/// that differ.
pub(crate) fn frame_mismatch(
    expected: &Ty,
    is: &Ty,
    (wanted, found): (&Name, &Name),
    span: Span,
) -> Diagnostic {
    let message = format!("expected `{expected}`, found `{is}`: `{found}` is not `{wanted}`");
    let diagnostic =
        Diagnostic::new(Code::RPI2005, message).primary(span, format!("this is `{is}`"));
    let diagnostic = with_frames_note(diagnostic, expected);
    // Frames of the same name in two devices (`left.tcp`, `right.tcp`) are not a spelling mistake.
    let frame = |name: &Name| name.rsplit('.').next().map(str::to_owned);
    let are_alike = frame(found) == frame(wanted);
    let near = rpi_diag::suggest(found, std::iter::once(wanted.as_str()));
    if let Some(near) = near.filter(|_| !are_alike) {
        return diagnostic.help(format!("did you mean `{near}` instead of `{found}`?"));
    }
    let (Ty::Spatial(_, expected), Ty::Spatial(_, is)) = (expected, is) else {
        return diagnostic;
    };
    let is_turned = expected.of == is.in_frame && expected.in_frame == is.of;
    if is_turned && expected.of.is_some() && expected.in_frame.is_some() {
        return diagnostic.help("use its inverse: `inverse(x)`");
    }
    let meet = |a: &Option<Name>, b: &Option<Name>| a.is_none() || b.is_none() || a == b;
    let same_in = meet(&expected.in_frame, &is.in_frame);
    let same_of = meet(&expected.of, &is.of);
    match (same_in, same_of) {
        (true, _) => diagnostic.help(format!(
            "multiply from the right by the pose `y` of `{wanted}` in `{found}`: `x * y`"
        )),
        (false, true) => diagnostic.help(format!(
            "multiply from the left by the pose `y` of `{found}` in `{wanted}`: `y * x`"
        )),
        // No single pose corrects both frames.
        (false, false) => diagnostic,
    }
}

/// Adds a note that states what the frames of a type mean: `Pose(tool in base)`, `Vector(base)`.
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
