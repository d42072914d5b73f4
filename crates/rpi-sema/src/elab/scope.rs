//! Scope of one inlined unit: the wires of its flows, the fragments of its blocks, and the expressions elaborated so
//! far.

use crate::clocks::ClockId;
use crate::elab::fragment_outputs::PendingGate;
use crate::elab::index_map::IndexMap;
use crate::elab::signal::Wire;
use crate::hash::FastMap;
use crate::typed::{BlockId, ExprId, FlowId, Unit, UnitId};
use rpi_diag::Span;
use rpi_net::{FragmentId, PortRef};

/// State of the elaboration of one instance of a unit.
pub(super) struct Scope<'u> {
    pub(super) unit: &'u Unit,
    /// Index of the unit; none for a constant expression outside any unit.
    pub(super) id: Option<UnitId>,
    /// For each flow, whether it has been elaborated, is in progress, or is still to do.
    flows: IndexMap<FlowState>,
    /// Signals of the expressions elaborated so far. An expression that is used more than once is elaborated once.
    memo: IndexMap<Option<Wire>>,
    /// Guards of the elaborated expressions that can fault.
    guards: FastMap<ExprId, PortRef>,
    /// Fragment of each block, once it exists.
    pub(super) fragments: Vec<Option<FragmentId>>,
    /// Leaves that are read outside blocks whose fragments do not exist yet.
    pub(super) pending_gates: Vec<PendingGate>,
    /// Fragment in which the base clock of the block being elaborated runs.
    pub(super) base: FragmentId,
    /// Fragments of clocks, by base fragment and clock.
    pub(super) clock_fragments: FastMap<(FragmentId, ClockId), FragmentId>,
    /// Aliases for the clock conditions inside calls.
    pub(super) exposed_aliases: FastMap<(ExprId, u32), PortRef>,
    /// Sampled flows that are read outside their blocks, with their aliases.
    pub(super) outside_reads: Vec<(FlowId, Wire)>,
    /// Path of the calls that lead to the unit, with a trailing dot.
    pub(super) prefix: String,
    /// Span of the call that this instance belongs to.
    pub(super) call_span: Option<Span>,
}

/// Progress of elaborating a flow.
#[derive(Clone, Default, Debug)]
pub(super) enum FlowState {
    /// The flow has not been reached yet.
    #[default]
    Unvisited,
    /// The flow is being evaluated (in constants only).
    InProgress,
    /// The flow has these signals, possibly aliases.
    Done(Wire),
}

impl<'u> Scope<'u> {
    /// Creates the scope of a whole unit.
    pub(super) fn new(unit: &'u Unit, id: UnitId) -> Self {
        Scope {
            id: Some(id),
            flows: IndexMap::dense(unit.flows.len()),
            memo: IndexMap::dense(unit.exprs.len()),
            fragments: vec![None; unit.blocks.len()],
            ..Scope::constant(unit)
        }
    }

    /// Creates the scope of a constant in a unit.
    pub(super) fn constant(unit: &'u Unit) -> Self {
        Scope {
            unit,
            id: None,
            flows: IndexMap::sparse(),
            memo: IndexMap::sparse(),
            guards: FastMap::default(),
            fragments: Vec::new(),
            pending_gates: Vec::new(),
            base: FragmentId::ROOT,
            clock_fragments: FastMap::default(),
            exposed_aliases: FastMap::default(),
            outside_reads: Vec::new(),
            prefix: String::new(),
            call_span: None,
        }
    }

    /// Returns the signals of an expression that has been elaborated. A shared expression (a part of a pattern, a mode
    /// of a contract) may have been elaborated under another guard. Its signals are then valid only under that guard.
    pub(super) fn cached(&self, id: ExprId, guard: Option<PortRef>) -> Option<Wire> {
        let known = self.memo.get(id.0)?.as_ref()?;
        let counts = self.guards.get(&id).is_none_or(|made| Some(*made) == guard);
        counts.then(|| known.clone())
    }

    pub(super) fn check_known_at_load(&self, id: ExprId) -> bool {
        self.memo.get(id.0).is_some_and(Option::is_some)
    }

    /// Stores the signals of an elaborated expression. `guard` is the condition under which they are valid, `None` if
    /// the expression cannot fault.
    pub(super) fn cache(&mut self, id: ExprId, wire: &Wire, guard: Option<PortRef>) {
        *self.memo.get_mut(id.0) = Some(wire.clone());
        match guard {
            Some(guard) => drop(self.guards.insert(id, guard)),
            None => drop(self.guards.remove(&id)),
        }
    }

    pub(super) fn state(&mut self, flow: FlowId) -> &mut FlowState {
        self.flows.get_mut(flow.0)
    }

    pub(super) fn fragment(&self, block: BlockId) -> Option<FragmentId> {
        self.fragments.get(block.0 as usize).copied().flatten()
    }
}
