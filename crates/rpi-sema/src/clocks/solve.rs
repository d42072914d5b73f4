//! Greatest solution of the clock equations. Every clock starts as [`Clock::ANY`] and descends to what the operands
//! allow. A clock only ever becomes faster, so the result does not depend on the order of evaluation.

use super::canonical_condition;
use super::constants;
use crate::clocks::clock::{Clock, ClockCondition, Sampling, Samplings};
use crate::clocks::{ClockId, Clocks, InactiveBlocks, LeafClocks};
use crate::facts::{Definition, Dependents, Facts};
use crate::hash::FastMap;
use crate::typed::TypedKind;
use crate::typed::{Equation, ExprId, FlowId, FlowPresence, FlowRole, TargetPlace, Unit};
use rpi_diag::Diagnostic;
use std::rc::Rc;

/// State of the inference of clocks for one unit, with what the inference reads.
pub(super) struct Solver<'u> {
    pub(super) units: &'u [Rc<Unit>],
    pub(super) facts: &'u [Rc<Facts>],
    pub(super) unit: &'u Unit,
    pub(super) borders: InactiveBlocks<'u>,
    pub(super) reads: Dependents<'u>,
    pub(super) ticks: Samplings,
    pub(super) exprs: Vec<LeafClocks<Clock>>,
    pub(super) flows: Vec<LeafClocks<Clock>>,
    /// For each flow, whether its clock is inferred from its equation. It is not inferred for ports and for flows with
    /// a declared clock or declared as always present.
    pub(super) inferred: Vec<bool>,
    /// For each call expression, the clock on which the call runs.
    pub(super) calls: FastMap<ExprId, Clock>,
    /// Clock of each clock condition inside of a call, by the call expression and the index of the condition among
    /// those of the called unit's outputs.
    pub(super) exposed_clocks: FastMap<(ExprId, u32), Clock>,
    /// For each flow that has been examined as a clock condition, the clock condition of which it is a copy; the flow
    /// itself if it is no copy.
    pub(super) canonical: FastMap<FlowId, ClockCondition>,
    /// For each flow, the equations that define it or parts of it, as indices in `reads.definitions`.
    pub(super) definitions_of: Vec<Vec<u32>>,
    /// For each expression, whether it reads a flow of a block that may be inactive, from outside of the block.
    pub(super) reads_inactive: Vec<bool>,
    /// Whether the last round of inference has begun. From then on, only constants still have the clock [`Clock::ANY`].
    pub(super) is_last_round: bool,
    /// Whether the clock of a clock condition has changed in this round. Common clocks computed from it are then out of
    /// date.
    condition_changed: bool,
    changed: Vec<FlowId>,
}

/// Infers the clocks of a unit and checks them. Returns the clocks and the diagnostics about mismatches. `facts` are
/// the results of the analysis of all units, by index.
pub(super) fn solve(
    units: &[Rc<Unit>],
    facts: &[Rc<Facts>],
    unit: &Unit,
) -> (Clocks, Vec<Diagnostic>) {
    let mut solver = Solver::new(units, facts, unit);
    solver.init_declared();
    solver.resolve_equation();
    solver.is_last_round = true;
    solver.fix_constant_conditions();
    solver.resolve_equation();
    constants::settle_constants(&mut solver);
    let diagnostics = crate::clocks::check::check(&mut solver);
    (solver.clocks(), diagnostics)
}

impl<'u> Solver<'u> {
    fn new(units: &'u [Rc<Unit>], facts: &'u [Rc<Facts>], unit: &'u Unit) -> Self {
        let reads = Dependents::new(unit);
        let mut defined = vec![Vec::new(); unit.flows.len()];
        for (k, definition) in (0u32..).zip(&reads.definitions) {
            if let Definition::Equation(_, equation) = definition {
                for target in &equation.targets {
                    if let TargetPlace::Flow { flow, .. } = target.place {
                        defined[flow.0 as usize].push(k);
                    }
                }
            }
        }
        let borders = InactiveBlocks::new(unit);
        let outside = unit.exprs.iter().zip(&reads.blocks);
        let outside = outside.map(|(expr, reader)| match expr.kind {
            TypedKind::Flow(flow) => borders.is_outside(flow, *reader),
            _ => false,
        });
        Solver {
            units,
            facts,
            unit,
            reads_inactive: outside.collect(),
            borders,
            reads,
            ticks: Samplings::default(),
            exprs: vec![LeafClocks::Uniform(Clock::ANY); unit.exprs.len()],
            flows: vec![LeafClocks::Uniform(Clock::BASE); unit.flows.len()],
            inferred: vec![false; unit.flows.len()],
            calls: FastMap::default(),
            exposed_clocks: FastMap::default(),
            canonical: FastMap::default(),
            definitions_of: defined,
            is_last_round: false,
            condition_changed: false,
            changed: Vec::new(),
        }
    }

    /// Sets the clocks of flows that are not inferred: ports, flows with a declared clock, and flows that the states of
    /// an automaton define, with their versions in the states. All other flows get the clock of their equation later.
    fn init_declared(&mut self) {
        for (k, flow) in self.unit.flows.iter().enumerate() {
            let is_declared = flow.optional == FlowPresence::Declared(false);
            if flow.role == FlowRole::Param {
                self.flows[k] = LeafClocks::Uniform(Clock::ANY);
            } else if flow.role.has_equation() && !is_declared && flow.clock.is_none() {
                self.flows[k] = LeafClocks::Uniform(Clock::ANY);
                self.inferred[k] = true;
            }
        }
        let mut shared = Vec::new();
        for automaton in self.unit.blocks.iter().flat_map(|block| &block.automata) {
            shared.extend(&automaton.shared);
        }
        for (k, flow) in (0..).map(FlowId).zip(&self.unit.flows) {
            if let Some(on) = flow.clock {
                let by = canonical_condition::condition_of(self, on.flow);
                let value = on.value;
                self.flows[k.0 as usize] = LeafClocks::Uniform(self.ticks.intern(Sampling {
                    condition: by,
                    value,
                }));
            }
        }
        for shared in shared {
            let outer = shared.flow.0 as usize;
            if std::mem::replace(&mut self.inferred[outer], false) {
                self.flows[outer] = LeafClocks::Uniform(Clock::BASE);
            } else if self.unit.flow(shared.flow).clock.is_some() {
                for inner in shared.contributions() {
                    self.flows[inner.0 as usize] = self.flows[outer].clone();
                }
            }
        }
    }

    /// Gives each clock condition that still has the clock [`Clock::ANY`] the base clock, because it is a constant.
    fn fix_constant_conditions(&mut self) {
        for k in 0..self.ticks.len() {
            let clock = Clock::from_sampling(k);
            if let Some(Sampling {
                condition: ClockCondition::Flow(flow),
                ..
            }) = self.ticks.sampling(clock)
            {
                let row = &mut self.flows[flow.0 as usize];
                if row.leaf(0) == Clock::ANY {
                    *row = LeafClocks::Uniform(Clock::BASE);
                }
            }
        }
    }

    /// Whether the last round of inference has begun. From then on, only constants still have the clock [`Clock::ANY`].
    pub(super) fn is_last_round(&self) -> bool {
        self.is_last_round
    }

    fn resolve_equation(&mut self) {
        loop {
            self.condition_changed = false;
            for id in (0..).map(ExprId).take(self.unit.exprs.len()) {
                let row = self.expr(id);
                self.exprs[id.0 as usize] = row;
            }
            for k in 0..self.reads.definitions.len() {
                self.update_definition(k);
            }
            while let Some(flow) = self.changed.pop() {
                self.update_readers(flow);
            }
            // A moved clock condition changes meets of other expressions than its dependents, so another full round is needed.
            if !self.condition_changed {
                return;
            }
        }
    }

    /// Computes the clocks of all expressions that read a flow, directly or as an operand, again, and those of the
    /// flows that these expressions define.
    fn update_readers(&mut self, flow: FlowId) {
        let mut open: Vec<u32> = self.reads.flow_readers(flow).to_vec();
        while let Some(id) = open.pop().map(ExprId) {
            let row = self.expr(id);
            if row == self.exprs[id.0 as usize] {
                continue;
            }
            self.exprs[id.0 as usize] = row;
            open.extend(self.reads.parents(id));
            for k in self.reads.definitions_of_expr(id).to_vec() {
                self.update_definition(k as usize);
            }
        }
    }

    /// Updates the clocks of the inferred flows that an equation defines from the clock of its value. `definition` is
    /// the index of the equation.
    fn update_definition(&mut self, definition: usize) {
        let Definition::Equation(block, equation) = self.reads.definitions[definition] else {
            return;
        };
        let value = self.exprs[equation.value.0 as usize].clone();
        let mut first = 0;
        for target in &equation.targets {
            let count = target.ty.leaf_count();
            if let TargetPlace::Flow { flow, at } = target.place
                && self.inferred[flow.0 as usize]
            {
                let part = match self
                    .borders
                    .crosses_inactive(block, self.unit.flow(flow).block)
                {
                    true => LeafClocks::Uniform(Clock::BASE),
                    false => value.part(first, count),
                };
                self.join_flow(flow, at as usize, &part, count);
            }
            first += count;
        }
    }

    fn join_flow(&mut self, flow: FlowId, at: usize, part: &LeafClocks<Clock>, count: usize) {
        let whole = self.unit.flow(flow).ty.leaf_count();
        let known = self.flows[flow.0 as usize].clone();
        let joined = match (&known, part) {
            (LeafClocks::Uniform(known), LeafClocks::Uniform(part))
                if at == 0 && count == whole =>
            {
                LeafClocks::Uniform(self.meet(*known, *part))
            }
            _ => {
                let leaf = |k: usize| match k.checked_sub(at).filter(|k| *k < count) {
                    Some(inner) => self.meet(known.leaf(k), part.leaf(inner)),
                    None => known.leaf(k),
                };
                LeafClocks::from_leaves((0..whole).map(leaf), Clock::ANY)
            }
        };
        if joined != known {
            self.flows[flow.0 as usize] = joined;
            self.changed.push(flow);
            self.condition_changed |= self.ticks.is_clock_condition(ClockCondition::Flow(flow));
        }
    }

    pub(super) fn count(&self, id: ExprId) -> usize {
        self.unit.expr(id).ty.leaf_count()
    }

    pub(super) fn leaf(&self, id: ExprId, k: usize) -> Clock {
        self.exprs[id.0 as usize].leaf(k)
    }

    /// Returns the common clock of all leaves (scalar parts) of an expression: the slowest clock from which all their
    /// clocks are sampled.
    pub(super) fn common_clock(&self, id: ExprId) -> Clock {
        let leaves = self.exprs[id.0 as usize].iter();
        leaves.fold(Clock::ANY, |all, leaf| self.meet(all, leaf))
    }

    /// Returns the clock from which a clock is sampled, which is the clock of its condition. `None` for the base clock
    /// and for [`Clock::ANY`].
    pub(super) fn parent(&self, clock: Clock) -> Option<Clock> {
        match self.ticks.sampling(clock)?.condition {
            ClockCondition::Flow(flow) => Some(self.flows[flow.0 as usize].leaf(0)),
            ClockCondition::CallInternal(call, number) => Some(
                *self
                    .exposed_clocks
                    .get(&(call, number))
                    .unwrap_or(&Clock::ANY),
            ),
        }
    }

    /// Returns a clock and the clocks from which it is sampled, from the clock itself to the fastest one. `None` if the
    /// clock is sampled from itself.
    pub(super) fn chain(&self, clock: Clock) -> Option<Vec<Clock>> {
        let mut chain = vec![clock];
        let mut at = clock;
        while let Some(parent) = self.parent(at) {
            if chain.len() > self.ticks.len() {
                return None;
            }
            chain.push(parent);
            at = parent;
        }
        Some(chain)
    }

    /// Returns the slowest clock from which both clocks are sampled, as far as it is known in this round.
    pub(super) fn meet(&self, a: Clock, b: Clock) -> Clock {
        if a == b || b == Clock::ANY {
            return a;
        }
        if a == Clock::ANY {
            return b;
        }
        if a == Clock::BASE || b == Clock::BASE {
            return Clock::BASE;
        }
        let (Some(one), Some(other)) = (self.chain(a), self.chain(b)) else {
            return Clock::BASE;
        };
        let is_known = |chain: &[Clock]| chain.last() == Some(&Clock::BASE);
        let mut common = one.iter().filter(|clock| **clock != Clock::ANY);
        match common.find(|clock| other.contains(clock)) {
            Some(common) => *common,
            // The chain that does not reach the base clock yet may later lead to the other clock.
            None if is_known(&one) => a,
            None if is_known(&other) => b,
            None => Clock::ANY,
        }
    }

    /// Records the clock of the clock condition with index `number` inside of a call.
    pub(super) fn set_exposed_clock(&mut self, call: ExprId, number: u32, clock: Clock) {
        let known = self.exposed_clocks.insert((call, number), clock);
        self.condition_changed |= known.is_some_and(|known| known != clock);
    }

    /// Returns the equation with this index among the definitions; `None` if the states of an automaton define the
    /// flow.
    pub(super) fn equation(&self, definition: u32) -> Option<&'u Equation> {
        match self.reads.definitions[definition as usize] {
            Definition::Equation(_, equation) => Some(equation),
            Definition::Shared(_) => None,
        }
    }

    /// Converts the result of the inference to [`Clocks`], in which each clock is a list of samplings from the base
    /// clock on.
    fn clocks(self) -> Clocks {
        let mut paths: Vec<Vec<Sampling>> = vec![Vec::new()];
        let mut numbers: FastMap<Clock, ClockId> = FastMap::default();
        numbers.insert(Clock::BASE, ClockId::BASE);
        // A clock that is still open belongs to a constant, which has a value in every cycle.
        numbers.insert(Clock::ANY, ClockId::BASE);
        for k in 0..self.ticks.len() {
            let clock = Clock::from_sampling(k);
            let mut chain = self.chain(clock).unwrap_or_default();
            chain.reverse();
            let ticks = chain
                .into_iter()
                .filter_map(|clock| self.ticks.sampling(clock));
            paths.push(ticks.collect());
            let number = u32::try_from(paths.len() - 1).unwrap_or(u32::MAX);
            numbers.insert(clock, ClockId(number));
        }
        let number = |clock: Clock| numbers[&clock];
        let exposed = self.exposed();
        let calls = self.calls.into_iter();
        Clocks {
            paths,
            exprs: self
                .exprs
                .iter()
                .map(|row| row.map_arrays(number))
                .collect(),
            flows: self
                .flows
                .iter()
                .map(|row| row.map_arrays(number))
                .collect(),
            calls: calls.map(|(id, at)| (id, number(at))).collect(),
            exposed: exposed
                .into_iter()
                .map(|(by, clock)| (by, number(clock)))
                .collect(),
            reads_inactive: self.reads_inactive,
        }
    }
}
