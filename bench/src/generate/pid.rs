//! Regular, parallel nets: independent control loops.

use super::biquad::{delayed, input, scaled, sum};
use crate::net_builder::{NetBuilder, boolean, real};
use rpi_net::{FragmentId, Input, Net, PortRef};

const ROOT: FragmentId = FragmentId::ROOT;

/// Returns a net of `loops` independent control loops of 26 primitives each: a PID controller with saturation and
/// anti-windup, and its plant. The input `x` is the set-point of all loops; the sum of their outputs is exported as
/// `y`.
#[must_use]
pub fn pid(loops: usize) -> Net {
    let mut b = NetBuilder::new("pid");
    let target = input(&mut b);
    let mut total = None;
    for k in 0..loops {
        let y = control_loop(&mut b, target, 0.5 + (k % 11) as f64 * 0.05);
        total = Some(match total {
            Some(t) => sum(&mut b, t, y),
            None => y,
        });
    }
    if let Some(total) = total {
        b.export("y", total);
    }
    b.net
}

fn control_loop(b: &mut NetBuilder, target: PortRef, gain: f64) -> PortRef {
    let (y, plant) = delayed(b);
    let (sum_before, integrator) = delayed(b);
    let (error_before, derivative) = delayed(b);
    let target = scaled(b, target, gain);
    let back = scaled(b, y, -1.0);
    let error = sum(b, target, back);
    let p = scaled(b, error, 1.2);
    let minus = scaled(b, error_before, -1.0);
    let change = sum(b, error, minus);
    let d = scaled(b, change, 0.05);
    let i = scaled(b, sum_before, 0.3);
    let raw = sum(b, p, d);
    let raw = sum(b, raw, i);
    let (u, free) = saturated(b, raw, 2.0);
    let step = scaled(b, error, 0.01);
    let more = sum(b, sum_before, step);
    let kept = choose(b, free, more, sum_before);
    let decay = scaled(b, y, 0.95);
    let drive = scaled(b, u, 0.05);
    let next = sum(b, decay, drive);
    b.wire(plant, 0, next);
    b.wire(integrator, 0, kept);
    b.wire(derivative, 0, error);
    next
}

/// Adds a limiter to the net. Returns the value `x` limited to plus and minus `limit`, and a Boolean that is true if
/// `x` was within the limits.
fn saturated(b: &mut NetBuilder, x: PortRef, limit: f64) -> (PortRef, PortRef) {
    let high = b.add(ROOT, "Core::DoubleGreater", &[Input::Port(x), real(limit)]);
    let low = b.add(ROOT, "Core::DoubleGreater", &[real(-limit), Input::Port(x)]);
    let inputs = [Input::Port(high), real(limit), Input::Port(x)];
    let cut = b.add(ROOT, "Core::DoubleConditional", &inputs);
    let inputs = [Input::Port(low), real(-limit), Input::Port(cut)];
    let cut = b.add(ROOT, "Core::DoubleConditional", &inputs);
    let either = b.add(
        ROOT,
        "Core::BooleanOr",
        &[Input::Port(high), Input::Port(low)],
    );
    let inputs = [Input::Port(either)];
    let free = b.add(ROOT, "Core::BooleanNot", &inputs);
    let inputs = [Input::Port(free), boolean(true)];
    (cut, b.add(ROOT, "Core::BooleanAnd", &inputs))
}

fn choose(b: &mut NetBuilder, condition: PortRef, yes: PortRef, no: PortRef) -> PortRef {
    let inputs = [condition, yes, no].map(Input::Port);
    b.add(ROOT, "Core::DoubleConditional", &inputs)
}
