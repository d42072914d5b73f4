//! Frames of a call that follow from devices and from omitted tools.

use crate::check::bodies::body::Body;
use crate::check::signatures::header::{Header, Port};
use crate::check::types::consts;
use crate::ty::{Substitution, Ty};
use crate::typed::{ExprId, TypedKind};
use rpi_image::{Scalar, Value};

/// Replaces, in `subst`, each frame of the device that is passed for the port by the corresponding frame of the caller:
/// `port.tcp` becomes `arm.tcp` for the device `arm`. Ports that take no device are ignored.
pub(crate) fn bind_device_frames(
    cx: &mut Body<'_, '_>,
    port: &Port,
    arg: ExprId,
    subst: &mut Substitution,
) {
    let (Ty::Device(device), TypedKind::Flow(flow)) = (&port.ty, &cx.unit.expr(arg).kind) else {
        return;
    };
    let outer = cx.unit.flow(*flow).name.clone();
    for local in &device.frames {
        let inner = format!("{}.{local}", port.name);
        let outer = format!("{outer}.{local}");
        subst.frames.insert(inner.into(), Some(outer.into()));
    }
}

/// Binds, in `subst`, the free frame `a` of an in-port `Pose(a in arm.b)` that uses its default, the identity, to the frame
/// `arm.b` of the device: the frame at the identity is the frame of the device itself. Other ports are ignored: their defaults
/// are the same for all frames.
pub(crate) fn bind_omitted_frame(header: &Header, port: &Port, subst: &mut Substitution) {
    let Ty::Spatial(Scalar::Pose, own) = &port.ty else {
        return;
    };
    let of_device = own.in_frame.as_ref().filter(|frame| {
        let device = frame.split_once('.').map(|(device, _)| device);
        let mut inputs = header.inputs.iter();
        inputs.any(|input| matches!(input.ty, Ty::Device(_)) && Some(&*input.name) == device)
    });
    let Some(frame) = of_device.filter(|_| port.is_identity_by_default) else {
        return;
    };
    let known = subst.frames.get(frame).cloned().flatten();
    let free = own.of.as_ref().and_then(|of| subst.frames.get_mut(of));
    if let Some(free @ None) = free {
        *free = Some(known.unwrap_or_else(|| frame.clone()));
    }
}

/// Returns whether the default `value` of a port of type `ty` is the identity pose.
pub(crate) fn is_identity_pose(cx: &mut Body<'_, '_>, ty: &Ty, value: ExprId) -> bool {
    if !matches!(ty, Ty::Spatial(Scalar::Pose, _)) {
        return false;
    }
    let slots = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0].map(f64::to_bits);
    let is_identity =
        |value: &Value| matches!(value, Value::Slots { cells, .. } if cells[..] == slots);
    consts::fold_silently(cx, value).is_some_and(|leaves| leaves.iter().all(is_identity))
}
