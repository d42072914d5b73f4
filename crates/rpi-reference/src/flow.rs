//! Values of flows: from the caller, from an equation, or from the states of an automaton.

use rpi_sema::typed::{BlockId, ExprId, FlowId, SharedFlow, TargetPlace, Unit};

use crate::cycle::Interpreter;
use crate::instance::InstanceId;
use crate::value::{EvalError, Leaf, Value};
use crate::{block, leaf};

/// Returns leaf (scalar part) number `k` of a flow in the current cycle. A value outside of the declared integer
/// subrange of the flow is a fault (M2.4).
pub(crate) fn evaluate(
    interpreter: &mut Interpreter<'_>,
    instance: InstanceId,
    flow: FlowId,
    k: usize,
) -> Result<Leaf, EvalError> {
    let leaf = unchecked(interpreter, instance, flow, k)?;
    let unit = interpreter.instances[instance].unit;
    let ty = &unit.flow(flow).ty;
    let from_outside =
        interpreter.instances[instance].caller.is_none() && unit.inputs.contains(&flow);
    let range = ty.subranges(from_outside).into_iter().find(|of| of.0 == k);
    match (leaf, range) {
        (Some(Value::Int(number)), Some((_, range)))
            if !range.contains(number) && interpreter.instances[instance].current.chosen =>
        {
            Err(EvalError::Fault("subrange"))
        }
        _ => Ok(leaf),
    }
}

fn unchecked(
    interpreter: &mut Interpreter<'_>,
    instance: InstanceId,
    flow: FlowId,
    k: usize,
) -> Result<Leaf, EvalError> {
    let unit = interpreter.instances[instance].unit;
    if let Some(port) = unit.inputs.iter().position(|input| *input == flow) {
        return argument(interpreter, instance, port, k);
    }
    if let Some((block, shared)) = shared(unit, flow) {
        return shared_flow(interpreter, instance, block, shared, k);
    }
    let Some((block, value, leaf)) = definition(unit, flow, k) else {
        let name = &unit.flow(flow).name;
        return Err(EvalError::Unsupported(format!("`{name}` has no equation")));
    };
    // Outside of its inactive fragment a flow is absent (M6.3).
    if !block::is_active(interpreter, instance, block)? {
        return Ok(None);
    }
    let here = interpreter.inside(instance, block);
    leaf::evaluate(interpreter, here, value, leaf)
}

/// Returns leaf (scalar part) number `k` of the in-port with index `port`: from the argument of the call, else from the
/// default of the port. For the whole program the value comes from the inputs of the cycle.
fn argument(
    interpreter: &mut Interpreter<'_>,
    instance: InstanceId,
    port: usize,
    k: usize,
) -> Result<Leaf, EvalError> {
    let it = &interpreter.instances[instance];
    let Some((caller, args)) = it.caller else {
        return Ok(interpreter.input(port, k));
    };
    match (args[port], it.unit.flow(it.unit.inputs[port]).default) {
        (Some(arg), _) => leaf::evaluate(interpreter, caller, arg, k),
        (None, Some(default)) => {
            let here = interpreter.inside(instance, BlockId::ROOT);
            leaf::evaluate(interpreter, here, default, k)
        }
        (None, None) => Ok(None),
    }
}

/// Returns leaf (scalar part) number `k` of a flow that the states of an automaton share: from the active state, or the
/// default if that state does not define the flow (M14.5).
fn shared_flow(
    interpreter: &mut Interpreter<'_>,
    instance: InstanceId,
    block: BlockId,
    shared: &SharedFlow,
    k: usize,
) -> Result<Leaf, EvalError> {
    if !block::is_active(interpreter, instance, block)? {
        return Ok(None);
    }
    for inner in &shared.states {
        let state = interpreter.instances[instance].unit.flow(*inner).block;
        if block::is_active(interpreter, instance, state)? {
            return evaluate(interpreter, instance, *inner, k);
        }
    }
    match shared.default {
        Some(default) => evaluate(interpreter, instance, default, k),
        None => Ok(None),
    }
}

/// Returns the declaration of a flow as shared by the states of an automaton, and the block that contains the
/// automaton; `None` for a flow that is not shared.
fn shared(unit: &Unit, flow: FlowId) -> Option<(BlockId, &SharedFlow)> {
    let blocks = (0..).map(BlockId).zip(&unit.blocks);
    let mut all = blocks.flat_map(|(id, block)| {
        let automata = block.automata.iter();
        automata.flat_map(move |automaton| automaton.shared.iter().map(move |shared| (id, shared)))
    });
    all.find(|(_, shared)| shared.flow == flow)
}

/// Returns the definition of leaf (scalar part) number `k` of a flow: the block of the equation, the expression on its
/// right, and the index of the leaf in that expression. Returns `None` if no equation defines the leaf.
pub(crate) fn definition(unit: &Unit, flow: FlowId, k: usize) -> Option<(BlockId, ExprId, usize)> {
    for (id, block) in (0..).map(BlockId).zip(&unit.blocks) {
        for equation in &block.equations {
            let mut first = 0;
            for target in &equation.targets {
                let size = target.ty.leaf_count();
                if let TargetPlace::Flow { flow: defined, at } = target.place
                    && defined == flow
                    && (at as usize..at as usize + size).contains(&k)
                {
                    return Some((id, equation.value, first + k - at as usize));
                }
                first += size;
            }
        }
    }
    None
}
