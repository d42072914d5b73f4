//! One inlined unit: its flows' wires, the fragments of its blocks, what has been elaborated of it.

use super::leaving::Leaving;
use super::signal::Wire;
use super::slots::Slots;
use crate::clocks::ClockId;
use crate::hash::Map;
use crate::typed::{BlockId, ExprId, FlowId, Unit, UnitId};
use rpi_diag::Span;
use rpi_net::{FragmentId, PortRef};

/// A unit being elaborated at one place.
pub(super) struct Scope<'u> {
    pub(super) unit: &'u Unit,
    /// Its index; none for a constant expression outside of the table.
    pub(super) id: Option<UnitId>,
    /// What is known of each flow.
    flows: Slots<State>,
    /// Expressions that are used more than once are elaborated once.
    memo: Slots<Option<Wire>>,
    /// The conditions under which those of them count that can fault.
    guards: Map<ExprId, PortRef>,
    /// The fragment of each block, once it has been made.
    pub(super) fragments: Vec<Option<FragmentId>>,
    /// Leaves that are read outside of blocks of which the fragments have not been made yet.
    pub(super) leaving: Vec<Leaving>,
    /// The fragment to which its clocks are relative: that of the block being elaborated.
    pub(super) base: FragmentId,
    /// The fragments of clocks, by the fragment that they are relative to.
    pub(super) clocks: Map<(FragmentId, ClockId), FragmentId>,
    /// What decides inside of calls.
    pub(super) inside: Map<(ExprId, u32), PortRef>,
    /// Flows with clocks that are read outside of their blocks.
    pub(super) outside: Vec<(FlowId, Wire)>,
    /// Path of the calls that lead here, with a dot at its end.
    pub(super) prefix: String,
    /// The call that it is made for.
    pub(super) called: Option<Span>,
}

/// How far a flow is.
#[derive(Clone, Default, Debug)]
pub(super) enum State {
    /// Not met.
    #[default]
    Open,
    /// Being worked out (constants only).
    Busy,
    /// Known, or connected to aliases.
    Known(Wire),
}

impl<'u> Scope<'u> {
    /// For all of a unit.
    pub(super) fn new(unit: &'u Unit, id: UnitId) -> Self {
        Scope {
            id: Some(id),
            flows: Slots::all(unit.flows.len()),
            memo: Slots::all(unit.exprs.len()),
            fragments: vec![None; unit.blocks.len()],
            ..Scope::constant(unit)
        }
    }

    /// For a constant in a unit.
    pub(super) fn constant(unit: &'u Unit) -> Self {
        Scope {
            unit,
            id: None,
            flows: Slots::few(),
            memo: Slots::few(),
            guards: Map::default(),
            fragments: Vec::new(),
            leaving: Vec::new(),
            base: FragmentId::ROOT,
            clocks: Map::default(),
            inside: Map::default(),
            outside: Vec::new(),
            prefix: String::new(),
            called: None,
        }
    }

    /// The wire of an expression that has been elaborated. One that is shared (a name for a part of a pattern, a mode of a
    /// contract) may have been needed elsewhere under another condition: then it counts there only.
    pub(super) fn recall(&self, id: ExprId, guard: Option<PortRef>) -> Option<Wire> {
        let known = self.memo.get(id.0)?.as_ref()?;
        let counts = self.guards.get(&id).is_none_or(|made| Some(*made) == guard);
        counts.then(|| known.clone())
    }

    pub(super) fn is_known(&self, id: ExprId) -> bool {
        self.memo.get(id.0).is_some_and(Option::is_some)
    }

    /// `guard` is the condition under which it counts, none if it cannot fault.
    pub(super) fn remember(&mut self, id: ExprId, wire: &Wire, guard: Option<PortRef>) {
        *self.memo.slot(id.0) = Some(wire.clone());
        match guard {
            Some(guard) => drop(self.guards.insert(id, guard)),
            None => drop(self.guards.remove(&id)),
        }
    }

    pub(super) fn state(&mut self, flow: FlowId) -> &mut State {
        self.flows.slot(flow.0)
    }

    pub(super) fn fragment(&self, block: BlockId) -> Option<FragmentId> {
        self.fragments.get(block.0 as usize).copied().flatten()
    }
}
