//! Calls. Each call has its own instance, which lives as long as the calling block is not reset (M6.5).

use rpi_sema::typed::{Activation, Call, ElementwiseOp, ExprId, TypedKind, UnitId, UnitKind};

use crate::cycle::{Interpreter, MemoryUpdate};
use crate::instance::{EvalContext, Instance, InstanceId};
use crate::value::{EvalError, Leaf};
use crate::{flow, leaf};

/// Evaluates a call of a function, node or fragment in the current cycle and returns leaf (scalar part) number `k` of
/// its outputs. The leaf is absent in a cycle in which the call does not run.
pub(crate) fn result<'p>(
    interpreter: &mut Interpreter<'p>,
    here: EvalContext,
    id: ExprId,
    call: &'p Call,
    k: usize,
) -> Result<Leaf, EvalError> {
    let leaf = match active_instance(interpreter, here, id, call)? {
        Some(instance) => Some(output(interpreter, instance, k)?),
        None => None,
    };
    match &call.activation {
        Activation::Condact { default, .. } => {
            held_result(interpreter, here, id, k, leaf, *default)
        }
        _ => Ok(leaf.flatten()),
    }
}

/// Returns leaf (scalar part) number `k` of a call with an activation condition. In a cycle in which the call runs,
/// `ran` is the result. In other cycles the result of the last run is returned, which may be absent, and before the
/// first run the value of `default`.
fn held_result(
    interpreter: &mut Interpreter<'_>,
    here: EvalContext,
    id: ExprId,
    k: usize,
    ran: Option<Leaf>,
    default: Option<ExprId>,
) -> Result<Leaf, EvalError> {
    let memory = interpreter.instances[here.instance].memory(here.block);
    let kept = memory.delayed_values.get(&(id, k)).copied();
    let leaf = match (ran.or(kept), default) {
        (Some(leaf), _) => leaf,
        (None, Some(default)) => leaf::evaluate(interpreter, here.unguarded(), default, k)?,
        (None, None) => None,
    };
    interpreter
        .updates
        .push((here, MemoryUpdate::Leaf(id, k, leaf)));
    Ok(leaf)
}

/// Returns the instance of the callee that executes a call in the current cycle, or `None` if the call does not run.
pub(crate) fn active_instance<'p>(
    interpreter: &mut Interpreter<'p>,
    here: EvalContext,
    id: ExprId,
    call: &'p Call,
) -> Result<Option<InstanceId>, EvalError> {
    if let Some(known) = interpreter.instances[here.instance]
        .current
        .entered
        .get(&id)
    {
        return Ok(*known);
    }
    let (runs, afresh) = resolve_activation(interpreter, here, &call.activation)?;
    let entered = runs.then(|| instance(interpreter, here, id, call, afresh));
    let now = &mut interpreter.instances[here.instance].current;
    now.entered.insert(id, entered);
    Ok(entered)
}

/// Returns two Booleans: whether a call runs in the current cycle, and whether it starts with new state.
fn resolve_activation(
    interpreter: &mut Interpreter<'_>,
    here: EvalContext,
    activation: &Activation,
) -> Result<(bool, bool), EvalError> {
    let here = here.unguarded();
    Ok(match activation {
        Activation::Always => (true, false),
        Activation::Restart { every } => {
            (true, leaf::truth(interpreter, here, *every)? == Some(true))
        }
        Activation::Condact { every, restart, .. } => {
            let runs = leaf::truth(interpreter, here, *every)? == Some(true);
            let afresh = match restart {
                Some(restart) => leaf::truth(interpreter, here, *restart)? == Some(true),
                None => false,
            };
            (runs, afresh)
        }
    })
}

fn instance<'p>(
    interpreter: &mut Interpreter<'p>,
    here: EvalContext,
    id: ExprId,
    call: &'p Call,
    afresh: bool,
) -> InstanceId {
    let around = match is_stateless_call(interpreter, call) {
        true => here,
        false => here.unguarded(),
    };
    let caller = Some((around, &call.args[..]));
    let calls = &interpreter.instances[here.instance]
        .memory(here.block)
        .calls;
    let known = calls.get(&id).copied().filter(|_| !afresh);
    let instance = known.unwrap_or_else(|| {
        let unit = &interpreter.units[call.unit.0 as usize];
        interpreter
            .instances
            .push(Instance::new(unit, call.unit, caller));
        interpreter.instances.len() - 1
    });
    let memory = interpreter.instances[here.instance].memory(here.block);
    memory.calls.insert(id, instance);
    interpreter.instances[instance].caller = caller;
    interpreter.enter(instance, around.chosen);
    instance
}

/// Returns leaf number `k` of the outputs of an instance. The leaves (scalar parts) of all out-ports are numbered
/// consecutively.
fn output(
    interpreter: &mut Interpreter<'_>,
    instance: InstanceId,
    mut k: usize,
) -> Result<Leaf, EvalError> {
    let unit = interpreter.instances[instance].unit;
    for flow in &unit.outputs {
        let size = unit.flow(*flow).ty.leaf_count();
        if k < size {
            return flow::evaluate(interpreter, instance, *flow, k);
        }
        k -= size;
    }
    Err(EvalError::Unsupported("a missing out-port".to_owned()))
}

/// Returns whether a call is evaluated only if the enclosing `if`s need its value: it runs in every cycle, and neither
/// the callee nor anything that it calls has state (M6.7).
pub(crate) fn is_stateless_call(interpreter: &Interpreter<'_>, call: &Call) -> bool {
    matches!(call.activation, Activation::Always) && is_stateless(interpreter, call.unit)
}

fn is_stateless(interpreter: &Interpreter<'_>, id: UnitId) -> bool {
    let unit = &interpreter.units[id.0 as usize];
    match unit.kind {
        UnitKind::Function => return true,
        UnitKind::Node => {}
        _ => return false,
    }
    // Blocks other than the body are fragments and states. Contracts do not count.
    let mut inner = unit.blocks.iter().skip(1);
    let has_parts = inner.any(|block| !block.is_contract)
        || unit.blocks.iter().any(|block| !block.automata.is_empty());
    !has_parts
        && !unit
            .exprs
            .iter()
            .any(|expr| is_state(interpreter, &expr.kind))
}

fn is_state(interpreter: &Interpreter<'_>, kind: &TypedKind) -> bool {
    match kind {
        TypedKind::Each(each, _) => matches!(
            each,
            ElementwiseOp::Pre | ElementwiseOp::Last | ElementwiseOp::Hold
        ),
        TypedKind::Current(_) => true,
        TypedKind::Prim(call) => !matches!(call.prim.desc().state, rpi_image::StateSize::None),
        TypedKind::Call(call) => !is_stateless_call(interpreter, call),
        _ => false,
    }
}
