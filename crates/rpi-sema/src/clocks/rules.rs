//! Clock of an expression, from those of its operands.

use super::canonical_decider;
use crate::clocks::Row;
use crate::clocks::clock::{Clock, Tick};
use crate::clocks::solve::Solver;
use crate::typed::{Each, Kind};
use crate::typed::{ExprId, FlowRole, Unit};
use rpi_image::State;

impl Solver<'_> {
    /// Computes the clocks of an expression from those of its operands.
    pub(super) fn expr(&mut self, id: ExprId) -> Row<Clock> {
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
                let by = canonical_decider::decider_of(self, clock.flow);
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
    pub(super) fn strict(&self, operands: &[ExprId]) -> Clock {
        self.first_or_meet(operands.iter().map(|id| self.whole(*id)))
    }

    pub(super) fn each(&self, each: Each, operands: &[ExprId], count: usize) -> Row<Clock> {
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

    pub(super) fn first_or_meet(&self, mut clocks: impl Iterator<Item = Clock>) -> Clock {
        let met = match self.unit.is_lustre {
            true => clocks.find(|clock| *clock != Clock::ANY),
            false => clocks.reduce(|a, b| self.meet(a, b)),
        };
        met.unwrap_or(Clock::ANY)
    }

    pub(super) fn build(&self, parts: &[ExprId]) -> Row<Clock> {
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

    pub(super) fn replaced(
        &self,
        base: ExprId,
        at: usize,
        value: ExprId,
        count: usize,
    ) -> Row<Clock> {
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

    pub(super) fn slice(&self, base: ExprId, (from, step): (u32, i32), count: usize) -> Row<Clock> {
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
    pub(super) fn select(&self, base: ExprId, index: ExprId, count: usize) -> Row<Clock> {
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
    pub(super) fn starts(&self, id: ExprId) -> bool {
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
    pub(super) fn is_constant(&self, id: ExprId) -> bool {
        match &self.unit.expr(id).kind {
            Kind::Const(_) | Kind::Literal(_) | Kind::None => true,
            Kind::Flow(flow) => self.unit.flow(*flow).role == FlowRole::Param,
            _ => false,
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
