//! Clocks (M4.7): the cycles in which each leaf of a value is present, computed naively.
//!
//! The clock of a flow is that of its defining expression. The clock of an expression is the common prefix of the
//! clocks of its operands; a literal has no clock of its own and adopts that of its reader. The equations are evaluated
//! repeatedly, in any order, until nothing changes. The clock inference of the checker, which uses unification, is not
//! used: an error in either of the two shows up as a difference of values.

mod calls;
mod context;

use std::rc::Rc;

use rpi_sema::typed::{
    BlockId, DeclaredClock, ElementwiseOp, ExprId, FlowId, FlowRole, TypedKind, Unit,
};

pub(crate) use calls::call_of;

/// Clock condition: the flow whose value decides in which cycles a sampled expression has a value.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) enum ClockCondition {
    /// Flow of the unit (function, node, command) that contains the sampled expression.
    Flow(FlowId),
    /// Condition inside a called unit, for which the caller has no name. The fields are the call and the condition as
    /// the callee names it.
    InCall(ExprId, Box<ClockCondition>),
}

/// One sampling step of a clock. It selects the cycles in which the condition `by` has the given value: 0 or 1 for a
/// Boolean, or the index of an enum value.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) struct Sampling {
    pub(crate) by: ClockCondition,
    pub(crate) value: u32,
}

/// Clock: the sampling steps that select its cycles, beginning with all cycles of the block. An empty list is the base
/// clock. `None` is a clock that is not known so far, or that of a literal, which adapts to any clock.
pub(crate) type Clock = Option<Rc<[Sampling]>>;

/// Clocks of one unit (function, node, command): for each flow and each expression the clocks of its leaves (scalar
/// parts).
pub(crate) struct Clocks {
    pub(crate) flows: Vec<Vec<Clock>>,
    pub(crate) exprs: Vec<Vec<Clock>>,
    /// For each expression that is a call, the clock on which the call runs; `None` for other expressions.
    pub(crate) calls: Vec<Clock>,
    /// For each expression, the block (body, fragment or state of an automaton) that contains it.
    blocks: Vec<BlockId>,
}

/// State of the computation of the clocks of one unit (function, node, command).
struct ClockSolver<'p> {
    unit: &'p Unit,
    units: &'p [Unit],
    /// For each unit of the program, its clocks. They are computed for all units that `unit` calls.
    callees: &'p [Option<Rc<Clocks>>],
    clocks: Clocks,
    /// True as soon as the clocks of all flows that follow from declared clocks have been computed.
    is_settled: bool,
    /// True as soon as operators and calls that have a first cycle of their own, but get no clock from operands, have
    /// been assigned the base clock.
    has_starts: bool,
}

/// Returns the base clock, which ticks in all cycles.
pub(crate) fn base() -> Clock {
    Some(Rc::new([]))
}

/// Returns the clocks of all units (functions, nodes, commands) of a program, in the order of `units`.
pub(crate) fn clocks(units: &[Unit]) -> Vec<Rc<Clocks>> {
    let mut known = vec![None; units.len()];
    for k in 0..units.len() {
        compute_unit(units, k, &mut known);
    }
    known.into_iter().flatten().collect()
}

/// Computes the clocks of unit number `k` after those of the units that it calls, and stores them in `known`. Units
/// cannot be recursive.
fn compute_unit(units: &[Unit], k: usize, known: &mut Vec<Option<Rc<Clocks>>>) {
    if known[k].is_some() {
        return;
    }
    let unit = &units[k];
    for call in unit.exprs.iter().filter_map(|expr| call_of(&expr.kind)) {
        compute_unit(units, call.unit.0 as usize, known);
    }
    let found = ClockSolver::new(unit, units, known).find();
    known[k] = Some(Rc::new(found));
}

impl Clocks {
    /// Returns whether any expression has a clock other than the base clock, so that it has no value in some cycles.
    pub(crate) fn are_sampled(&self) -> bool {
        let mut leaves = self.exprs.iter().flatten().flatten();
        leaves.any(|clock| !clock.is_empty())
    }

    /// Returns the block (body, fragment or state of an automaton) that contains an expression.
    pub(crate) fn block(&self, id: ExprId) -> BlockId {
        self.blocks[id.0 as usize]
    }
}

impl<'p> ClockSolver<'p> {
    fn new(unit: &'p Unit, units: &'p [Unit], known: &'p [Option<Rc<Clocks>>]) -> ClockSolver<'p> {
        let of_flow = |flow: &rpi_sema::typed::Flow| vec![None; flow.ty.leaf_count()];
        let of_expr = |expr: &rpi_sema::typed::Expr| vec![None; expr.ty.leaf_count()];
        let found = Clocks {
            flows: unit.flows.iter().map(of_flow).collect(),
            exprs: unit.exprs.iter().map(of_expr).collect(),
            calls: vec![None; unit.exprs.len()],
            blocks: context::blocks(unit),
        };
        ClockSolver {
            unit,
            units,
            callees: known,
            clocks: found,
            is_settled: false,
            has_starts: false,
        }
    }

    fn find(mut self) -> Clocks {
        self.until_nothing_changes();
        self.is_settled = true;
        self.until_nothing_changes();
        while self.always_ticks() {
            self.until_nothing_changes();
        }
        // This step comes last, because a clock that is not yet known may still determine when a call or `hold` starts.
        self.has_starts = true;
        self.until_nothing_changes();
        self.adopt_reader_clocks();
        self.clocks
    }

    /// Assigns the base clock (all cycles) to flows whose clock is still unknown; if possible, only to flows that do
    /// not depend on another unknown clock. Returns false if the clocks of all flows are known.
    fn always_ticks(&mut self) -> bool {
        let flows = (0..).map(FlowId).take(self.unit.flows.len());
        let open: Vec<FlowId> = flows.filter(|id| self.is_open(*id)).collect();
        let settled = open.iter().filter(|id| !self.waits(**id));
        let settled: Vec<FlowId> = settled.copied().collect();
        let chosen = if settled.is_empty() { &open } else { &settled };
        for flow in chosen {
            for leaf in &mut self.clocks.flows[flow.0 as usize] {
                leaf.get_or_insert_with(|| Rc::new([]));
            }
        }
        !open.is_empty()
    }

    fn is_open(&self, id: FlowId) -> bool {
        self.clocks.flows[id.0 as usize].contains(&None)
    }

    /// Returns whether the clock of a flow depends on an unknown clock: its definition contains a sampling (`when`) by
    /// a flow that has no clock so far, directly or through other such flows.
    fn waits(&self, id: FlowId) -> bool {
        let (mut met, mut flows) = (vec![false; self.unit.flows.len()], vec![id]);
        while let Some(id) = flows.pop() {
            if std::mem::replace(&mut met[id.0 as usize], true) || !self.is_open(id) {
                continue;
            }
            if self.unit.flow(id).clock.is_some() {
                return true;
            }
            let leaves = 0..self.unit.flow(id).ty.leaf_count();
            let values = leaves.filter_map(|k| crate::flow::definition(self.unit, id, k));
            let mut open: Vec<ExprId> = values.map(|(_, value, _)| value).collect();
            while let Some(at) = open.pop() {
                match &self.unit.expr(at).kind {
                    TypedKind::Flow(flow) => flows.push(*flow),
                    TypedKind::When { clock, .. } if self.is_open(clock.flow) => return true,
                    other => other.operands(&mut |operand| open.push(operand)),
                }
            }
        }
        false
    }

    fn until_nothing_changes(&mut self) {
        loop {
            let before = self.clocks.flows.clone();
            for id in (0..).map(ExprId).take(self.unit.exprs.len()) {
                let leaves = 0..self.unit.expr(id).ty.leaf_count();
                self.clocks.exprs[id.0 as usize] = leaves.map(|k| self.leaf(id, k)).collect();
            }
            for flow in (0..).map(FlowId).take(self.unit.flows.len()) {
                for k in 0..self.unit.flow(flow).ty.leaf_count() {
                    let now = self.flow(flow, k);
                    let leaf = &mut self.clocks.flows[flow.0 as usize][k];
                    *leaf = common_prefix([leaf.clone(), now].into_iter());
                }
            }
            if self.clocks.flows == before {
                return;
            }
        }
    }

    /// Returns the clock of leaf (scalar part) number `k` of a flow, as far as it follows from the clocks known so far;
    /// `None` if it does not.
    fn flow(&self, id: FlowId, k: usize) -> Clock {
        let flow = self.unit.flow(id);
        if let Some(on) = flow.clock {
            return self.sampled_clock(on);
        }
        if flow.role == FlowRole::Param {
            return None;
        }
        match crate::flow::definition(self.unit, id, k) {
            Some((_, value, leaf)) => self.clocks.exprs[value.0 as usize][leaf].clone(),
            // A port or a flow shared by states is read in all cycles, present or not.
            None => base(),
        }
    }

    /// Returns the clock that ticks in the cycles in which the flow `on.flow` has the value `on.value`; `None` if the
    /// clock of that flow is unknown.
    fn sampled_clock(&self, on: DeclaredClock) -> Clock {
        let decides = self.clocks.flows[on.flow.0 as usize].first()?.clone()?;
        Some(sampled(&decides, self.clock_condition(on.flow), on.value))
    }

    /// Returns the clock condition of a sampling by `flow`. In RPI a flow that only copies another flow has the
    /// condition of the copied flow; in Lustre each name is a separate condition.
    fn clock_condition(&self, flow: FlowId) -> ClockCondition {
        let mut flow = flow;
        for _ in 0..self.unit.flows.len() {
            let value = crate::flow::definition(self.unit, flow, 0).map(|(_, value, _)| value);
            match value.map(|value| (value, &self.unit.expr(value).kind)) {
                Some((value, TypedKind::Flow(source)))
                    if !self.unit.is_lustre && self.is_visible_in_scope(*source, value) =>
                {
                    flow = *source;
                }
                _ => break,
            }
        }
        ClockCondition::Flow(flow)
    }

    /// Returns the clock of leaf (scalar part) number `k` of an expression, computed from the clocks of its operands;
    /// `None` if it does not follow from them.
    fn leaf(&mut self, id: ExprId, k: usize) -> Clock {
        let expr = self.unit.expr(id);
        match &expr.kind {
            TypedKind::Flow(flow) if !self.is_visible_in_scope(*flow, id) => base(),
            TypedKind::Flow(flow) => self.clocks.flows[flow.0 as usize][k].clone(),
            TypedKind::When { clock, .. } => self.sampled_clock(*clock),
            TypedKind::Current(operand) => {
                let clock = self.clocks.exprs[operand.0 as usize][k].clone()?;
                Some(clock[..clock.len().saturating_sub(1)].into())
            }
            TypedKind::Merge { on, .. } => self.clocks.exprs[on.0 as usize][0].clone(),
            // Like a call with state: its first cycle is that of the body.
            TypedKind::Each(ElementwiseOp::Hold, _) if self.has_starts && !self.unit.is_lustre => {
                base()
            }
            TypedKind::Present(_)
            | TypedKind::Each(ElementwiseOp::Coalesce | ElementwiseOp::Hold, _) => None,
            TypedKind::Call(call) => self.call(id, call, k),
            kind => {
                let mut clocks = Vec::new();
                self.reads(kind, &expr.ty, k, &mut |operand, leaf| {
                    clocks.push(self.clocks.exprs[operand.0 as usize][leaf].clone());
                });
                common_prefix(clocks.into_iter())
            }
        }
    }

    /// Returns whether an expression reads a flow on the clock of the flow, because it is within the fragment or state
    /// that defines the flow. Elsewhere the flow is an optional flow of the enclosing block (M4.2).
    fn is_visible_in_scope(&self, flow: FlowId, reader: ExprId) -> bool {
        let mut around = Some(self.clocks.blocks[reader.0 as usize]);
        while let Some(block) = around {
            if block == self.unit.flow(flow).block {
                return true;
            }
            around = self.unit.block(block).parent;
        }
        false
    }

    /// Calls `read` for each operand leaf (scalar part) from which leaf number `k` of an expression is computed, with
    /// the operand and the index of its leaf. `kind` and `ty` are those of the expression.
    fn reads(
        &self,
        kind: &TypedKind,
        ty: &rpi_sema::ty::Ty,
        k: usize,
        read: &mut impl FnMut(ExprId, usize),
    ) {
        let size = |id: ExprId| self.unit.expr(id).ty.leaf_count();
        match kind {
            TypedKind::Part { base, at } => read(*base, *at as usize + k),
            TypedKind::Repeat(element) => read(*element, k % size(*element).max(1)),
            TypedKind::Replace { base, at, value } => {
                match k.checked_sub(*at as usize).filter(|k| *k < size(*value)) {
                    Some(k) => read(*value, k),
                    None => read(*base, k),
                }
            }
            TypedKind::Build(parts) => {
                let mut first = 0;
                for part in parts {
                    if (first..first + size(*part)).contains(&k) {
                        read(*part, k - first);
                    }
                    first += size(*part);
                }
            }
            TypedKind::Each(_, operands) => {
                for operand in operands {
                    // The condition of an `if` has one leaf, whatever the number of leaves of its branches.
                    let leaf = if size(*operand) == ty.leaf_count() {
                        k
                    } else {
                        0
                    };
                    read(*operand, leaf);
                }
            }
            other => other.operands(&mut |operand| {
                (0..size(operand)).for_each(|leaf| read(operand, leaf));
            }),
        }
    }
}

/// Returns the clock with one more sampling step: the cycles of `clock` in which the condition `by` has the given
/// value.
fn sampled(clock: &[Sampling], by: ClockCondition, value: u32) -> Rc<[Sampling]> {
    let last = Sampling { by, value };
    clock.iter().cloned().chain([last]).collect()
}

/// Returns the longest common prefix of the sampling steps of all clocks: the slowest clock from which all of them are
/// sampled. Unknown clocks are ignored; `None` if all are unknown.
fn common_prefix(clocks: impl Iterator<Item = Clock>) -> Clock {
    clocks.flatten().map(Some).reduce(|a, b| {
        let (a, b) = (a?, b?);
        let both = a.iter().zip(b.iter()).take_while(|(a, b)| a == b);
        Some(both.map(|(sampling, _)| sampling.clone()).collect())
    })?
}
