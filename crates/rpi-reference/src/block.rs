//! Blocks: activation of fragments and states, and their restart.

use std::collections::BTreeSet;

use rpi_sema::typed::{Automaton, BlockId, Transition};

use crate::cycle::{Keep, Reference};
use crate::instance::{Here, InstanceId, State};
use crate::value::Stop;

impl<'p> Reference<'p> {
    /// Returns whether a block is active in this cycle (M6.2, M6.3). A block that restarts is reset before anything in
    /// it is evaluated.
    pub(crate) fn is_active(&mut self, instance: InstanceId, block: BlockId) -> Result<bool, Stop> {
        if let Some(known) = self.instances[instance].now.active.get(&block) {
            return Ok(*known);
        }
        let unit = self.instances[instance].unit;
        let parent = unit.block(block).parent;
        let active = match parent {
            Some(parent) if !self.is_active(instance, parent)? => false,
            _ => {
                let here = Here {
                    instance,
                    block: parent,
                    chosen: true,
                };
                self.begins(here, block)?
            }
        };
        self.instances[instance].now.active.insert(block, active);
        Ok(active)
    }

    /// Evaluates the activation condition of a block, which belongs to the enclosing block.
    pub(crate) fn condition(&mut self, instance: InstanceId, block: BlockId) -> Result<(), Stop> {
        let unit = self.instances[instance].unit;
        let parent = unit.block(block).parent;
        let here = Here {
            instance,
            block: parent,
            chosen: true,
        };
        let around = match parent {
            Some(parent) => self.is_active(instance, parent)?,
            None => true,
        };
        match unit.block(block).when {
            Some(when) if around => self.visit(here, when),
            _ => Ok(()),
        }
    }

    /// Returns whether a block with an active parent is active.
    fn begins(&mut self, here: Here, block: BlockId) -> Result<bool, Stop> {
        let unit = self.instances[here.instance].unit;
        if let Some(parent) = here.block
            && let Some((k, index)) = state_of(&unit.block(parent).automata, block)
        {
            let state = self.state(here, parent, k)?;
            let active = state.index == index;
            if active && state.afresh {
                self.instances[here.instance].start_afresh(block);
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
            instance.start_afresh(block);
        }
        self.keep.push((here, Keep::Active(block, active)));
        Ok(active)
    }

    /// Returns the state of an automaton in this cycle. Strong transitions are taken before the state runs.
    fn state(&mut self, here: Here, block: BlockId, k: usize) -> Result<State, Stop> {
        if let Some(known) = self.instances[here.instance].now.states.get(&(block, k)) {
            return Ok(*known);
        }
        let automaton = self.automaton(here, block, k);
        let before = self.before(here, block, k);
        let unless = &automaton.states[before.index as usize].unless;
        let mut state = self.taken(here, unless)?.unwrap_or(before);
        state.afresh |= self.owed(here, block, k, before).contains(&state.index);
        let now = &mut self.instances[here.instance].now;
        now.states.insert((block, k), state);
        Ok(state)
    }

    /// Returns the state of an automaton before strong transitions.
    fn before(&mut self, here: Here, block: BlockId, k: usize) -> State {
        let start = State {
            index: self.automaton(here, block, k).initial,
            afresh: false,
        };
        let memory = self.instances[here.instance].memory(Some(block));
        memory.states.get(&k).copied().unwrap_or(start)
    }

    /// Returns the states that must restart when they run next. This includes a state that was entered with a restart
    /// and left before it ran (M14.6).
    fn owed(&mut self, here: Here, block: BlockId, k: usize, before: State) -> BTreeSet<u32> {
        let memory = self.instances[here.instance].memory(Some(block));
        let mut owed = memory.owed.get(&k).cloned().unwrap_or_default();
        if before.afresh {
            owed.insert(before.index);
        }
        owed
    }

    /// Evaluates the transitions of an automaton; weak ones take effect in the next cycle. All conditions are
    /// evaluated. Those of strong transitions belong to the enclosing block and can fault only if the automaton is in
    /// their state; those of weak transitions belong to the state.
    pub(crate) fn transitions(&mut self, here: Here, block: BlockId, k: usize) -> Result<(), Stop> {
        let automaton = self.automaton(here, block, k);
        let state = self.state(here, block, k)?;
        let before = self.before(here, block, k);
        let mut next = State {
            index: state.index,
            afresh: false,
        };
        for (index, inner) in (0..).zip(&automaton.states) {
            let around = Here {
                chosen: here.chosen && before.index == index,
                ..here
            };
            for condition in inner.unless.iter().filter_map(|one| one.condition) {
                self.visit(around, condition)?;
            }
            if self.is_active(here.instance, inner.block)? {
                let inside = self.inside(here.instance, inner.block);
                for condition in inner.until.iter().filter_map(|one| one.condition) {
                    self.visit(inside, condition)?;
                }
                next = self.taken(inside, &inner.until)?.unwrap_or(next);
            }
        }
        let mut owed = self.owed(here, block, k, before);
        owed.remove(&state.index);
        self.keep.push((here, Keep::State(k, next, owed)));
        for shared in &automaton.shared {
            let flow = self.instances[here.instance].unit.flow(shared.flow);
            let around = self.inside(here.instance, flow.block);
            for leaf in 0..flow.ty.leaf_count() {
                self.keep.push((around, Keep::Last(shared.flow, leaf)));
            }
        }
        Ok(())
    }

    /// Returns the target of the first transition whose condition holds.
    fn taken(&mut self, here: Here, transitions: &[Transition]) -> Result<Option<State>, Stop> {
        for transition in transitions {
            let holds = match transition.condition {
                Some(condition) => self.truth(here, condition)? == Some(true),
                None => true,
            };
            if holds {
                return Ok(Some(State {
                    index: transition.target,
                    afresh: !transition.resumes,
                }));
            }
        }
        Ok(None)
    }

    fn automaton(&self, here: Here, block: BlockId, k: usize) -> &'p Automaton {
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
