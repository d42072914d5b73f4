//! What can fault in a branch of an `if`, on a side of `->` or in the condition of a strong transition does so only in the
//! cycles in which that is asked for: such primitives have a twin with a condition as its first in-port. State in a branch goes on in all cycles, as in Lustre, and so do the
//! faults on the way to it.

use crate::typed::{Each, ExprId, Kind, Unit, UnitKind};
use rpi_prims::PrimId;

/// Primitives that can fault, and their twins.
const TWINS: &[(&str, &str)] = &[
    ("Core::IntAdd", "Rpi::GuardedIntAdd"),
    ("Rpi::IntSubtract", "Rpi::GuardedIntSubtract"),
    ("Core::IntMultiply", "Rpi::GuardedIntMultiply"),
    ("Core::IntDivide", "Rpi::GuardedIntDivide"),
    ("Rpi::IntModulo", "Rpi::GuardedIntModulo"),
    ("Rpi::IntPower", "Rpi::GuardedIntPower"),
    ("Rpi::IntNegate", "Rpi::GuardedIntNegate"),
    ("Rpi::IntAbsolute", "Rpi::GuardedIntAbsolute"),
    ("Core::IntFromDouble", "Rpi::GuardedIntFromDouble"),
];

/// The twin of a primitive that asks whether it counts.
pub(super) fn twin(prim: PrimId) -> Option<PrimId> {
    let desc = prim.desc();
    let row = TWINS
        .iter()
        .find(|row| desc.may_fault && row.0 == desc.name)?;
    PrimId::of(row.1)
}

/// Whether something in an expression can fault that a guard would keep from it.
pub(super) fn can_fault(units: &[Unit], unit: &Unit, id: ExprId) -> bool {
    let mut open = vec![(unit, id)];
    while let Some((unit, id)) = open.pop() {
        let kind = &unit.expr(id).kind;
        match kind {
            Kind::Select { .. } => return true,
            Kind::Prim(call) if call.prim.desc().may_fault => return true,
            // On the way to a state.
            Kind::Each(Each::Pre | Each::Last | Each::Hold, _) | Kind::Current(_) => continue,
            Kind::Call(call) if units[call.unit.0 as usize].kind != UnitKind::Function => continue,
            Kind::Call(call) => {
                let callee = &units[call.unit.0 as usize];
                let values = callee.blocks.iter().flat_map(|block| &block.equations);
                open.extend(values.map(|equation| (callee, equation.value)));
            }
            _ => {}
        }
        kind.operands(&mut |operand| open.push((unit, operand)));
    }
    false
}
