//! What can fault in an operand that is not always needed does so only in the cycles in which it is needed: in a branch of
//! an `if`, behind `??`, `and`, `or` and `=>`, on a side of `->`, in the condition of a strong transition. Primitives that
//! can fault have a twin with a condition as its first in-port. Calls of functions and of nodes without state are guarded
//! as a whole. State in an operand goes on in all cycles, as in Lustre, and so do the faults on the way to it.

use super::Elab;
use super::scope::Scope;
use crate::hash::Set;
use crate::typed::{
    Activation, Block, BlockId, Call, Each, Equation, Expr, ExprId, Kind, PrimCall, Unit, UnitId,
    UnitKind,
};
use rpi_image::Role;
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
    ("Rpi::TicksFromSeconds", "Rpi::GuardedTicksFromSeconds"),
];

/// The twin of a primitive that asks whether it counts.
pub(super) fn twin(prim: PrimId) -> Option<PrimId> {
    let desc = prim.desc();
    let row = TWINS
        .iter()
        .find(|row| desc.may_fault && row.0 == desc.name)?;
    PrimId::of(row.1)
}

/// Properties of an expression: of itself or of something in it.
#[derive(Clone, Copy, Default)]
pub(super) struct Within {
    /// Something can fault that a guard would keep from it.
    can_fault: bool,
    /// Something has state, which goes on whatever chooses it.
    goes_on: bool,
}

/// Properties of a unit.
pub(super) struct WithinUnit {
    /// Of each of its expressions.
    exprs: Vec<Within>,
    /// Something can fault in what it computes, or it claims something.
    can_fault: bool,
    /// Calls of it can be guarded as a whole: it has no state, neither in its body nor in a contract.
    is_stateless: bool,
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

    /// Whether the faults of a call follow the choices around it.
    pub(super) fn is_guarded(&mut self, call: &Call) -> bool {
        matches!(call.activation, Activation::Always) && self.is_stateless(call.unit)
    }

    /// Whether a unit has no state.
    pub(super) fn is_stateless(&mut self, unit: UnitId) -> bool {
        match self.units[unit.0 as usize].kind {
            UnitKind::Function => true,
            UnitKind::Node => self.within_unit(unit).is_stateless,
            _ => false,
        }
    }

    /// A constant outside of a unit has no state, and faults when it is worked out or not at all.
    fn within(&mut self, scope: &Scope<'u>, id: ExprId) -> Within {
        match scope.id {
            Some(unit) => self.within_unit(unit).exprs[id.0 as usize],
            None => Within::default(),
        }
    }

    /// Units that are called come first, without recursion: a chain of calls may be longer than the stack is deep.
    fn within_unit(&mut self, id: UnitId) -> Rc<WithinUnit> {
        let mut open = vec![id];
        let mut entered: Set<UnitId> = Set::default();
        while let Some(unit) = open.last().copied() {
            if self.within.contains_key(&unit) {
                open.pop();
            } else if entered.insert(unit) {
                let called = calls(&self.units[unit.0 as usize]).map(|call| call.unit);
                open.extend(called.filter(|called| !entered.contains(called)));
            } else {
                let known = self.of_unit(&self.units[unit.0 as usize]);
                self.within.insert(unit, Rc::new(known));
                open.pop();
            }
        }
        self.within[&id].clone()
    }

    fn of_unit(&self, unit: &Unit) -> WithinUnit {
        let exprs = self.within_each(unit);
        let can_fault = |equation: &Equation| {
            let mut targets = equation.targets.iter();
            exprs[equation.value.0 as usize].can_fault
                || targets.any(|target| target.ty.has_subrange(false))
        };
        let mut blocks = unit.blocks.iter();
        let mut inputs = unit.inputs.iter();
        let can_fault = inputs.any(|input| unit.flow(*input).ty.has_subrange(false))
            || blocks
                .any(|block| !block.claims.is_empty() || block.equations.iter().any(can_fault));
        let is_stateless = match unit.kind {
            UnitKind::Function => true,
            UnitKind::Node => {
                let mut blocks = (0..).map(BlockId).zip(&unit.blocks);
                blocks.all(|(id, block)| is_plain(id, block))
                    && exprs.iter().all(|within| !within.goes_on)
            }
            _ => false,
        };
        WithinUnit {
            exprs,
            can_fault,
            is_stateless,
        }
    }

    /// Of all expressions of a unit at once: their operands come before them.
    fn within_each(&self, unit: &Unit) -> Vec<Within> {
        let mut all: Vec<Within> = Vec::with_capacity(unit.exprs.len());
        for expr in &unit.exprs {
            let mut within = self.alone(expr);
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

    /// Properties of an expression without its operands. On the way to a state nothing is guarded.
    fn alone(&self, expr: &Expr) -> Within {
        let kind = &expr.kind;
        let called = match kind {
            Kind::Call(call) => self.within.get(&call.unit).filter(|called| {
                called.is_stateless && matches!(call.activation, Activation::Always)
            }),
            _ => None,
        };
        let goes_on = match kind {
            Kind::Each(Each::Pre | Each::Last | Each::Hold, _) | Kind::Current(_) => true,
            Kind::Prim(call) => has_state(call),
            // One that is not known yet is part of a ring of calls, an error of its own.
            Kind::Call(_) => called.is_none(),
            _ => false,
        };
        let can_fault = match kind {
            Kind::Select { .. } => true,
            Kind::Build(_) | Kind::Replace { .. } => expr.ty.has_subrange(true),
            Kind::Prim(call) => call.prim.desc().may_fault && !goes_on,
            Kind::Call(_) => called.is_some_and(|called| called.can_fault),
            _ => false,
        };
        Within { can_fault, goes_on }
    }
}

/// Whether a primitive remembers earlier cycles. What it does to a device counts as state, too.
pub(super) fn has_state(call: &PrimCall) -> bool {
    let desc = call.prim.desc();
    !matches!(desc.state, rpi_image::State::None)
        || matches!(desc.role, Role::Delay | Role::Actuator(_) | Role::Export)
}

/// Whether a block of a node is computed as a whole: the body, or a contract.
fn is_plain(id: BlockId, block: &Block) -> bool {
    let is_inside = id != BlockId::ROOT && !block.is_contract;
    !is_inside && block.automata.is_empty() && block.exports.is_empty() && block.when.is_none()
}

/// The calls in a unit.
fn calls(unit: &Unit) -> impl Iterator<Item = &Call> {
    unit.exprs.iter().filter_map(|expr| match &expr.kind {
        Kind::Call(call) => Some(&**call),
        _ => None,
    })
}
