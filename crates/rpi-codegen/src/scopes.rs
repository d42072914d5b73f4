//! Lifetimes of values: which ones are local variables of a cycle, and which need memory between cycles.
//!
//! A plain value of an inactive fragment keeps its old bits in the core. A reader outside of the fragment may see
//! them, so such a value is stored in the state struct.

use crate::access::{copies, step_accesses, table_signals};
use rpi_image::image::{Image, Step};

/// Lifetime of a value slot.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) enum Lifetime {
    /// No step or table reads the slot.
    Unread,
    /// All readers are inside of the scope of the writer: a variable that is declared where it is written.
    Scope,
    /// Written in a scope and read only while the guards of that scope are true: a variable of the whole cycle.
    Cycle,
    /// Read although the scope of the writer may be inactive: a field of the state struct.
    Permanent,
}

/// Guards around a step, from outside to inside, and the numbers of their scopes.
#[derive(Clone, Default)]
struct Position {
    guards: Vec<u32>,
    scopes: Vec<u32>,
}

struct Tracker<'a> {
    image: &'a Image,
    /// Position of the writer of each slot.
    writers: Vec<Option<u32>>,
    positions: Vec<Position>,
    lifetimes: Vec<Lifetime>,
    next_scope: u32,
}

/// Returns the lifetime of each slot. It matters only for value slots.
pub(crate) fn lifetimes(image: &Image) -> Vec<Lifetime> {
    let count = image.layout.end as usize;
    let mut tracker = Tracker {
        image,
        writers: vec![None; count],
        positions: vec![Position::default()],
        lifetimes: vec![Lifetime::Unread; count],
        next_scope: 0,
    };
    tracker.phase(&image.steps);
    tracker.phase(&image.commit);
    let (_, read) = table_signals(image);
    for signal in read {
        (signal.start..signal.slots().end()).for_each(|slot| tracker.read(slot, 0));
        tracker.read(signal.present, 0);
    }
    tracker.lifetimes
}

impl Tracker<'_> {
    fn phase(&mut self, steps: &[Step]) {
        let mut open: Vec<(usize, u32)> = Vec::new();
        let mut at = 0;
        for (pc, step) in steps.iter().enumerate() {
            while let Some((_, outer)) = open.pop_if(|(end, _)| *end <= pc) {
                at = outer;
            }
            self.step(step, at);
            if let Step::Skip { unless, target } = *step {
                open.push((target as usize, at));
                at = self.enter(at, unless);
            }
        }
    }

    fn enter(&mut self, outer: u32, guard: u32) -> u32 {
        let mut position = self.positions[outer as usize].clone();
        position.guards.push(guard);
        position.scopes.push(self.next_scope);
        self.next_scope += 1;
        self.positions.push(position);
        (self.positions.len() - 1) as u32
    }

    fn step(&mut self, step: &Step, at: u32) {
        // In order, because a call of a primitive may read what an earlier call of the same step has written.
        for access in step_accesses(self.image, step) {
            for slot in access.slots.start..access.slots.end() {
                match access.writes {
                    true => self.writers[slot as usize] = Some(at),
                    false => self.read(slot, at),
                }
            }
        }
        if let Step::Copy { at: code, len } = *step {
            for (from, to) in copies(self.image, code, len) {
                self.read(from, at);
                self.writers[to as usize] = Some(at);
            }
        }
    }

    fn read(&mut self, slot: u32, at: u32) {
        let known = &mut self.lifetimes[slot as usize];
        let Some(writer) = self.writers[slot as usize] else {
            // An input, or a flow of the core, which has its value before the steps.
            *known = Lifetime::Cycle.max(*known);
            return;
        };
        let (writer, reader) = (
            &self.positions[writer as usize],
            &self.positions[at as usize],
        );
        let lifetime = if reader.scopes.starts_with(&writer.scopes) {
            Lifetime::Scope
        } else if self.implies(reader, writer) {
            Lifetime::Cycle
        } else {
            Lifetime::Permanent
        };
        let known = &mut self.lifetimes[slot as usize];
        *known = lifetime.max(*known);
    }

    /// Returns whether the writer has run in each cycle in which the reader runs. A guard in the state may change within
    /// a cycle, so it does not count.
    fn implies(&self, reader: &Position, writer: &Position) -> bool {
        let layout = self.image.layout;
        let fixed = |guard: u32| !(layout.external..layout.state).contains(&guard);
        let mut guards = writer.guards.iter();
        guards.all(|guard| fixed(*guard) && reader.guards.contains(guard))
    }
}
