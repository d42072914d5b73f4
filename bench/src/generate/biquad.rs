//! Regular, serial nets: a chain of second-order filters.

use crate::net_builder::{NetBuilder, real};
use rpi_image::{Scalar, Value};
use rpi_net::{FragmentId, Input, Net, NodeId, PortRef};

const ROOT: FragmentId = FragmentId::ROOT;

/// Returns a net with a chain of `stages` second-order filters (transposed direct form II) of 11 primitives each. The
/// first filter reads the input `x`, and the last output is exported as `y`. The DC gain of each filter is 1, so that
/// no value becomes subnormal.
#[must_use]
pub fn biquad(stages: usize) -> Net {
    let mut b = NetBuilder::new("biquad");
    let mut x = input(&mut b);
    for k in 0..stages {
        let wobble = (k % 7) as f64 * 1e-3;
        x = stage(&mut b, x, [0.4 + wobble, 0.3, 0.1, -0.4 + wobble, 0.2]);
    }
    b.export("y", x);
    b.net
}

/// Adds one filter to the net and returns its output: y = b0 x + s1; s1' = b1 x - a1 y + s2; s2' = b2 x - a2 y. The
/// states s1 and s2 start with 0, and ' marks their values in the next cycle.
fn stage(b: &mut NetBuilder, x: PortRef, [b0, b1, b2, a1, a2]: [f64; 5]) -> PortRef {
    let ((s1, d1), (s2, d2)) = (delayed(b), delayed(b));
    let y = scaled(b, x, b0);
    let y = sum(b, y, s1);
    let s1_next = scaled(b, x, b1);
    let back = scaled(b, y, -a1);
    let s1_next = sum(b, s1_next, back);
    let s1_next = sum(b, s1_next, s2);
    let s2_next = scaled(b, x, b2);
    let back = scaled(b, y, -a2);
    let s2_next = sum(b, s2_next, back);
    b.wire(d1, 0, s1_next);
    b.wire(d2, 0, s2_next);
    y
}

/// Adds a delay of a real with the initial value 0. Returns its output, and the node whose in-port 0 is to be
/// connected.
pub(super) fn delayed(b: &mut NetBuilder) -> (PortRef, NodeId) {
    if let Some(pre) = b.total_delay(ROOT, Scalar::Real) {
        return (pre, pre.node);
    }
    let pre = b.add(ROOT, "Core::DoublePre", &[]);
    let null = b.add(ROOT, "Core::DoubleIsNull", &[Input::Port(pre)]);
    let inputs = [Input::Port(null), real(0.0), Input::Port(pre)];
    (b.add(ROOT, "Core::DoubleConditional", &inputs), pre.node)
}

/// Adds the input `x` to the net and returns its value.
pub(super) fn input(b: &mut NetBuilder) -> PortRef {
    let key = ("Key", Value::Str("x".into()));
    b.add_with(ROOT, "Core::DoubleNetcommIn", &[], &[key])
}

pub(super) fn scaled(b: &mut NetBuilder, x: PortRef, by: f64) -> PortRef {
    b.add(ROOT, "Core::DoubleMultiply", &[Input::Port(x), real(by)])
}

pub(super) fn sum(b: &mut NetBuilder, x: PortRef, y: PortRef) -> PortRef {
    b.add(ROOT, "Core::DoubleAdd", &[Input::Port(x), Input::Port(y)])
}
