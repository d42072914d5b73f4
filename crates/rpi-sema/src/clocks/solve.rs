//! The greatest solution of the clock equations. Every clock begins as the one that fits all and goes down to what the
//! operands allow; it only ever becomes faster, so that the order in which they are looked at does not matter.

use super::clock::{Clock, Decider, Tick, Ticks};
use super::{Borders, ClockId, Clocks, Row};
use crate::facts::{Definition, Facts, Reads};
use crate::hash::Map;
use crate::typed::{Each, Equation, ExprId, FlowId, FlowRole, Kind, Optional, Place, Unit};
use rpi_diag::Finding;
use rpi_image::State;

/// A unit whose clocks are being worked out.
pub(super) struct Solver<'u> {
    pub(super) units: &'u [Unit],
    pub(super) facts: &'u [Facts],
    pub(super) unit: &'u Unit,
    pub(super) borders: Borders<'u>,
    pub(super) reads: Reads<'u>,
    pub(super) ticks: Ticks,
    pub(super) exprs: Vec<Row<Clock>>,
    pub(super) flows: Vec<Row<Clock>>,
    /// Flows that have the clock of their equation: all but ports and those whose declaration says when they are there.
    pub(super) inferred: Vec<bool>,
    /// Of each call the clock by which it runs.
    pub(super) calls: Map<ExprId, Clock>,
    /// The clocks of what decides inside of calls.
    pub(super) inside: Map<(ExprId, u32), Clock>,
    /// The name of a flow that decides, whatever it is called.
    pub(super) named: Map<FlowId, Decider>,
    /// For each flow the definitions that give it leaves.
    pub(super) defined: Vec<Vec<u32>>,
    /// Reads of flows of blocks that may be inactive meanwhile.
    pub(super) outside: Vec<bool>,
    /// Whether what still fits every clock is a constant: all else is known.
    constants: bool,
    /// Whether the clock of something that decides has changed, and with it where others meet.
    moved: bool,
    changed: Vec<FlowId>,
}

/// The clocks of a unit, and where they do not meet.
pub(super) fn solve(units: &[Unit], facts: &[Facts], unit: &Unit) -> (Clocks, Vec<Finding>) {
    let mut solver = Solver::new(units, facts, unit);
    solver.declared();
    solver.settle();
    solver.constants = true;
    solver.deciders();
    solver.settle();
    solver.place();
    let findings = super::check::check(&mut solver);
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

    /// Ports, and flows that are declared to be always present, have the clock of their declaration; so has what several
    /// states define, and each state's part of it where it has a clock. All others have that of their equation.
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

    /// What decides and fits every clock is a constant.
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

    /// Whether what still fits every clock is a constant.
    pub(super) fn is_last_look(&self) -> bool {
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
            if !self.moved {
                return;
            }
        }
    }

    /// Gives inferred flows the clocks of what defines them.
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

    pub(super) fn leaf(&self, id: ExprId, k: usize) -> Clock {
        self.exprs[id.0 as usize].leaf(k)
    }

    /// Where all leaves of a value meet.
    pub(super) fn whole(&self, id: ExprId) -> Clock {
        let leaves = self.exprs[id.0 as usize].iter();
        leaves.fold(Clock::ANY, |all, leaf| self.meet(all, leaf))
    }

    /// The clocks of an expression, from those of its operands.
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
            // Whether something is present can be asked by every clock.
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

    /// Where operands of a strict operator meet: in Lustre they have one clock, or the first is taken for right.
    pub(super) fn strict(&self, operands: &[ExprId]) -> Clock {
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
                // What replaces an absent value has the clock of the whole: with a constant it fits every clock.
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

    /// An element at a place that is computed meets all others, leaf by leaf.
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

    /// Whether an expression has a first cycle of its own: what only constants start runs in all cycles, as if it had a
    /// name.
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

    /// Whether an expression is the same in all cycles, as far as a glance tells.
    fn is_constant(&self, id: ExprId) -> bool {
        match &self.unit.expr(id).kind {
            Kind::Const(_) | Kind::Literal(_) | Kind::None => true,
            Kind::Flow(flow) => self.unit.flow(*flow).role == FlowRole::Param,
            _ => false,
        }
    }

    /// The clock that a clock is sampled from.
    pub(super) fn parent(&self, clock: Clock) -> Option<Clock> {
        match self.ticks.tick(clock)?.by {
            Decider::Flow(flow) => Some(self.flows[flow.0 as usize].leaf(0)),
            Decider::Inside(call, number) => {
                Some(*self.inside.get(&(call, number)).unwrap_or(&Clock::ANY))
            }
        }
    }

    /// A clock and those that it is sampled from, slowest first. None if it is sampled from itself.
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

    /// The slowest clock that both are sampled from, as far as is known.
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
            // The chain that is not known to its end may lead to the other.
            None if is_known(&one) => a,
            None if is_known(&other) => b,
            None => Clock::ANY,
        }
    }

    /// A clock was given to what decides inside of a call.
    pub(super) fn move_inside(&mut self, call: ExprId, number: u32, clock: Clock) {
        let known = self.inside.insert((call, number), clock);
        self.moved |= known.is_some_and(|known| known != clock);
    }

    /// The equation of a definition.
    pub(super) fn equation(&self, definition: u32) -> Option<&'u Equation> {
        match self.reads.definitions[definition as usize] {
            Definition::Equation(_, equation) => Some(equation),
            Definition::Shared(_) => None,
        }
    }

    /// All clocks as paths.
    fn clocks(self) -> Clocks {
        let mut paths: Vec<Vec<Tick>> = vec![Vec::new()];
        let mut numbers: Map<Clock, ClockId> = Map::default();
        numbers.insert(Clock::BASE, ClockId::BASE);
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

/// The leaves of an element of an array.
fn element_size(unit: &Unit, array: ExprId) -> usize {
    match &unit.expr(array).ty {
        crate::ty::Ty::Array(element, _) => element.leaf_count().max(1),
        _ => 1,
    }
}
