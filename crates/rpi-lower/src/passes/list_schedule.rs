//! Groups calls of the same primitive into rows, so that one dispatch serves many calls.
//!
//! Within a scope, any order that respects dependencies is valid. The pass picks a kind among the ready items and runs
//! items of that kind until none is ready, including those that become ready meanwhile. Then it picks the next kind.
//! This is list scheduling (Graham 1966) with the change of kind as the cost. The next kind is the one with the longest
//! remaining chain of changes. On irregular nets, mispredicted dispatches dominate the time of an interpreter, so the
//! number of changes is the only criterion.
//! Scopes with the same guard are also a kind: neighbours are merged into one scope.

use crate::flat_net::{FlatNet, Item, OpKind, ScopeId};
use crate::registers::Register;
use rpi_image::image::Form;
use rpi_prims::{CycleTime, PrimId};
use rustc_hash::FxHashMap;
use std::cmp::Reverse;
use std::collections::VecDeque;

pub(super) fn arrange(flat: &mut FlatNet, _: CycleTime) {
    let mut writer = vec![NONE; flat.registers.len()];
    // Scopes that were merged into an earlier one are already empty when they are visited.
    let mut waiting = vec![ScopeId::ROOT];
    while let Some(scope) = waiting.pop() {
        let order = Graph::new(flat, scope, &mut writer).order();
        let items = std::mem::take(&mut flat.scopes[scope.index()].items);
        let mut arranged: Vec<Item> = Vec::with_capacity(items.len());
        for at in order {
            append_item(flat, &mut arranged, items[at as usize]);
        }
        waiting.extend(arranged.iter().filter_map(|item| match item {
            Item::Scope(inner) => Some(*inner),
            Item::Op(_) => None,
        }));
        flat.scopes[scope.index()].items = arranged;
    }
}

const NONE: u32 = u32::MAX;

/// Appends an item to the reordered items of a scope. If the item and the last one are scopes with the same guard, the
/// contents of the new scope are appended to the last one instead.
fn append_item(flat: &mut FlatNet, arranged: &mut Vec<Item>, item: Item) {
    if let (Some(Item::Scope(last)), Item::Scope(next)) = (arranged.last().copied(), item) {
        let kinds = [last, next].map(|s| ItemKind::of_scope(flat, s));
        if kinds[0].is_some() && kinds[0] == kinds[1] {
            let mut items = std::mem::take(&mut flat.scopes[next.index()].items);
            for moved in &items {
                if let Item::Scope(inner) = moved {
                    flat.scopes[inner.index()].parent = Some(last);
                }
            }
            flat.scopes[last.index()].items.append(&mut items);
            return;
        }
    }
    arranged.push(item);
}

/// Kind of an item of a scope. Adjacent items of the same kind can be executed by one step, or merged into one scope.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
enum ItemKind {
    Run(PrimId, Form),
    Copy,
    Guarded(Register),
    /// An item that is never combined with others, such as a device access.
    Alone,
}

impl ItemKind {
    fn of_item(flat: &FlatNet, item: Item) -> ItemKind {
        match item {
            Item::Scope(inner) => ItemKind::of_scope(flat, inner).unwrap_or(ItemKind::Alone),
            Item::Op(op) => match flat.ops[op as usize].kind {
                OpKind::Run(prim, form) => ItemKind::Run(prim, form),
                OpKind::Copy => ItemKind::Copy,
                OpKind::Actuate(..) | OpKind::Call(..) => ItemKind::Alone,
            },
        }
    }

    /// Returns the kind of a scope; `None` if it has a reset or copies for the next cycle, and so cannot be merged with
    /// other scopes.
    fn of_scope(flat: &FlatNet, scope: ScopeId) -> Option<ItemKind> {
        let scope = &flat.scopes[scope.index()];
        let plain = scope.reset.is_none() && scope.latches.is_empty();
        plain.then_some(ItemKind::Guarded(scope.guard))
    }
}

/// Dependency graph of the items of a scope: operations and nested scopes, by position in the scope.
struct Graph {
    /// For each item, the number of its kind. Items of the same kind, such as calls of the same primitive, are placed
    /// in a row.
    kinds: Vec<u32>,
    kind_count: usize,
    /// For each item, how many of the items that it depends on are not yet in the new order.
    pending: Vec<u32>,
    /// For each item, the index in `dependents` of the first item that depends on it. A final entry has the length of
    /// `dependents` (compressed sparse rows).
    start: Vec<u32>,
    dependents: Vec<u32>,
}

impl Graph {
    fn new(flat: &FlatNet, scope: ScopeId, writer: &mut [u32]) -> Self {
        let items = &flat.scopes[scope.index()].items;
        let mut edges = Vec::with_capacity(3 * items.len());
        let mut device = NONE;
        for (at, item) in (0..).zip(items) {
            visit_registers(flat, *item, false, &mut |slot, written| match written {
                true => writer[slot.index()] = at,
                false if writer[slot.index()] != NONE && writer[slot.index()] != at => {
                    edges.push((writer[slot.index()], at));
                }
                false => {}
            });
            if reaches_device(flat, *item) {
                if device != NONE {
                    edges.push((device, at));
                }
                device = at;
            }
        }
        for item in items {
            visit_registers(flat, *item, false, &mut |slot, _| {
                writer[slot.index()] = NONE
            });
        }
        let (kinds, kind_count) = kinds(flat, items);
        let (start, readers, waits) = adjacency_lists(items.len(), &edges);
        Graph {
            kinds,
            kind_count,
            pending: waits,
            start,
            dependents: readers,
        }
    }

    /// Returns the items in an order that respects all dependencies and places items of the same kind in a row where
    /// possible.
    fn order(mut self) -> Vec<u32> {
        let mut ready = ReadyQueues::new(self.kind_count, self.heights());
        for at in (0..).take(self.kinds.len()) {
            if self.pending[at as usize] == 0 {
                ready.push(self.kinds[at as usize], at);
            }
        }
        let mut order = Vec::with_capacity(self.kinds.len());
        while let Some(kind) = ready.next_kind() {
            while let Some(at) = ready.pop(kind) {
                order.push(at);
                for k in self.start[at as usize]..self.start[at as usize + 1] {
                    let reader = self.dependents[k as usize];
                    self.pending[reader as usize] -= 1;
                    if self.pending[reader as usize] == 0 {
                        ready.push(self.kinds[reader as usize], reader);
                    }
                }
            }
        }
        order
    }

    /// Returns, for each item, the greatest number of changes of kind on any chain of dependent items that starts at
    /// it.
    fn heights(&self) -> Vec<u32> {
        let mut heights = vec![0; self.kinds.len()];
        // Items are in an evaluation order, so dependents come later.
        for at in (0..self.kinds.len()).rev() {
            let readers = &self.dependents[self.start[at] as usize..self.start[at + 1] as usize];
            let above = readers.iter().map(|&r| {
                let changes = self.kinds[r as usize] != self.kinds[at];
                heights[r as usize] + u32::from(changes)
            });
            heights[at] = above.max().unwrap_or(0);
        }
        heights
    }
}

/// Items that depend on no item outside the new order, in one queue per kind.
struct ReadyQueues {
    queues: Vec<VecDeque<u32>>,
    /// For each queue, the greatest height of its items. The height is the number of changes of kind that must follow
    /// an item.
    tops: Vec<u32>,
    heights: Vec<u32>,
}

impl ReadyQueues {
    fn new(kinds: usize, heights: Vec<u32>) -> Self {
        ReadyQueues {
            queues: vec![VecDeque::new(); kinds],
            tops: vec![0; kinds],
            heights,
        }
    }

    fn push(&mut self, kind: u32, item: u32) {
        let top = &mut self.tops[kind as usize];
        *top = self.heights[item as usize].max(*top);
        self.queues[kind as usize].push_back(item);
    }

    fn pop(&mut self, kind: usize) -> Option<u32> {
        let item = self.queues[kind].pop_front();
        if item.is_none() {
            self.tops[kind] = 0;
        }
        item
    }

    /// Returns the kind whose items have the longest remaining chain of changes of kind; `None` if no item is ready.
    /// Ties are broken by the number of ready items, then by the lower number of the kind.
    fn next_kind(&self) -> Option<usize> {
        let some = (0..self.queues.len()).filter(|k| !self.queues[*k].is_empty());
        some.max_by_key(|&k| (self.tops[k], self.queues[k].len(), Reverse(k)))
    }
}

/// Returns the number of each item's kind, counted in order of first appearance, and the number of kinds.
fn kinds(flat: &FlatNet, items: &[Item]) -> (Vec<u32>, usize) {
    let mut known = FxHashMap::default();
    let mut count = 0;
    let kinds = items.iter().map(|item| {
        let kind = ItemKind::of_item(flat, *item);
        let number = match kind {
            ItemKind::Alone => count,
            _ => *known.entry(kind).or_insert(count),
        };
        count = count.max(number + 1);
        number
    });
    (kinds.collect(), count as usize)
}

/// Builds the adjacency lists of the items from the edges (item, dependent item): start of each item's list, all lists
/// in a row, and number of incoming edges of each item.
///
/// Counting sort keeps the order of the edges. Duplicate edges are counted on both sides, so they do no harm.
fn adjacency_lists(items: usize, edges: &[(u32, u32)]) -> (Vec<u32>, Vec<u32>, Vec<u32>) {
    let (mut start, mut waits) = (vec![0; items + 1], vec![0; items]);
    for (from, to) in edges {
        start[*from as usize + 1] += 1;
        waits[*to as usize] += 1;
    }
    for k in 0..items {
        start[k + 1] += start[k];
    }
    let mut next = start.clone();
    let mut readers = vec![0; edges.len()];
    for (from, to) in edges {
        let at = &mut next[*from as usize];
        readers[*at as usize] = *to;
        *at += 1;
    }
    (start, readers, waits)
}

/// Calls `with` for every register that an item reads (`false`) or writes (`true`), in the order of execution.
///
/// A reset also writes the state of the delays in its scope, so that readers outside must come after it. `afresh` says
/// whether a scope around the item has a reset.
fn visit_registers(
    flat: &FlatNet,
    item: Item,
    afresh: bool,
    with: &mut impl FnMut(Register, bool),
) {
    match item {
        Item::Op(op) => {
            let op = flat.ops[op as usize];
            flat.reads(op).for_each(|s| with(s, false));
            flat.writes(op).for_each(|s| with(s, true));
        }
        Item::Scope(inner) => {
            let scope = &flat.scopes[inner.index()];
            with(scope.guard, false);
            scope.reset.iter().for_each(|r| with(r.0, false));
            let afresh = afresh || scope.reset.is_some();
            let kept = scope.latches.iter().filter(|_| afresh);
            kept.for_each(|latch| with(latch.1, true));
            for item in &scope.items {
                visit_registers(flat, *item, afresh, with);
            }
        }
    }
}

/// Returns true if an item sets a set-point or calls a device function, also in a nested scope. Such items keep the
/// order of the net.
fn reaches_device(flat: &FlatNet, item: Item) -> bool {
    match item {
        Item::Op(op) => matches!(
            flat.ops[op as usize].kind,
            OpKind::Actuate(..) | OpKind::Call(..)
        ),
        Item::Scope(inner) => {
            let items = &flat.scopes[inner.index()].items;
            items.iter().any(|item| reaches_device(flat, *item))
        }
    }
}
