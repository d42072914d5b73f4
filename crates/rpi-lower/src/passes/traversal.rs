//! Traversal of a flat net in execution order.

use crate::flat_net::{FlatNet, Item, ScopeId};
use crate::registers::Register;

/// Event of a traversal of nested scopes in execution order: start of a scope, operation, or end of a scope.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum TraversalEvent {
    /// Start of a scope, before its items.
    Enter(ScopeId),
    /// An operation, as its index in [`FlatNet::ops`](crate::flat_net::FlatNet::ops), and the scope that contains it.
    Op(u32, ScopeId),
    /// End of a scope, after its items.
    Leave(ScopeId),
}

/// Returns all events of a traversal of the net, in execution order.
pub(super) fn traverse(flat: &FlatNet) -> Vec<TraversalEvent> {
    let mut stops = Vec::with_capacity(flat.ops.len() + 2 * flat.scopes.len());
    visit(flat, |stop| stops.push(stop));
    stops
}

fn visit(flat: &FlatNet, mut with: impl FnMut(TraversalEvent)) {
    let mut open = vec![(ScopeId::ROOT, 0)];
    with(TraversalEvent::Enter(ScopeId::ROOT));
    while let Some((scope, at)) = open.last_mut() {
        let scope = *scope;
        let item = flat.scopes[scope.index()].items.get(*at).copied();
        *at += 1;
        match item {
            Some(Item::Op(op)) => with(TraversalEvent::Op(op, scope)),
            Some(Item::Scope(inner)) => {
                with(TraversalEvent::Enter(inner));
                open.push((inner, 0));
            }
            None => {
                with(TraversalEvent::Leave(scope));
                open.pop();
            }
        }
    }
}

/// Returns all operations in execution order, each as its index in the net and the scope that contains it.
pub(crate) fn ops_in_order(flat: &FlatNet) -> Vec<(u32, ScopeId)> {
    let mut ops = Vec::with_capacity(flat.ops.len());
    visit(flat, |stop| match stop {
        TraversalEvent::Op(op, scope) => ops.push((op, scope)),
        TraversalEvent::Enter(_) | TraversalEvent::Leave(_) => {}
    });
    ops
}

/// All operations in execution order, and for each register the operation that writes it.
pub(super) struct Writers {
    /// All operations in execution order, each as its index in the net and the scope that contains it.
    pub(super) order: Vec<(u32, ScopeId)>,
    /// For each register, the index in `order` of the operation that writes it; `u32::MAX` if no operation does.
    writer_index: Vec<u32>,
}

impl Writers {
    pub(super) fn new(flat: &FlatNet) -> Self {
        let mut writers = Writers {
            order: ops_in_order(flat),
            writer_index: vec![u32::MAX; flat.registers.len()],
        };
        for (place, (number, _)) in (0..).zip(&writers.order) {
            for slot in flat.writes(flat.ops[*number as usize]) {
                writers.writer_index[slot.index()] = place;
            }
        }
        writers
    }

    /// Returns the operation that writes a register: its position in `order`, its index in the net and its scope.
    /// `None` if no operation writes the register.
    pub(super) fn writer_of(&self, slot: Register) -> Option<(u32, u32, ScopeId)> {
        let place = self.writer_index[slot.index()];
        let (number, scope) = self.order.get(place as usize)?;
        Some((place, *number, *scope))
    }
}

/// Returns true if the scope `inner` is the scope `outer` or nested inside it.
pub(super) fn encloses(flat: &FlatNet, outer: ScopeId, inner: ScopeId) -> bool {
    let parent = |s: &ScopeId| flat.scopes[s.index()].parent;
    std::iter::successors(Some(inner), parent).any(|s| s == outer)
}
