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

/// State of the elaboration of one inlined instance of a unit.
pub(super) struct Scope<'u> {
    pub(super) unit: &'u Unit,
    /// Index of the unit; `None` for a constant expression, which is evaluated outside of any unit.
    pub(super) id: Option<UnitId>,
    /// Progress of elaborating each flow, with its signals.
    flows: IndexMap<FlowState>,
    /// Signals of each expression that has been elaborated, so that an expression that is used more than once is
    /// elaborated once.
    memo: IndexMap<Option<Wire>>,
    /// For each elaborated expression that can fault, the guard under which its signals are valid.
    guards: FastMap<ExprId, PortRef>,
    /// Fragment of the net for each block; `None` until the fragment is added.
    pub(super) fragments: Vec<Option<FragmentId>>,
    /// Leaves (scalar parts) that are read outside of their blocks before the fragments of these blocks have been
    /// added.
    pub(super) pending_gates: Vec<PendingGate>,
    /// Fragment in which operations on the base clock of the block being elaborated run.
    pub(super) base: FragmentId,
    /// Fragments for the operations that run when a clock ticks, by the fragment of the base clock and the clock.
    pub(super) clock_fragments: FastMap<(FragmentId, ClockId), FragmentId>,
    /// Placeholder ports for the clock conditions inside of calls, by the call and the index of the condition.
    pub(super) exposed_aliases: FastMap<(ExprId, u32), PortRef>,
    /// Sampled flows that are read outside of their blocks, with the placeholder ports by which they are read.
    pub(super) outside_reads: Vec<(FlowId, Wire)>,
    /// Path of the calls from the root of the net to this instance, with a dot after each name.
    pub(super) prefix: String,
    /// Location of the call that this instance is for; `None` for the root of the net.
    pub(super) call_span: Option<Span>,
}

/// Progress of the elaboration of one flow.
#[derive(Clone, Default, Debug)]
pub(super) enum FlowState {
    /// The elaboration of the flow has not begun.
    #[default]
    Unvisited,
    /// The flow is being evaluated. This state occurs only in the evaluation of constants.
    InProgress,
    /// The flow has these signals. Some may be placeholder ports whose signals are not known yet.
    Done(Wire),
}

impl<'u> Scope<'u> {
    /// Creates the state for elaborating a whole unit.
    pub(super) fn new(unit: &'u Unit, id: UnitId) -> Self {
        Scope {
            id: Some(id),
            flows: IndexMap::dense(unit.flows.len()),
            memo: IndexMap::dense(unit.exprs.len()),
            fragments: vec![None; unit.blocks.len()],
            ..Scope::constant(unit)
        }
    }

    /// Creates the state for evaluating constant expressions of a unit, of which few flows and expressions are needed.
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

    /// Returns the signals of an expression that has been elaborated; `None` if there are none that are valid under
    /// `guard`. A shared expression (a part of a pattern, a mode of a contract) may have been elaborated under another
    /// guard, and its signals are then valid only under that guard.
    pub(super) fn cached(&self, id: ExprId, guard: Option<PortRef>) -> Option<Wire> {
        let known = self.memo.get(id.0)?.as_ref()?;
        let counts = self.guards.get(&id).is_none_or(|made| Some(*made) == guard);
        counts.then(|| known.clone())
    }

    pub(super) fn check_known_at_load(&self, id: ExprId) -> bool {
        self.memo.get(id.0).is_some_and(Option::is_some)
    }

    /// Stores the signals of an elaborated expression. `guard` is the condition under which they are valid; `None` if
    /// they are valid in every cycle because the expression cannot fault.
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
