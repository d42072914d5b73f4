//! Traversal of a flat net in execution order.

use crate::flat::{Flat, Item, ScopeId};
use crate::slots::Slot;

/// An event of a traversal.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Stop {
    /// Start of a scope.
    Enter(ScopeId),
    /// An operation, with its scope.
    Op(u32, ScopeId),
    /// End of a scope.
    Leave(ScopeId),
}

/// All events of a traversal in order. Scopes nest as deep as fragments, so the stack is on the heap.
pub(super) fn walk(flat: &Flat) -> Vec<Stop> {
    let mut stops = Vec::with_capacity(flat.ops.len() + 2 * flat.scopes.len());
    visit(flat, |stop| stops.push(stop));
    stops
}

fn visit(flat: &Flat, mut with: impl FnMut(Stop)) {
    let mut open = vec![(ScopeId::ROOT, 0)];
    with(Stop::Enter(ScopeId::ROOT));
    while let Some((scope, at)) = open.last_mut() {
        let scope = *scope;
        let item = flat.scopes[scope.index()].items.get(*at).copied();
        *at += 1;
        match item {
            Some(Item::Op(op)) => with(Stop::Op(op, scope)),
            Some(Item::Scope(inner)) => {
                with(Stop::Enter(inner));
                open.push((inner, 0));
            }
            None => {
                with(Stop::Leave(scope));
                open.pop();
            }
        }
    }
}

/// All operations in execution order, each with its scope.
pub(crate) fn ops(flat: &Flat) -> Vec<(u32, ScopeId)> {
    let mut ops = Vec::with_capacity(flat.ops.len());
    visit(flat, |stop| match stop {
        Stop::Op(op, scope) => ops.push((op, scope)),
        Stop::Enter(_) | Stop::Leave(_) => {}
    });
    ops
}

/// All operations in execution order, with the writer of each register.
pub(super) struct Writers {
    /// All operations in execution order, each with its scope.
    pub(super) order: Vec<(u32, ScopeId)>,
    /// For each register, the index of its writer in `order`.
    place: Vec<u32>,
}

impl Writers {
    pub(super) fn new(flat: &Flat) -> Self {
        let mut writers = Writers {
            order: ops(flat),
            place: vec![u32::MAX; flat.slots.len()],
        };
        for (place, (number, _)) in (0..).zip(&writers.order) {
            for slot in flat.writes(flat.ops[*number as usize]) {
                writers.place[slot.index()] = place;
            }
        }
        writers
    }

    /// The writer of a register: its position, its operation and its scope.
    pub(super) fn of(&self, slot: Slot) -> Option<(u32, u32, ScopeId)> {
        let place = self.place[slot.index()];
        let (number, scope) = self.order.get(place as usize)?;
        Some((place, *number, *scope))
    }
}

/// True if `inner` is `outer` or nested inside it.
pub(super) fn encloses(flat: &Flat, outer: ScopeId, inner: ScopeId) -> bool {
    let parent = |s: &ScopeId| flat.scopes[s.index()].parent;
    std::iter::successors(Some(inner), parent).any(|s| s == outer)
}
