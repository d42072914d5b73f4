//! Types of the slots of an image, arrays of adjacent slots, and lifetimes of values.

use crate::access::{Access, copies, signal_accesses, step_accesses, table_signals};
use crate::c_type::CType;
use crate::scopes::{Lifetime, lifetimes};
use rpi_image::image::{Image, SlotRange, Step};

/// Region of the memory of an image.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Region {
    Constant,
    External,
    State,
    Value,
}

/// Properties of all slots of an image.
pub(crate) struct Slots {
    types: Vec<CType>,
    /// Ranges of slots that form one C array, in ascending order.
    arrays: Vec<SlotRange>,
    lifetimes: Vec<Lifetime>,
    /// Whether a step or a result of the cycle uses each slot.
    is_used: Vec<bool>,
    layout: rpi_image::image::Layout,
    /// Initial bits of all slots.
    initial: Vec<u64>,
}

impl Slots {
    pub(crate) fn new(image: &Image) -> Slots {
        let layout = image.layout;
        let mut accesses = Vec::new();
        let mut equal = SlotClasses::new(layout.end);
        let mut is_used = vec![false; layout.end as usize];
        for step in image.steps.iter().chain(&image.commit) {
            accesses.extend(step_accesses(image, step));
            if let Step::Copy { at, len } = *step {
                let pairs = copies(image, at, len);
                let pairs = pairs.iter().filter(|pair| pair.0 >= layout.constants);
                for pair in pairs {
                    equal.join(pair.0, pair.1);
                    is_used[pair.0 as usize] = true;
                    is_used[pair.1 as usize] = true;
                }
            }
        }
        let (external, read) = table_signals(image);
        accesses.extend(read.iter().flat_map(|s| signal_accesses(*s, false)));
        for access in &accesses {
            is_used[access.slots.range()].fill(true);
        }
        accesses.extend(external.iter().flat_map(|s| signal_accesses(*s, true)));
        let arrays = arrays(&accesses, layout.constants);
        for array in &arrays {
            (array.start + 1..array.end()).for_each(|k| equal.join(array.start, k));
        }
        let mut initial = vec![0; layout.end as usize];
        for (slot, bits) in &image.init {
            initial[*slot as usize] = *bits;
        }
        Slots {
            types: types(&accesses, &mut equal, layout.constants),
            arrays,
            lifetimes: lifetimes(image),
            is_used,
            layout,
            initial,
        }
    }

    pub(crate) fn ty(&self, slot: u32) -> CType {
        self.types[slot as usize]
    }

    pub(crate) fn initial(&self, slot: u32) -> u64 {
        self.initial[slot as usize]
    }

    pub(crate) fn lifetime(&self, slot: u32) -> Lifetime {
        self.lifetimes[slot as usize]
    }

    /// Returns whether a step or a result of the cycle uses some of the slots.
    pub(crate) fn is_used(&self, slots: SlotRange) -> bool {
        self.is_used[slots.range()].contains(&true)
    }

    pub(crate) fn region(&self, slot: u32) -> Region {
        match slot {
            s if s < self.layout.constants => Region::Constant,
            s if s < self.layout.external => Region::External,
            s if s < self.layout.state => Region::State,
            _ => Region::Value,
        }
    }

    /// Returns the C array that contains a slot, else the slot alone.
    pub(crate) fn object(&self, slot: u32) -> SlotRange {
        let after = self.arrays.partition_point(|a| a.start <= slot);
        let found = after.checked_sub(1).map(|k| self.arrays[k]);
        let alone = SlotRange {
            start: slot,
            len: 1,
        };
        found.filter(|a| slot < a.end()).unwrap_or(alone)
    }

    /// Returns all C objects in a range of slots, in ascending order.
    pub(crate) fn objects(&self, start: u32, end: u32) -> Vec<SlotRange> {
        let next = |object: &SlotRange| Some(object.end()).filter(|e| *e < end);
        let first = Some(self.object(start)).filter(|_| start < end);
        std::iter::successors(first, |object| next(object).map(|slot| self.object(slot))).collect()
    }
}

/// Merges overlapping accesses to several slots. Constants need no arrays here: each access gets a copy.
fn arrays(accesses: &[Access], constants: u32) -> Vec<SlotRange> {
    let ranges = accesses.iter().filter(|a| a.is_array).map(|a| a.slots);
    let mut ranges: Vec<SlotRange> = ranges.filter(|r| r.start >= constants).collect();
    ranges.sort_unstable_by_key(|r| (r.start, r.len));
    let mut merged: Vec<SlotRange> = Vec::new();
    for range in ranges {
        match merged.last_mut() {
            Some(last) if range.start < last.end() => {
                last.len = last.len.max(range.end() - last.start);
            }
            _ => merged.push(range),
        }
    }
    merged
}

/// Returns the type of each slot. Slots that a copy connects have one type; a slot of two types is a word.
fn types(accesses: &[Access], equal: &mut SlotClasses, constants: u32) -> Vec<CType> {
    let count = equal.parents.len();
    let mut found: Vec<Option<CType>> = vec![None; count];
    for access in accesses.iter().filter(|a| a.slots.start >= constants) {
        for slot in access.slots.start..access.slots.end() {
            let class = equal.find(slot) as usize;
            let Some(ty) = access.ty else { continue };
            found[class] = match found[class] {
                Some(other) if other != ty => Some(CType::Word),
                _ => Some(ty),
            };
        }
    }
    let ty = |slot: usize| found[equal.find(slot as u32) as usize].unwrap_or(CType::Real);
    (0..count).map(ty).collect()
}

/// Classes of slots of one type (union-find with path halving).
struct SlotClasses {
    parents: Vec<u32>,
}

impl SlotClasses {
    fn new(count: u32) -> SlotClasses {
        SlotClasses {
            parents: (0..count).collect(),
        }
    }

    fn find(&mut self, slot: u32) -> u32 {
        let mut at = slot as usize;
        while self.parents[at] as usize != at {
            self.parents[at] = self.parents[self.parents[at] as usize];
            at = self.parents[at] as usize;
        }
        at as u32
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        self.parents[b as usize] = a;
    }
}
