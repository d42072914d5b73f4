//! Order of the statements.
//!
//! The core runs equal primitives one after the other, which suits an interpreter: each instance of a node is spread over
//! the whole cycle. A C compiler keeps a value in a register from its definition to its last use, so here each value is
//! computed where it is needed first. The order of the statements that read, write or fault stays the same where
//! it matters: a result does not change.

use crate::access::{Access, calls, copies, step_accesses, table_signals, used_prim};
use crate::slots::Slots;
use rpi_image::image::{Form, Image, SlotRange, Step};
use std::collections::HashSet;

/// Part of the cycle that is ordered as a whole.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum Unit {
    /// One call of a primitive, or another step.
    Step(Step),
    /// Steps that run only if a guard is true.
    Block { unless: u32, body: Vec<Unit> },
    /// Results of the cycle, which are read before the steps of the commit phase change the state.
    Outputs,
}

/// Returns the parts of a cycle in the order of the C text.
pub(crate) fn order(image: &Image, slots: &Slots) -> Vec<Unit> {
    let mut units = tree(image, slots, &image.steps);
    units.push(Unit::Outputs);
    units.extend(tree(image, slots, &image.commit));
    in_order_of_use(image, units)
}

/// Returns the steps of a phase with one unit per call and nested blocks.
fn tree(image: &Image, slots: &Slots, steps: &[Step]) -> Vec<Unit> {
    let mut open: Vec<(usize, u32, Vec<Unit>)> = Vec::new();
    let mut units = Vec::new();
    for (pc, step) in steps.iter().enumerate() {
        close(&mut open, &mut units, pc);
        match *step {
            Step::Skip { unless, target } => {
                open.push((target as usize, unless, std::mem::take(&mut units)));
            }
            Step::Run {
                prim,
                form,
                start,
                len,
            } => units.extend(single_calls(image, prim, form, SlotRange { start, len })),
            Step::Copy { at, len } => units.extend(single_copies(image, slots, at, len)),
            _ => units.push(Unit::Step(*step)),
        }
    }
    close(&mut open, &mut units, usize::MAX);
    units
}

/// Closes the blocks that end before the step `pc`.
fn close(open: &mut Vec<(usize, u32, Vec<Unit>)>, units: &mut Vec<Unit>, pc: usize) {
    while let Some((_, unless, outer)) = open.pop_if(|block| block.0 <= pc) {
        let body = std::mem::replace(units, outer);
        units.push(Unit::Block { unless, body });
    }
}

/// Returns a unit for each call of a primitive in a step.
fn single_calls(image: &Image, prim: u16, form: Form, words: SlotRange) -> Vec<Unit> {
    let Some(used) = used_prim(image, prim) else {
        return Vec::new();
    };
    let count = calls(image, &used.desc, form, words).len() as u32;
    let len = words.len / count.max(1);
    let call = |k| Step::Run {
        prim,
        form,
        start: words.start + k * len,
        len,
    };
    (0..count).map(|k| Unit::Step(call(k))).collect()
}

/// Returns a unit for each variable that a copy writes. Elements of an array stay together.
fn single_copies(image: &Image, slots: &Slots, at: u32, len: u32) -> Vec<Unit> {
    let pairs = copies(image, at, len);
    let mut units = Vec::new();
    let mut at = at;
    for same in pairs.chunk_by(|a, b| slots.object(a.1) == slots.object(b.1)) {
        let len = 2 * same.len() as u32;
        units.push(Unit::Step(Step::Copy { at, len }));
        at += len;
    }
    units
}

/// Orders units and those of their blocks. A unit that writes all the state of a fragment separates those before it from
/// those after it.
fn in_order_of_use(image: &Image, units: Vec<Unit>) -> Vec<Unit> {
    let mut ordered = Vec::with_capacity(units.len());
    let mut run = Vec::new();
    for unit in units {
        let unit = match unit {
            Unit::Block { unless, body } => Unit::Block {
                unless,
                body: in_order_of_use(image, body),
            },
            other => other,
        };
        if has_reset(&unit) {
            ordered.extend(by_use(image, std::mem::take(&mut run)));
            ordered.push(unit);
        } else {
            run.push(unit);
        }
    }
    ordered.extend(by_use(image, run));
    ordered
}

fn has_reset(unit: &Unit) -> bool {
    match unit {
        Unit::Step(step) => matches!(step, Step::Reset { .. }),
        Unit::Block { body, .. } => body.iter().any(has_reset),
        Unit::Outputs => false,
    }
}

/// Returns units so that each one follows those that it depends on, as closely as possible.
fn by_use(image: &Image, units: Vec<Unit>) -> Vec<Unit> {
    let mut sorting = Sorting::new(dependencies(image, &units));
    for unit in 0..units.len() {
        sorting.place_with_users(unit);
    }
    let mut units: Vec<Option<Unit>> = units.into_iter().map(Some).collect();
    let taken = sorting.order.into_iter().filter_map(|k| units[k].take());
    taken.collect()
}

/// Number of units that may have to be placed before a user of a new value, for the user to follow at once.
const NEAR: usize = 32;

/// Sorting of units: a unit is followed by the users of its value, those first whose results are needed by few others, so
/// that a part of a program that belongs together stays together.
struct Sorting {
    /// Units that come before each unit.
    before: Vec<Vec<u32>>,
    /// Units that come after each unit, those nearest to an end last.
    after: Vec<Vec<u32>>,
    is_placed: Vec<bool>,
    order: Vec<usize>,
}

impl Sorting {
    fn new(before: Vec<Vec<u32>>) -> Sorting {
        let mut after = vec![Vec::new(); before.len()];
        for (k, before) in (0..).zip(&before) {
            before.iter().for_each(|b| after[*b as usize].push(k));
        }
        // Number of units from each one to the nearest that no other one needs. A unit depends only on earlier ones.
        let mut distance = vec![0_u32; before.len()];
        for k in (0..before.len()).rev() {
            after[k].sort_by_key(|a| std::cmp::Reverse(distance[*a as usize]));
            distance[k] = after[k].last().map_or(0, |a| distance[*a as usize] + 1);
        }
        Sorting {
            is_placed: vec![false; before.len()],
            order: Vec::with_capacity(before.len()),
            before,
            after,
        }
    }

    /// Places a unit after all that it depends on, then the units that use what has been placed and need little else.
    fn place_with_users(&mut self, unit: usize) {
        let mut candidates = Vec::new();
        self.place(unit, usize::MAX, &mut candidates);
        while let Some(unit) = candidates.pop() {
            self.place(unit, NEAR, &mut candidates);
        }
    }

    /// Places a unit after all that it depends on, if these are at most `most` units, and appends their users to
    /// `candidates`.
    fn place(&mut self, unit: usize, most: usize, candidates: &mut Vec<usize>) {
        let Some(missing) = self.missing(unit, most) else {
            return;
        };
        for unit in missing {
            self.is_placed[unit] = true;
            self.order.push(unit);
            candidates.extend(self.after[unit].iter().map(|k| *k as usize));
        }
    }

    /// Returns a unit and all units before it that have no place yet, in an order in which they can be placed; `None` if
    /// there are more than `most`. With an explicit stack: chains may have 100 000 units.
    fn missing(&self, unit: usize, most: usize) -> Option<Vec<usize>> {
        let mut found = Vec::new();
        let mut entered = HashSet::new();
        let mut stack = vec![(unit, false)];
        while let Some((unit, is_left)) = stack.pop() {
            if is_left {
                found.push(unit);
            } else if !self.is_placed[unit] && entered.insert(unit) {
                if entered.len() > most {
                    return None;
                }
                stack.push((unit, true));
                let before = self.before[unit].iter().rev();
                stack.extend(before.map(|k| (*k as usize, false)));
            }
        }
        Some(found)
    }
}

/// Users of a slot so far.
#[derive(Clone, Default)]
struct Users {
    writer: Option<u32>,
    readers: Vec<u32>,
}

/// Returns for each unit those that must come before it: writers of what it reads, and readers and writers of what it
/// writes. Units with effects keep their order, because the first fault of a cycle is reported.
fn dependencies(image: &Image, units: &[Unit]) -> Vec<Vec<u32>> {
    let mut users = vec![Users::default(); image.layout.end as usize];
    let mut effect = None;
    let mut all = Vec::with_capacity(units.len());
    for (k, unit) in (0..).zip(units) {
        let mut before = Vec::new();
        let mut accesses = Vec::new();
        unit_accesses(image, unit, &mut accesses);
        for access in accesses {
            for users in &mut users[access.slots.range()] {
                before.extend(users.writer);
                if access.writes {
                    before.append(&mut users.readers);
                    users.writer = Some(k);
                } else {
                    users.readers.push(k);
                }
            }
        }
        if has_effect(image, unit) {
            before.extend(effect.replace(k));
        }
        let mut seen = HashSet::from([k]);
        before.retain(|other| seen.insert(*other));
        all.push(before);
    }
    all
}

fn has_effect(image: &Image, unit: &Unit) -> bool {
    match unit {
        Unit::Step(Step::Run { prim, .. }) => {
            used_prim(image, *prim).is_none_or(|prim| prim.desc.may_fault)
        }
        Unit::Step(Step::Copy { .. }) | Unit::Outputs => false,
        Unit::Step(_) => true,
        Unit::Block { body, .. } => body.iter().any(|unit| has_effect(image, unit)),
    }
}

/// Appends the accesses of a unit. The writes come after the reads of the same call.
fn unit_accesses(image: &Image, unit: &Unit, out: &mut Vec<Access>) {
    match unit {
        Unit::Step(Step::Copy { at, len }) => {
            for (from, to) in copies(image, *at, *len) {
                out.push(Access::new(from, 1, None, false));
                out.push(Access::new(to, 1, None, true));
            }
        }
        Unit::Step(step) => out.extend(step_accesses(image, step)),
        Unit::Block { unless, body } => {
            out.push(Access::new(*unless, 1, None, false));
            body.iter().for_each(|unit| unit_accesses(image, unit, out));
        }
        Unit::Outputs => {
            let (_, read) = table_signals(image);
            for signal in read {
                out.extend(crate::access::signal_accesses(signal, false));
            }
        }
    }
}
