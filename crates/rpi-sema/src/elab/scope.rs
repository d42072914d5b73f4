//! One inlined unit: its flows' wires, the fragments of its blocks, what has been elaborated of it.

use super::leaving::Leaving;
use super::signal::Wire;
use crate::typed::{BlockId, ExprId, FlowId, Unit, UnitId};
use rpi_net::FragmentId;

/// A unit being elaborated at one place.
pub(super) struct Scope<'u> {
    pub(super) unit: &'u Unit,
    /// Its index; none for a constant expression outside of the table.
    pub(super) id: Option<UnitId>,
    /// What is known of each flow.
    pub(super) flows: Vec<State>,
    /// Expressions that are used more than once are elaborated once.
    memo: Vec<Option<Wire>>,
    /// The fragment of each block, once it has been made.
    pub(super) fragments: Vec<Option<FragmentId>>,
    /// Leaves that are read outside of blocks of which the fragments have not been made yet.
    pub(super) leaving: Vec<Leaving>,
    /// The fragment to which its clocks are relative: that of the block being elaborated.
    pub(super) base: FragmentId,
    /// Path of the calls that lead here, with a dot at its end.
    pub(super) prefix: String,
}

/// How far a flow is.
#[derive(Clone, Debug)]
pub(super) enum State {
    /// Not met.
    Open,
    /// Being worked out (constants only).
    Busy,
    /// Known, or connected to aliases.
    Known(Wire),
}

impl<'u> Scope<'u> {
    pub(super) fn new(unit: &'u Unit, id: Option<UnitId>) -> Self {
        Scope {
            unit,
            id,
            flows: vec![State::Open; unit.flows.len()],
            memo: vec![None; unit.exprs.len()],
            fragments: vec![None; unit.blocks.len()],
            leaving: Vec::new(),
            base: FragmentId::ROOT,
            prefix: String::new(),
        }
    }

    pub(super) fn recall(&self, id: ExprId) -> Option<Wire> {
        self.memo[id.0 as usize].clone()
    }

    pub(super) fn is_known(&self, id: ExprId) -> bool {
        self.memo[id.0 as usize].is_some()
    }

    pub(super) fn remember(&mut self, id: ExprId, wire: &Wire) {
        self.memo[id.0 as usize] = Some(wire.clone());
    }

    pub(super) fn state(&mut self, flow: FlowId) -> &mut State {
        &mut self.flows[flow.0 as usize]
    }

    pub(super) fn fragment(&self, block: BlockId) -> Option<FragmentId> {
        self.fragments[block.0 as usize]
    }
}
