//! Guards for operations in operands that are not always needed: a branch of an `if`, the right side of `??`, `and`,
//! `or` and `=>`, a side of `->`, the condition of a strong transition. Such an operation faults only in cycles in
//! which its operand is needed. A primitive that can fault has a guarded variant with a condition as its first input.
//! Calls of functions and of stateless nodes are guarded as a whole. State in an operand runs in all cycles, as in
//! Lustre, and so do the faults of the operations that feed it.

use crate::elab::Elaborator;
use crate::elab::scope::Scope;
use crate::hash::FastSet;
use crate::typed::{Activation, Call, ElementwiseOp, Expr, PrimCall, TypedKind};
use crate::typed::{Block, BlockId, Equation, ExprId, Unit, UnitId, UnitKind};
use rpi_image::Role;
use rpi_prims::PrimId;
use std::rc::Rc;

/// Primitives that can fault, each with the variant of the primitive that runs only while a guard is true.
const GUARDED_VARIANTS: &[(&str, &str)] = &[
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

/// Returns the variant of a primitive that runs only while a guard is true; `None` if it has none.
pub(super) fn guarded_variant(prim: PrimId) -> Option<PrimId> {
    let desc = prim.desc();
    let row = GUARDED_VARIANTS
        .iter()
        .find(|row| desc.may_fault && row.0 == desc.name)?;
    PrimId::from_name(row.1)
}

/// Properties of an expression, including its operands and the units that it calls.
#[derive(Clone, Copy, Default)]
pub(super) struct ExprProperties {
    /// Whether the expression, including its operands, contains an operation that can fault and can be guarded.
    can_fault: bool,
    /// Whether the expression, including its operands, contains state, which runs in all cycles.
    has_state: bool,
}

/// Properties of a unit and of its expressions, for deciding which operations run only under a condition.
pub(super) struct UnitProperties {
    /// Properties of each expression of the unit, by the index of the expression.
    exprs: Vec<ExprProperties>,
    /// Whether the unit contains an operation that can fault, or a claim (an assertion or a clause of a contract).
    can_fault: bool,
    /// Whether the unit has no state, neither in its body nor in a contract. Calls of such a unit can be guarded as a
    /// whole.
    is_stateless: bool,
}

/// Returns whether an expression contains an operation that can fault and can be guarded.
pub(super) fn elab_can_fault<'u>(elab: &mut Elaborator<'u>, scope: &Scope<'u>, id: ExprId) -> bool {
    expr_properties(elab, scope, id).can_fault
}

/// Returns whether an expression contains state, which runs in all cycles.
pub(super) fn contains_state<'u>(elab: &mut Elaborator<'u>, scope: &Scope<'u>, id: ExprId) -> bool {
    expr_properties(elab, scope, id).has_state
}

/// Returns whether a call can run as a whole only while a guard is true, because the called unit has no state.
pub(super) fn is_guarded(elab: &mut Elaborator<'_>, call: &Call) -> bool {
    matches!(call.activation, Activation::Always) && is_stateless_expr(elab, call.unit)
}

/// Returns whether a unit has no state. A call of such a unit may be left out in cycles that do not need its result.
pub(super) fn is_stateless_expr(elab: &mut Elaborator<'_>, unit: UnitId) -> bool {
    match elab.units[unit.0 as usize].kind {
        UnitKind::Function => true,
        UnitKind::Node => unit_properties(elab, unit).is_stateless,
        _ => false,
    }
}

/// Returns the properties of an expression. An expression outside of any unit has no state and does not fault at run
/// time.
fn expr_properties<'u>(elab: &mut Elaborator<'u>, scope: &Scope<'u>, id: ExprId) -> ExprProperties {
    match scope.id {
        Some(unit) => unit_properties(elab, unit).exprs[id.0 as usize],
        None => ExprProperties::default(),
    }
}

/// Returns the properties of a unit, computed after those of the units that it calls. The computation is iterative,
/// because a chain of calls could overflow the stack.
fn unit_properties(elab: &mut Elaborator<'_>, id: UnitId) -> Rc<UnitProperties> {
    let mut open = vec![id];
    let mut entered: FastSet<UnitId> = FastSet::default();
    while let Some(unit) = open.last().copied() {
        if elab.cache.unit_properties.contains_key(&unit) {
            open.pop();
        } else if entered.insert(unit) {
            let called = calls(&elab.units[unit.0 as usize]).map(|call| call.unit);
            open.extend(called.filter(|called| !entered.contains(called)));
        } else {
            let known = compute_unit_properties(elab, &elab.units[unit.0 as usize]);
            elab.cache.unit_properties.insert(unit, Rc::new(known));
            open.pop();
        }
    }
    elab.cache.unit_properties[&id].clone()
}

fn compute_unit_properties(elab: &Elaborator<'_>, unit: &Unit) -> UnitProperties {
    let exprs = compute_expr_properties(elab, unit);
    let can_fault = |equation: &Equation| {
        let mut targets = equation.targets.iter();
        exprs[equation.value.0 as usize].can_fault
            || targets.any(|target| target.ty.has_subrange(false))
    };
    let mut blocks = unit.blocks.iter();
    let mut inputs = unit.inputs.iter();
    let can_fault = inputs.any(|input| unit.flow(*input).ty.has_subrange(false))
        || blocks.any(|block| !block.claims.is_empty() || block.equations.iter().any(can_fault));
    let is_stateless = match unit.kind {
        UnitKind::Function => true,
        UnitKind::Node => {
            let mut blocks = (0..).map(BlockId).zip(&unit.blocks);
            blocks.all(|(id, block)| has_no_fragment(id, block))
                && exprs.iter().all(|within| !within.has_state)
        }
        _ => false,
    };
    UnitProperties {
        exprs,
        can_fault,
        is_stateless,
    }
}

/// Returns the properties of all expressions of a unit, by index. Operands precede the expressions that use them.
fn compute_expr_properties(elab: &Elaborator<'_>, unit: &Unit) -> Vec<ExprProperties> {
    let mut all: Vec<ExprProperties> = Vec::with_capacity(unit.exprs.len());
    for expr in &unit.exprs {
        let mut within = own_properties(elab, expr);
        if !within.has_state {
            expr.kind.operands(&mut |operand| {
                let operand = all[operand.0 as usize];
                within.can_fault |= operand.can_fault;
                within.has_state |= operand.has_state;
            });
        }
        all.push(within);
    }
    all
}

/// Returns the properties of an expression without those of its operands. Operations whose values are stored in a state
/// are not guarded.
fn own_properties(elab: &Elaborator<'_>, expr: &Expr) -> ExprProperties {
    let kind = &expr.kind;
    let called =
        match kind {
            TypedKind::Call(call) => elab.cache.unit_properties.get(&call.unit).filter(|called| {
                called.is_stateless && matches!(call.activation, Activation::Always)
            }),
            _ => None,
        };
    let goes_on = match kind {
        TypedKind::Each(ElementwiseOp::Pre | ElementwiseOp::Last | ElementwiseOp::Hold, _)
        | TypedKind::Current(_) => true,
        TypedKind::Prim(call) => has_state(call),
        // A callee without properties is part of a recursion, which is reported elsewhere.
        TypedKind::Call(_) => called.is_none(),
        _ => false,
    };
    let can_fault = match kind {
        TypedKind::Select { .. } => true,
        TypedKind::Build(_) | TypedKind::Replace { .. } => expr.ty.has_subrange(true),
        TypedKind::Prim(call) => call.prim.desc().may_fault && !goes_on,
        TypedKind::Call(_) => called.is_some_and(|called| called.can_fault),
        _ => false,
    };
    ExprProperties {
        can_fault,
        has_state: goes_on,
    }
}

/// Returns whether a primitive has state. Access to a device counts as state.
pub(super) fn has_state(call: &PrimCall) -> bool {
    let desc = call.prim.desc();
    !matches!(desc.state, rpi_image::StateSize::None)
        || matches!(desc.role, Role::Delay | Role::Actuator(_) | Role::Export)
}

/// Returns whether a block has no fragment of its own: it is the body of the unit or a contract, and has no automata,
/// exports or activation condition.
fn has_no_fragment(id: BlockId, block: &Block) -> bool {
    let is_inside = id != BlockId::ROOT && !block.is_contract;
    !is_inside && block.automata.is_empty() && block.exports.is_empty() && block.when.is_none()
}

/// Returns all calls in the expressions of a unit.
fn calls(unit: &Unit) -> impl Iterator<Item = &Call> {
    unit.exprs.iter().filter_map(|expr| match &expr.kind {
        TypedKind::Call(call) => Some(&**call),
        _ => None,
    })
}
