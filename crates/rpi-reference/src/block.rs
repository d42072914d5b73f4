//! Blocks: activation of fragments and states, and their restart.

use std::collections::BTreeSet;

use rpi_sema::typed::{Automaton, BlockId, Transition};

use crate::cycle::{Interpreter, MemoryUpdate};
use crate::instance::{EvalContext, InstanceId, State};
use crate::value::EvalError;

impl<'p> Interpreter<'p> {
    /// Returns whether a block is active in this cycle (M6.2, M6.3). A block that restarts is reset before anything in
    /// it is evaluated.
    pub(crate) fn is_active(
        &mut self,
        instance: InstanceId,
        block: BlockId,
    ) -> Result<bool, EvalError> {
        if let Some(known) = self.instances[instance].current.active.get(&block) {
            return Ok(*known);
        }
        let unit = self.instances[instance].unit;
        let parent = unit.block(block).parent;
        let active = match parent {
            Some(parent) if !self.is_active(instance, parent)? => false,
            _ => {
                let here = EvalContext {
                    instance,
                    block: parent,
                    chosen: true,
                };
                self.is_activated(here, block)?
            }
        };
        self.instances[instance]
            .current
            .active
            .insert(block, active);
        Ok(active)
    }

    /// Evaluates the activation condition of a block, which belongs to the enclosing block.
    pub(crate) fn condition(
        &mut self,
        instance: InstanceId,
        block: BlockId,
    ) -> Result<(), EvalError> {
        let unit = self.instances[instance].unit;
        let parent = unit.block(block).parent;
        let here = EvalContext {
            instance,
            block: parent,
            chosen: true,
        };
        let around = match parent {
            Some(parent) => self.is_active(instance, parent)?,
            None => true,
        };
        match unit.block(block).when {
            Some(when) if around => self.evaluate(here, when),
            _ => Ok(()),
        }
    }

    /// Returns whether a block with an active parent is active.
    fn is_activated(&mut self, here: EvalContext, block: BlockId) -> Result<bool, EvalError> {
        let unit = self.instances[here.instance].unit;
        if let Some(parent) = here.block
            && let Some((k, index)) = state_of(&unit.block(parent).automata, block)
        {
            let state = self.state(here, parent, k)?;
            let active = state.index == index;
            if active && state.restarts {
                self.instances[here.instance].reset(block);
            }
            return Ok(active);
        }
        let content = unit.block(block);
        let active = match content.when {
            Some(when) => self.truth(here, when)? == Some(true),
            None => true,
        };
        let instance = &mut self.instances[here.instance];
        let was_active = instance.memory(here.block).was_active.contains(&block);
        if active && content.restart && !was_active {
            instance.reset(block);
        }
        self.updates
            .push((here, MemoryUpdate::Active(block, active)));
        Ok(active)
    }

    /// Returns the state of an automaton in this cycle. Strong transitions are taken before the state runs.
    fn state(&mut self, here: EvalContext, block: BlockId, k: usize) -> Result<State, EvalError> {
        if let Some(known) = self.instances[here.instance]
            .current
            .states
            .get(&(block, k))
        {
            return Ok(*known);
        }
        let automaton = self.automaton(here, block, k);
        let before = self.before(here, block, k);
        let unless = &automaton.states[before.index as usize].unless;
        let mut state = self.transition_target(here, unless)?.unwrap_or(before);
        state.restarts |= self
            .pending_restarts(here, block, k, before)
            .contains(&state.index);
        let now = &mut self.instances[here.instance].current;
        now.states.insert((block, k), state);
        Ok(state)
    }

    /// Returns the state of an automaton before strong transitions.
    fn before(&mut self, here: EvalContext, block: BlockId, k: usize) -> State {
        let start = State {
            index: self.automaton(here, block, k).initial,
            restarts: false,
        };
        let memory = self.instances[here.instance].memory(Some(block));
        memory.states.get(&k).copied().unwrap_or(start)
    }

    /// Returns the states that must restart when they run next. This includes a state that was entered with a restart
    /// and left before it ran (M14.6).
    fn pending_restarts(
        &mut self,
        here: EvalContext,
        block: BlockId,
        k: usize,
        before: State,
    ) -> BTreeSet<u32> {
        let memory = self.instances[here.instance].memory(Some(block));
        let mut owed = memory.pending_restarts.get(&k).cloned().unwrap_or_default();
        if before.restarts {
            owed.insert(before.index);
        }
        owed
    }

    /// Evaluates the transitions of an automaton; weak ones take effect in the next cycle. All conditions are
    /// evaluated. Those of strong transitions belong to the enclosing block and can fault only if the automaton is in
    /// their state; those of weak transitions belong to the state.
    pub(crate) fn transitions(
        &mut self,
        here: EvalContext,
        block: BlockId,
        k: usize,
    ) -> Result<(), EvalError> {
        let automaton = self.automaton(here, block, k);
        let state = self.state(here, block, k)?;
        let before = self.before(here, block, k);
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
                self.evaluate(around, condition)?;
            }
            if self.is_active(here.instance, inner.block)? {
                let inside = self.inside(here.instance, inner.block);
                for condition in inner.until.iter().filter_map(|one| one.condition) {
                    self.evaluate(inside, condition)?;
                }
                next = self
                    .transition_target(inside, &inner.until)?
                    .unwrap_or(next);
            }
        }
        let mut owed = self.pending_restarts(here, block, k, before);
        owed.remove(&state.index);
        self.updates
            .push((here, MemoryUpdate::State(k, next, owed)));
        for shared in &automaton.shared {
            let flow = self.instances[here.instance].unit.flow(shared.flow);
            let around = self.inside(here.instance, flow.block);
            for leaf in 0..flow.ty.leaf_count() {
                self.updates
                    .push((around, MemoryUpdate::Last(shared.flow, leaf)));
            }
        }
        Ok(())
    }

    /// Returns the target of the first transition whose condition holds.
    fn transition_target(
        &mut self,
        here: EvalContext,
        transitions: &[Transition],
    ) -> Result<Option<State>, EvalError> {
        for transition in transitions {
            let holds = match transition.condition {
                Some(condition) => self.truth(here, condition)? == Some(true),
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

    fn automaton(&self, here: EvalContext, block: BlockId, k: usize) -> &'p Automaton {
        &self.instances[here.instance].unit.block(block).automata[k]
    }
}

/// Returns the automaton that has a block as a state, and the index of that state.
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
