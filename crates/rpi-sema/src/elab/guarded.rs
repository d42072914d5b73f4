//! What can fault in a branch of an `if`, on a side of `->` or in the condition of a strong transition does so only in the
//! cycles in which that is asked for: such primitives have a twin with a condition as its first in-port. State in a branch goes on in all cycles, as in Lustre, and so do the
//! faults on the way to it.

use super::Elab;
use crate::typed::{Each, ExprId, Kind, Unit, UnitId, UnitKind};
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

impl Elab<'_> {
    /// Whether something in an expression can fault that a guard would keep from it.
    pub(super) fn can_fault(&mut self, unit: &Unit, id: ExprId) -> bool {
        let mut parts = unit.parts(id);
        while let Some((id, expr)) = parts.next() {
            match &expr.kind {
                Kind::Select { .. } => return true,
                Kind::Prim(call) if call.prim.desc().may_fault => return true,
                // On the way to a state.
                Kind::Each(Each::Pre | Each::Last | Each::Hold, _) | Kind::Current(_) => continue,
                Kind::Call(call) if !self.is_function(call.unit) => continue,
                Kind::Call(call) if self.call_can_fault(call.unit) => return true,
                _ => {}
            }
            parts.enter(id);
        }
        false
    }

    fn is_function(&self, unit: UnitId) -> bool {
        self.units[unit.0 as usize].kind == UnitKind::Function
    }

    /// Likewise of what a function computes.
    fn call_can_fault(&mut self, id: UnitId) -> bool {
        if let Some(known) = self.can_fault.get(&id) {
            return *known;
        }
        let units = self.units;
        let callee = &units[id.0 as usize];
        let mut values = callee.blocks.iter().flat_map(|block| &block.equations);
        let can = values.any(|equation| self.can_fault(callee, equation.value));
        self.can_fault.insert(id, can);
        can
    }
}
