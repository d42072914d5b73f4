//! Products that are one of their factors. A quantity is a number times its unit, as in `x * 1[rad]`, and a number is a quantity
//! divided by it: for units of the SI both are `x` itself, without an operation.

use crate::elab::signal::{PrimInputs, Signal, Wire};
use rpi_net::prim;
use rpi_prims::PrimId;

/// Returns the operand that equals the result of a call of a primitive with these inputs: the other one of `x * 1`, `1 * x` or `x / 1`
/// in reals. By IEEE 754 this holds for each `x` that an operation can yield, with all bits. `None` for other calls.
pub(super) fn equal_operand(prim: PrimId, inputs: &PrimInputs) -> Option<Wire> {
    let [Some((_, first)), Some((_, second))] = inputs.as_slice() else {
        return None;
    };
    let is_product = prim == prim!("Core::DoubleMultiply");
    if !is_product && prim != prim!("Core::DoubleDivide") {
        return None;
    }
    match (is_one(first), is_one(second)) {
        (_, true) => Some(first.clone()),
        (true, _) if is_product => Some(second.clone()),
        _ => None,
    }
}

fn is_one(wire: &Wire) -> bool {
    matches!(&**wire, [Signal::Const(value)] if value.as_real() == Some(1.0))
}
