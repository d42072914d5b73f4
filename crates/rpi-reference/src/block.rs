//! Blocks: activation of fragments and states, and their restart.

use std::collections::BTreeSet;

use rpi_sema::typed::{Automaton, BlockId, Transition};

use crate::cycle::{Interpreter, MemoryUpdate};
use crate::instance::{EvalContext, InstanceId, State};
use crate::leaf;
use crate::value::EvalError;

/// Returns whether a block (body, fragment or state of an automaton) of an instance is active in the current cycle
/// (M6.2, M6.3). A block that restarts in this cycle is reset before anything in it is evaluated.
pub(crate) fn is_active(
    interpreter: &mut Interpreter<'_>,
    instance: InstanceId,
    block: BlockId,
) -> Result<bool, EvalError> {
    if let Some(known) = interpreter.instances[instance].current.active.get(&block) {
        return Ok(*known);
    }
    let unit = interpreter.instances[instance].unit;
    let parent = unit.block(block).parent;
    let active = match parent {
        Some(parent) if !is_active(interpreter, instance, parent)? => false,
        _ => {
            let here = EvalContext {
                instance,
                block: parent,
                chosen: true,
            };
            is_activated(interpreter, here, block)?
        }
    };
    interpreter.instances[instance]
        .current
        .active
        .insert(block, active);
    Ok(active)
}

/// Evaluates the activation condition of a block (fragment or state of an automaton) if the enclosing block is active,
/// because its evaluation may fault or update state. The condition belongs to the enclosing block.
pub(crate) fn condition(
    interpreter: &mut Interpreter<'_>,
    instance: InstanceId,
    block: BlockId,
) -> Result<(), EvalError> {
    let unit = interpreter.instances[instance].unit;
    let parent = unit.block(block).parent;
    let here = EvalContext {
        instance,
        block: parent,
        chosen: true,
    };
    let around = match parent {
        Some(parent) => is_active(interpreter, instance, parent)?,
        None => true,
    };
    match unit.block(block).when {
        Some(when) if around => interpreter.evaluate(here, when),
        _ => Ok(()),
    }
}

/// Returns whether a block is active, given that the enclosing block is active; `here` is the context of that enclosing
/// block. Resets the block if it restarts in this cycle.
fn is_activated(
    interpreter: &mut Interpreter<'_>,
    here: EvalContext,
    block: BlockId,
) -> Result<bool, EvalError> {
    let unit = interpreter.instances[here.instance].unit;
    if let Some(parent) = here.block
        && let Some((k, index)) = state_of(&unit.block(parent).automata, block)
    {
        let state = state(interpreter, here, parent, k)?;
        let active = state.index == index;
        if active && state.restarts {
            interpreter.instances[here.instance].reset(block);
        }
        return Ok(active);
    }
    let content = unit.block(block);
    let active = match content.when {
        Some(when) => leaf::truth(interpreter, here, when)? == Some(true),
        None => true,
    };
    let instance = &mut interpreter.instances[here.instance];
    let was_active = instance.memory(here.block).was_active.contains(&block);
    if active && content.restart && !was_active {
        instance.reset(block);
    }
    interpreter
        .updates
        .push((here, MemoryUpdate::Active(block, active)));
    Ok(active)
}

/// Returns the state of automaton number `k` of a block in the current cycle. Strong transitions (`unless`) are taken
/// before the state runs.
fn state(
    interpreter: &mut Interpreter<'_>,
    here: EvalContext,
    block: BlockId,
    k: usize,
) -> Result<State, EvalError> {
    if let Some(known) = interpreter.instances[here.instance]
        .current
        .states
        .get(&(block, k))
    {
        return Ok(*known);
    }
    let automaton = automaton(interpreter, here, block, k);
    let before = before(interpreter, here, block, k);
    let unless = &automaton.states[before.index as usize].unless;
    let mut state = transition_target(interpreter, here, unless)?.unwrap_or(before);
    state.restarts |= pending_restarts(interpreter, here, block, k, before).contains(&state.index);
    let now = &mut interpreter.instances[here.instance].current;
    now.states.insert((block, k), state);
    Ok(state)
}

/// Returns the state in which automaton number `k` of a block begins the current cycle, before its strong transitions
/// (`unless`).
fn before(interpreter: &mut Interpreter<'_>, here: EvalContext, block: BlockId, k: usize) -> State {
    let start = State {
        index: automaton(interpreter, here, block, k).initial,
        restarts: false,
    };
    let memory = interpreter.instances[here.instance].memory(Some(block));
    memory.states.get(&k).copied().unwrap_or(start)
}

/// Returns the indices of the states of automaton number `k` that must restart when they run next. These include states
/// that were entered with a restart and left before they ran (M14.6). `before` is the state at the start of the cycle.
fn pending_restarts(
    interpreter: &mut Interpreter<'_>,
    here: EvalContext,
    block: BlockId,
    k: usize,
    before: State,
) -> BTreeSet<u32> {
    let memory = interpreter.instances[here.instance].memory(Some(block));
    let mut owed = memory.pending_restarts.get(&k).cloned().unwrap_or_default();
    if before.restarts {
        owed.insert(before.index);
    }
    owed
}

/// Evaluates the transitions of automaton number `k` of a block and stores its state for the next cycle, in which weak
/// transitions (`until`) take effect. All conditions are evaluated. The conditions of strong transitions (`unless`)
/// belong to the enclosing block, and can fault only if the automaton is in the state of the transition; those of weak
/// transitions belong to the state.
pub(crate) fn transitions(
    interpreter: &mut Interpreter<'_>,
    here: EvalContext,
    block: BlockId,
    k: usize,
) -> Result<(), EvalError> {
    let automaton = automaton(interpreter, here, block, k);
    let state = state(interpreter, here, block, k)?;
    let before = before(interpreter, here, block, k);
    let mut next = State {
        index: state.index,
        restarts: false,
    };
    for (index, inner) in (0..).zip(&automaton.states) {
        let around = EvalContext {
            chosen: here.chosen && before.index == index,
            ..here
        };
        for condition in inner.unless.iter().filter_map(|one| one.condition) {
            interpreter.evaluate(around, condition)?;
        }
        if is_active(interpreter, here.instance, inner.block)? {
            let inside = interpreter.inside(here.instance, inner.block);
            for condition in inner.until.iter().filter_map(|one| one.condition) {
                interpreter.evaluate(inside, condition)?;
            }
            next = transition_target(interpreter, inside, &inner.until)?.unwrap_or(next);
        }
    }
    let mut owed = pending_restarts(interpreter, here, block, k, before);
    owed.remove(&state.index);
    interpreter
        .updates
        .push((here, MemoryUpdate::State(k, next, owed)));
    for shared in &automaton.shared {
        let flow = interpreter.instances[here.instance].unit.flow(shared.flow);
        let around = interpreter.inside(here.instance, flow.block);
        for leaf in 0..flow.ty.leaf_count() {
            interpreter
                .updates
                .push((around, MemoryUpdate::Last(shared.flow, leaf)));
        }
    }
    Ok(())
}

/// Returns the target state of the first transition whose condition is true, and whether that state restarts; `None` if
/// no condition is true.
fn transition_target(
    interpreter: &mut Interpreter<'_>,
    here: EvalContext,
    transitions: &[Transition],
) -> Result<Option<State>, EvalError> {
    for transition in transitions {
        let holds = match transition.condition {
            Some(condition) => leaf::truth(interpreter, here, condition)? == Some(true),
            None => true,
        };
        if holds {
            return Ok(Some(State {
                index: transition.target,
                restarts: !transition.resumes,
            }));
        }
    }
    Ok(None)
}

fn automaton<'p>(
    interpreter: &Interpreter<'p>,
    here: EvalContext,
    block: BlockId,
    k: usize,
) -> &'p Automaton {
    &interpreter.instances[here.instance]
        .unit
        .block(block)
        .automata[k]
}

/// Returns the index of the automaton that has `block` as a state, and the index of that state; `None` if `block` is
/// not a state of any of the automata.
fn state_of(automata: &[Automaton], block: BlockId) -> Option<(usize, u32)> {
    for (k, automaton) in automata.iter().enumerate() {
        for (index, state) in (0..).zip(&automaton.states) {
            if state.block == block {
                return Some((k, index));
            }
        }
    }
    None
}
