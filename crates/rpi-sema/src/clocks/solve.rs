//! Greatest solution of the clock equations. Every clock starts as [`Clock::ANY`] and descends to what the operands
//! allow. A clock only ever becomes faster, so the result does not depend on the order of evaluation.

use crate::clocks::clock::{Clock, Decider, Tick, Ticks};
use crate::clocks::{Borders, ClockId, Clocks, Row};
use crate::facts::{Definition, Facts, Reads};
use crate::hash::Map;
use crate::typed::{Each, Kind};
use crate::typed::{Equation, ExprId, FlowId, FlowRole, Optional, Place, Unit};
use rpi_diag::Finding;
use rpi_image::State;

/// State of the clock inference for one unit.
pub(in crate::clocks) struct Solver<'u> {
    pub(in crate::clocks) units: &'u [Unit],
    pub(in crate::clocks) facts: &'u [Facts],
    pub(in crate::clocks) unit: &'u Unit,
    pub(in crate::clocks) borders: Borders<'u>,
    pub(in crate::clocks) reads: Reads<'u>,
    pub(in crate::clocks) ticks: Ticks,
    pub(in crate::clocks) exprs: Vec<Row<Clock>>,
    pub(in crate::clocks) flows: Vec<Row<Clock>>,
    /// For each flow, whether its clock is inferred from its equation. False for ports and for flows with a declared
    /// clock or presence.
    pub(in crate::clocks) inferred: Vec<bool>,
    /// For each call, the clock on which it runs.
    pub(in crate::clocks) calls: Map<ExprId, Clock>,
    /// Clock of each exposed decider inside a call.
    pub(in crate::clocks) inside: Map<(ExprId, u32), Clock>,
    /// Canonical decider of each deciding flow, cached.
    pub(in crate::clocks) named: Map<FlowId, Decider>,
    /// For each flow, the definitions that define leaves of it.
    pub(in crate::clocks) defined: Vec<Vec<u32>>,
    /// For each expression, whether it reads a flow of a block that may be inactive.
    pub(in crate::clocks) outside: Vec<bool>,
    /// Whether the last round has begun, in which every clock that is still [`Clock::ANY`] belongs to a constant.
    constants: bool,
    /// Whether the clock of a decider has changed. Meets of clocks sampled by it are then out of date.
    moved: bool,
    changed: Vec<FlowId>,
}

/// Infers the clocks of a unit and reports mismatches.
pub(in crate::clocks) fn solve(
    units: &[Unit],
    facts: &[Facts],
    unit: &Unit,
) -> (Clocks, Vec<Finding>) {
    let mut solver = Solver::new(units, facts, unit);
    solver.declared();
    solver.settle();
    solver.constants = true;
    solver.deciders();
    solver.settle();
    solver.place();
    let findings = crate::clocks::check::check(&mut solver);
    (solver.clocks(), findings)
}

impl<'u> Solver<'u> {
    fn new(units: &'u [Unit], facts: &'u [Facts], unit: &'u Unit) -> Self {
        let reads = Reads::new(unit);
        let mut defined = vec![Vec::new(); unit.flows.len()];
        for (k, definition) in (0u32..).zip(&reads.definitions) {
            if let Definition::Equation(_, equation) = definition {
                for target in &equation.targets {
                    if let Place::Flow { flow, .. } = target.place {
                        defined[flow.0 as usize].push(k);
                    }
                }
            }
        }
        let borders = Borders::new(unit);
        let outside = unit.exprs.iter().zip(&reads.blocks);
        let outside = outside.map(|(expr, reader)| match expr.kind {
            Kind::Flow(flow) => borders.is_outside(flow, *reader),
            _ => false,
        });
        Solver {
            units,
            facts,
            unit,
            outside: outside.collect(),
            borders,
            reads,
            ticks: Ticks::default(),
            exprs: vec![Row::All(Clock::ANY); unit.exprs.len()],
            flows: vec![Row::All(Clock::BASE); unit.flows.len()],
            inferred: vec![false; unit.flows.len()],
            calls: Map::default(),
            inside: Map::default(),
            named: Map::default(),
            defined,
            constants: false,
            moved: false,
            changed: Vec::new(),
        }
    }

    /// Sets the clocks of flows that are not inferred: of ports, of flows declared as always present, and of flows
    /// shared by several states with each state's contribution. All other flows get the clock of their equation.
    fn declared(&mut self) {
        for (k, flow) in self.unit.flows.iter().enumerate() {
            let is_declared = flow.optional == Optional::Declared(false);
            if flow.role == FlowRole::Param {
                self.flows[k] = Row::All(Clock::ANY);
            } else if flow.role.has_equation() && !is_declared && flow.clock.is_none() {
                self.flows[k] = Row::All(Clock::ANY);
                self.inferred[k] = true;
            }
        }
        let mut shared = Vec::new();
        for automaton in self.unit.blocks.iter().flat_map(|block| &block.automata) {
            shared.extend(&automaton.shared);
        }
        for (k, flow) in (0..).map(FlowId).zip(&self.unit.flows) {
            if let Some(on) = flow.clock {
                let by = self.name(on.flow);
                let value = on.value;
                self.flows[k.0 as usize] = Row::All(self.ticks.clock(Tick { by, value }));
            }
        }
        for shared in shared {
            let outer = shared.flow.0 as usize;
            if std::mem::replace(&mut self.inferred[outer], false) {
                self.flows[outer] = Row::All(Clock::BASE);
            } else if self.unit.flow(shared.flow).clock.is_some() {
                for inner in shared.contributions() {
                    self.flows[inner.0 as usize] = self.flows[outer].clone();
                }
            }
        }
    }

    /// A decider whose clock is still [`Clock::ANY`] is a constant: puts it on the base clock.
    fn deciders(&mut self) {
        for k in 0..self.ticks.len() {
            let clock = Clock::numbered(k);
            if let Some(Tick {
                by: Decider::Flow(flow),
                ..
            }) = self.ticks.tick(clock)
            {
                let row = &mut self.flows[flow.0 as usize];
                if row.leaf(0) == Clock::ANY {
                    *row = Row::All(Clock::BASE);
                }
            }
        }
    }

    /// Returns whether the last round has begun, in which every clock that is still [`Clock::ANY`] belongs to a
    /// constant.
    pub(in crate::clocks) fn is_last_look(&self) -> bool {
        self.constants
    }

    fn settle(&mut self) {
        loop {
            self.moved = false;
            for id in (0..).map(ExprId).take(self.unit.exprs.len()) {
                let row = self.expr(id);
                self.exprs[id.0 as usize] = row;
            }
            for k in 0..self.reads.definitions.len() {
                self.define(k);
            }
            while let Some(flow) = self.changed.pop() {
                let mut open: Vec<u32> = self.reads.of_flow(flow).to_vec();
                while let Some(id) = open.pop().map(ExprId) {
                    let row = self.expr(id);
                    if row == self.exprs[id.0 as usize] {
                        continue;
                    }
                    self.exprs[id.0 as usize] = row;
                    open.extend(self.reads.parents(id));
                    for k in self.reads.defined_by(id).to_vec() {
                        self.define(k as usize);
                    }
                }
            }
            // A moved decider changes meets of other expressions than its dependents, so another full round is needed.
            if !self.moved {
                return;
            }
        }
    }

    /// Updates the clocks of inferred flows from the value of their definition.
    fn define(&mut self, definition: usize) {
        let Definition::Equation(block, equation) = self.reads.definitions[definition] else {
            return;
        };
        let value = self.exprs[equation.value.0 as usize].clone();
        let mut first = 0;
        for target in &equation.targets {
            let count = target.ty.leaf_count();
            if let Place::Flow { flow, at } = target.place
                && self.inferred[flow.0 as usize]
            {
                let part = match self.borders.crossed(block, self.unit.flow(flow).block) {
                    true => Row::All(Clock::BASE),
                    false => value.part(first, count),
                };
                self.join_flow(flow, at as usize, &part, count);
            }
            first += count;
        }
    }

    fn join_flow(&mut self, flow: FlowId, at: usize, part: &Row<Clock>, count: usize) {
        let whole = self.unit.flow(flow).ty.leaf_count();
        let known = self.flows[flow.0 as usize].clone();
        let joined = match (&known, part) {
            (Row::All(known), Row::All(part)) if at == 0 && count == whole => {
                Row::All(self.meet(*known, *part))
            }
            _ => {
                let leaf = |k: usize| match k.checked_sub(at).filter(|k| *k < count) {
                    Some(inner) => self.meet(known.leaf(k), part.leaf(inner)),
                    None => known.leaf(k),
                };
                Row::of((0..whole).map(leaf), Clock::ANY)
            }
        };
        if joined != known {
            self.flows[flow.0 as usize] = joined;
            self.changed.push(flow);
            self.moved |= self.ticks.has(Decider::Flow(flow));
        }
    }

    fn count(&self, id: ExprId) -> usize {
        self.unit.expr(id).ty.leaf_count()
    }

    pub(in crate::clocks) fn leaf(&self, id: ExprId, k: usize) -> Clock {
        self.exprs[id.0 as usize].leaf(k)
    }

    /// Returns the common clock of all leaves of an expression.
    pub(in crate::clocks) fn whole(&self, id: ExprId) -> Clock {
        let leaves = self.exprs[id.0 as usize].iter();
        leaves.fold(Clock::ANY, |all, leaf| self.meet(all, leaf))
    }

    /// Computes the clocks of an expression from those of its operands.
    fn expr(&mut self, id: ExprId) -> Row<Clock> {
        let unit = self.unit;
        let count = self.count(id);
        let own = |id: ExprId| &self.exprs[id.0 as usize];
        let row = match &unit.expr(id).kind {
            Kind::Flow(_) if self.outside[id.0 as usize] => Row::All(Clock::BASE),
            Kind::Flow(flow) => self.flows[flow.0 as usize].clone(),
            Kind::Part { base, at } => own(*base).part(*at as usize, count),
            Kind::Slice { base, from, step } => self.slice(*base, (*from, *step), count),
            Kind::Select { base, index } => self.select(*base, *index, count),
            Kind::Build(parts) => self.build(parts),
            Kind::Repeat(element) => match own(*element) {
                Row::All(clock) => Row::All(*clock),
                Row::Each(leaves) => {
                    Row::of(leaves.iter().copied().cycle().take(count), Clock::ANY)
                }
            },
            Kind::Replace { base, at, value } => self.replaced(*base, *at as usize, *value, count),
            Kind::Each(each, operands) => self.each(*each, operands, count),
            // Presence of a flow may be tested on every clock.
            Kind::Present(_) => Row::All(Clock::ANY),
            Kind::When { clock, .. } => {
                let by = self.name(clock.flow);
                let value = clock.value;
                Row::All(self.ticks.clock(Tick { by, value }))
            }
            Kind::Merge { on, .. } => Row::All(self.leaf(*on, 0)),
            Kind::Current(operand) => own(*operand).map(|clock| match self.parent(clock) {
                Some(parent) => parent,
                None => clock,
            }),
            Kind::Call(call) => self.call(id, call),
            kind => {
                let mut operands = Vec::new();
                kind.operands(&mut |operand| operands.push(operand));
                Row::All(self.strict(&operands))
            }
        };
        match self.constants && !unit.is_lustre && self.starts(id) {
            true => row.map(|clock| match clock {
                Clock::ANY => Clock::BASE,
                clock => clock,
            }),
            false => row,
        }
    }

    /// Returns the common clock of the operands of a strict operator. In Lustre the first known clock is taken; the
    /// check compares the others with it.
    pub(in crate::clocks) fn strict(&self, operands: &[ExprId]) -> Clock {
        self.first_or_meet(operands.iter().map(|id| self.whole(*id)))
    }

    fn each(&self, each: Each, operands: &[ExprId], count: usize) -> Row<Clock> {
        let rows = operands.iter().map(|id| &self.exprs[id.0 as usize]);
        let are_alike = rows.clone().all(|row| row.one().is_some());
        let count = if are_alike { 1 } else { count };
        let leaf = |k: usize| {
            let clocks = operands.iter().enumerate().map(|(n, id)| match (each, n) {
                (Each::If, 0) => self.whole(*id),
                _ => self.leaf(*id, k),
            });
            match (each, clocks.clone().next_back()) {
                // The replacement of an absent value has the clock of the whole. A constant replacement leaves the
                // clock open.
                (Each::Coalesce | Each::Hold, Some(Clock::ANY)) => Clock::ANY,
                _ => self.first_or_meet(clocks),
            }
        };
        Row::of((0..count).map(leaf), Clock::ANY)
    }

    fn first_or_meet(&self, mut clocks: impl Iterator<Item = Clock>) -> Clock {
        let met = match self.unit.is_lustre {
            true => clocks.find(|clock| *clock != Clock::ANY),
            false => clocks.reduce(|a, b| self.meet(a, b)),
        };
        met.unwrap_or(Clock::ANY)
    }

    fn build(&self, parts: &[ExprId]) -> Row<Clock> {
        let rows = || parts.iter().map(|part| &self.exprs[part.0 as usize]);
        let mut all = rows().map(Row::one);
        let first = all.next().flatten().unwrap_or(Clock::ANY);
        if all.all(|clock| clock == Some(first)) && rows().next().is_none_or(|r| r.one().is_some())
        {
            return Row::All(first);
        }
        let leaves = parts
            .iter()
            .flat_map(|part| (0..self.count(*part)).map(|k| self.leaf(*part, k)));
        Row::of(leaves, Clock::ANY)
    }

    fn replaced(&self, base: ExprId, at: usize, value: ExprId, count: usize) -> Row<Clock> {
        let [whole, part] = [base, value].map(|id| &self.exprs[id.0 as usize]);
        if whole == part && whole.one().is_some() {
            return whole.clone();
        }
        let of_part = self.count(value);
        let leaf = |k: usize| match k.checked_sub(at).filter(|k| *k < of_part) {
            Some(inner) => part.leaf(inner),
            None => whole.leaf(k),
        };
        Row::of((0..count).map(leaf), Clock::ANY)
    }

    fn slice(&self, base: ExprId, (from, step): (u32, i32), count: usize) -> Row<Clock> {
        let row = &self.exprs[base.0 as usize];
        if row.one().is_some() {
            return row.clone();
        }
        let size = element_size(self.unit, base);
        let leaf = |k: usize| {
            let element = i64::from(from) + (k / size) as i64 * i64::from(step);
            row.leaf(usize::try_from(element).unwrap_or(0) * size + k % size)
        };
        Row::of((0..count).map(leaf), Clock::ANY)
    }

    /// Computes the clocks of an element at a computed index: the meet over all elements and the index, leaf by leaf.
    fn select(&self, base: ExprId, index: ExprId, count: usize) -> Row<Clock> {
        let (row, index) = (&self.exprs[base.0 as usize], self.whole(index));
        if let Some(one) = row.one() {
            return Row::All(self.first_or_meet([one, index].into_iter()));
        }
        let (size, total) = (element_size(self.unit, base), self.count(base));
        let leaf = |k: usize| {
            let all = (k..total).step_by(size).map(|k| row.leaf(k));
            self.first_or_meet(all.chain([index]))
        };
        Row::of((0..count).map(leaf), Clock::ANY)
    }

    /// Returns whether an expression has state with a first cycle of its own. If only constants start it, it runs in
    /// all cycles.
    fn starts(&self, id: ExprId) -> bool {
        match &self.unit.expr(id).kind {
            Kind::Each(Each::Pre | Each::Last, operands) => !self.is_constant(operands[0]),
            Kind::Each(Each::Arrow, operands) => !operands.iter().all(|id| self.is_constant(*id)),
            Kind::Each(Each::Hold, _) | Kind::Current(_) => true,
            Kind::Prim(call) => {
                let desc = call.prim.desc();
                !matches!(desc.state, State::None) || desc.role == rpi_image::Role::First
            }
            Kind::Call(call) => self.units[call.unit.0 as usize].has_state,
            _ => false,
        }
    }

    /// Returns whether an expression is a literal, constant, `none` or parameter. Other constant expressions are not
    /// recognised.
    fn is_constant(&self, id: ExprId) -> bool {
        match &self.unit.expr(id).kind {
            Kind::Const(_) | Kind::Literal(_) | Kind::None => true,
            Kind::Flow(flow) => self.unit.flow(*flow).role == FlowRole::Param,
            _ => false,
        }
    }

    /// Returns the clock from which a clock is sampled: the clock of its decider. None for the base clock and for
    /// [`Clock::ANY`].
    pub(in crate::clocks) fn parent(&self, clock: Clock) -> Option<Clock> {
        match self.ticks.tick(clock)?.by {
            Decider::Flow(flow) => Some(self.flows[flow.0 as usize].leaf(0)),
            Decider::Inside(call, number) => {
                Some(*self.inside.get(&(call, number)).unwrap_or(&Clock::ANY))
            }
        }
    }

    /// Returns a clock and its ancestors, the clock itself (the slowest) first. None if the clock is sampled from
    /// itself.
    pub(in crate::clocks) fn chain(&self, clock: Clock) -> Option<Vec<Clock>> {
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

    /// Returns the slowest clock from which both clocks are sampled, as far as is known in this round.
    pub(in crate::clocks) fn meet(&self, a: Clock, b: Clock) -> Clock {
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

    /// Records the clock of an exposed decider inside a call.
    pub(in crate::clocks) fn move_inside(&mut self, call: ExprId, number: u32, clock: Clock) {
        let known = self.inside.insert((call, number), clock);
        self.moved |= known.is_some_and(|known| known != clock);
    }

    /// Returns the equation of a definition; none for a flow shared by states.
    pub(in crate::clocks) fn equation(&self, definition: u32) -> Option<&'u Equation> {
        match self.reads.definitions[definition as usize] {
            Definition::Equation(_, equation) => Some(equation),
            Definition::Shared(_) => None,
        }
    }

    /// Converts the result to [`Clocks`], with each clock as a path of samplings.
    fn clocks(self) -> Clocks {
        let mut paths: Vec<Vec<Tick>> = vec![Vec::new()];
        let mut numbers: Map<Clock, ClockId> = Map::default();
        numbers.insert(Clock::BASE, ClockId::BASE);
        // A clock that is still open belongs to a constant, which has a value in every cycle.
        numbers.insert(Clock::ANY, ClockId::BASE);
        for k in 0..self.ticks.len() {
            let clock = Clock::numbered(k);
            let mut chain = self.chain(clock).unwrap_or_default();
            chain.reverse();
            let ticks = chain.into_iter().filter_map(|clock| self.ticks.tick(clock));
            paths.push(ticks.collect());
            let number = u32::try_from(paths.len() - 1).unwrap_or(u32::MAX);
            numbers.insert(clock, ClockId(number));
        }
        let number = |clock: Clock| numbers[&clock];
        let exposed = self.exposed();
        let calls = self.calls.into_iter();
        Clocks {
            paths,
            exprs: self.exprs.iter().map(|row| row.map(number)).collect(),
            flows: self.flows.iter().map(|row| row.map(number)).collect(),
            calls: calls.map(|(id, at)| (id, number(at))).collect(),
            exposed: exposed
                .into_iter()
                .map(|(by, clock)| (by, number(clock)))
                .collect(),
            outside: self.outside,
        }
    }
}

/// Number of leaves of an element of an array.
fn element_size(unit: &Unit, array: ExprId) -> usize {
    match &unit.expr(array).ty {
        crate::ty::Ty::Array(element, _) => element.leaf_count().max(1),
        _ => 1,
    }
}
