//! Ticks of clocks: whether a leaf or an instance is sampled in the current cycle.

use crate::clock::{Clock, ClockCondition, Clocks, Sampling, call_of};
use crate::cycle::Interpreter;
use crate::instance::{EvalContext, InstanceId};
use crate::value::{EvalError, Leaf};
use crate::{block, call, flow, leaf};
use rpi_sema::typed::ExprId;

/// Returns whether the clock of leaf (scalar part) number `k` of an expression ticks in the current cycle (M4.7).
pub(crate) fn ticks(
    interpreter: &mut Interpreter<'_>,
    here: EvalContext,
    id: ExprId,
    k: usize,
) -> Result<bool, EvalError> {
    let clock = clocks(interpreter, here).exprs[id.0 as usize][k].clone();
    is_running(interpreter, here, &clock)
}

/// Returns whether the clock of a call ticks in the current cycle. `id` is the expression of the call.
pub(crate) fn runs(
    interpreter: &mut Interpreter<'_>,
    here: EvalContext,
    id: ExprId,
) -> Result<bool, EvalError> {
    let clock = clocks(interpreter, here).calls[id.0 as usize].clone();
    is_running(interpreter, here, &clock)
}

fn is_running(
    interpreter: &mut Interpreter<'_>,
    here: EvalContext,
    clock: &Clock,
) -> Result<bool, EvalError> {
    for on in clock.iter().flat_map(|clock| clock.iter()) {
        if is_on(interpreter, here, on)? != Some(true) {
            return Ok(false);
        }
    }
    Ok(true)
}

pub(crate) fn clocks<'s>(interpreter: &'s Interpreter<'_>, here: EvalContext) -> &'s Clocks {
    &interpreter.clocks[interpreter.instances[here.instance].id.0 as usize]
}

/// Returns whether the condition of a sampling step has the value that the step requires; `None` if the condition is
/// absent in the current cycle.
pub(crate) fn is_on(
    interpreter: &mut Interpreter<'_>,
    here: EvalContext,
    on: &Sampling,
) -> Result<Option<bool>, EvalError> {
    let leaf = condition_value(interpreter, here.instance, &on.by)?;
    Ok(leaf.map(|leaf| leaf::equals_value(leaf, on.value)))
}

/// Returns the value of a clock condition in the current cycle: the value of a flow, or of a condition inside a call,
/// which may be in another block.
fn condition_value(
    interpreter: &mut Interpreter<'_>,
    instance: InstanceId,
    by: &ClockCondition,
) -> Result<Leaf, EvalError> {
    let (id, inner) = match by {
        ClockCondition::Flow(flow) => return flow::evaluate(interpreter, instance, *flow, 0),
        ClockCondition::InCall(id, inner) => (*id, inner),
    };
    let it = &interpreter.instances[instance];
    let (unit, block) = (it.unit, interpreter.clocks[it.id.0 as usize].block(id));
    let Some(call) = call_of(&unit.expr(id).kind) else {
        return Ok(None);
    };
    if !block::is_active(interpreter, instance, block)? {
        return Ok(None);
    }
    match call::active_instance(interpreter, interpreter.inside(instance, block), id, call)? {
        Some(behind) => condition_value(interpreter, behind, inner),
        None => Ok(None),
    }
}
