//! What can fault in a branch of an `if`, on a side of `->` or in the condition of a strong transition does so only in the
//! cycles in which that is asked for: such primitives have a twin with a condition as its first in-port. State in a branch
//! goes on in all cycles, as in Lustre, and so do the faults on the way to it.

use super::Elab;
use super::scope::Scope;
use crate::typed::{Each, Equation, ExprId, Kind, Unit, UnitId, UnitKind};
use rpi_prims::PrimId;
use std::rc::Rc;

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

/// What is so of an expression because of itself or of something in it.
#[derive(Clone, Copy, Default)]
pub(super) struct Within {
    /// Something can fault that a guard would keep from it.
    can_fault: bool,
    /// Something has state, which goes on whatever chooses it.
    goes_on: bool,
}

/// What is so of a unit.
pub(super) struct WithinUnit {
    /// Of each of its expressions.
    exprs: Vec<Within>,
    /// Something can fault in what it computes, or it claims something.
    can_fault: bool,
}

impl<'u> Elab<'u> {
    /// Whether something in an expression can fault that a guard would keep from it.
    pub(super) fn can_fault(&mut self, scope: &Scope<'u>, id: ExprId) -> bool {
        self.within(scope, id).can_fault
    }

    /// Whether something in an expression has state, which goes on whatever chooses it.
    pub(super) fn goes_on(&mut self, scope: &Scope<'u>, id: ExprId) -> bool {
        self.within(scope, id).goes_on
    }

    /// A constant outside of a unit has no state, and faults when it is worked out or not at all.
    fn within(&mut self, scope: &Scope<'u>, id: ExprId) -> Within {
        match scope.id {
            Some(unit) => self.within_unit(unit).exprs[id.0 as usize],
            None => Within::default(),
        }
    }

    fn within_unit(&mut self, id: UnitId) -> Rc<WithinUnit> {
        if let Some(known) = self.within.get(&id) {
            return known.clone();
        }
        let unit = &self.units[id.0 as usize];
        let exprs = self.within_each(unit);
        let can_fault = |equation: &Equation| exprs[equation.value.0 as usize].can_fault;
        let mut blocks = unit.blocks.iter();
        let can_fault =
            blocks.any(|block| !block.claims.is_empty() || block.equations.iter().any(can_fault));
        let of_unit = Rc::new(WithinUnit { exprs, can_fault });
        self.within.insert(id, of_unit.clone());
        of_unit
    }

    /// Of all expressions of a unit at once: their operands come before them.
    fn within_each(&mut self, unit: &'u Unit) -> Vec<Within> {
        let mut all: Vec<Within> = Vec::with_capacity(unit.exprs.len());
        for expr in &unit.exprs {
            let mut within = self.alone(&expr.kind);
            if !within.goes_on {
                expr.kind.operands(&mut |operand| {
                    let operand = all[operand.0 as usize];
                    within.can_fault |= operand.can_fault;
                    within.goes_on |= operand.goes_on;
                });
            }
            all.push(within);
        }
        all
    }

    /// What an expression tells without its operands. On the way to a state nothing is guarded.
    fn alone(&mut self, kind: &Kind) -> Within {
        let goes_on = match kind {
            Kind::Each(Each::Pre | Each::Last | Each::Hold, _) | Kind::Current(_) => true,
            Kind::Call(call) => !self.is_function(call.unit),
            _ => false,
        };
        let can_fault = match kind {
            Kind::Select { .. } => true,
            Kind::Prim(call) => call.prim.desc().may_fault,
            Kind::Call(call) => !goes_on && self.within_unit(call.unit).can_fault,
            _ => false,
        };
        Within { can_fault, goes_on }
    }

    fn is_function(&self, unit: UnitId) -> bool {
        self.units[unit.0 as usize].kind == UnitKind::Function
    }
}
