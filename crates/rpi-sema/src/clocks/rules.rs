//! Clock of an expression, from those of its operands.

use super::canonical_condition;
use crate::clocks::LeafClocks;
use crate::clocks::clock::{Clock, Sampling};
use crate::clocks::solve::Solver;
use crate::typed::{ElementwiseOp, TypedKind};
use crate::typed::{ExprId, FlowRole, Unit};
use rpi_image::StateSize;

impl Solver<'_> {
    /// Returns the clocks of the leaves (scalar parts) of an expression, computed from those of its operands.
    pub(super) fn expr(&mut self, id: ExprId) -> LeafClocks<Clock> {
        let unit = self.unit;
        let count = self.count(id);
        let own = |id: ExprId| &self.exprs[id.0 as usize];
        let row = match &unit.expr(id).kind {
            TypedKind::Flow(_) if self.reads_inactive[id.0 as usize] => {
                LeafClocks::Uniform(Clock::BASE)
            }
            TypedKind::Flow(flow) => self.flows[flow.0 as usize].clone(),
            TypedKind::Part { base, at } => own(*base).part(*at as usize, count),
            TypedKind::Slice { base, from, step } => self.slice(*base, (*from, *step), count),
            TypedKind::Select { base, index } => self.select(*base, *index, count),
            TypedKind::Build(parts) => self.build(parts),
            TypedKind::Repeat(element) => match own(*element) {
                LeafClocks::Uniform(clock) => LeafClocks::Uniform(*clock),
                LeafClocks::PerLeaf(leaves) => {
                    LeafClocks::from_leaves(leaves.iter().copied().cycle().take(count), Clock::ANY)
                }
            },
            TypedKind::Replace { base, at, value } => {
                self.replaced(*base, *at as usize, *value, count)
            }
            TypedKind::Each(each, operands) => self.each(*each, operands, count),
            // Presence of a flow may be tested on every clock.
            TypedKind::Present(_) => LeafClocks::Uniform(Clock::ANY),
            TypedKind::When { clock, .. } => {
                let by = canonical_condition::condition_of(self, clock.flow);
                let value = clock.value;
                LeafClocks::Uniform(self.ticks.intern(Sampling {
                    condition: by,
                    value,
                }))
            }
            TypedKind::Merge { on, .. } => LeafClocks::Uniform(self.leaf(*on, 0)),
            TypedKind::Current(operand) => {
                own(*operand).map_arrays(|clock| match self.parent(clock) {
                    Some(parent) => parent,
                    None => clock,
                })
            }
            TypedKind::Call(call) => self.call(id, call),
            kind => {
                let mut operands = Vec::new();
                kind.operands(&mut |operand| operands.push(operand));
                LeafClocks::Uniform(self.strict(&operands))
            }
        };
        match self.is_last_round && !unit.is_lustre && self.has_first_cycle(id) {
            true => row.map_arrays(|clock| match clock {
                Clock::ANY => Clock::BASE,
                clock => clock,
            }),
            false => row,
        }
    }

    /// Returns the common clock of the operands of a strict operator, which needs all of them. In Lustre, it is the
    /// first known clock, with which the check compares the others.
    pub(super) fn strict(&self, operands: &[ExprId]) -> Clock {
        self.first_or_meet(operands.iter().map(|id| self.common_clock(*id)))
    }

    pub(super) fn each(
        &self,
        each: ElementwiseOp,
        operands: &[ExprId],
        count: usize,
    ) -> LeafClocks<Clock> {
        let rows = operands.iter().map(|id| &self.exprs[id.0 as usize]);
        let are_alike = rows.clone().all(|row| row.uniform().is_some());
        let count = if are_alike { 1 } else { count };
        let leaf = |k: usize| {
            let clocks = operands.iter().enumerate().map(|(n, id)| match (each, n) {
                (ElementwiseOp::If, 0) => self.common_clock(*id),
                _ => self.leaf(*id, k),
            });
            match (each, clocks.clone().next_back()) {
                // The replacement of an absent value has the clock of the whole. A constant replacement leaves the
                // clock open.
                (ElementwiseOp::Coalesce | ElementwiseOp::Hold, Some(Clock::ANY)) => Clock::ANY,
                _ => self.first_or_meet(clocks),
            }
        };
        LeafClocks::from_leaves((0..count).map(leaf), Clock::ANY)
    }

    pub(super) fn first_or_meet(&self, mut clocks: impl Iterator<Item = Clock>) -> Clock {
        let met = match self.unit.is_lustre {
            true => clocks.find(|clock| *clock != Clock::ANY),
            false => clocks.reduce(|a, b| self.meet(a, b)),
        };
        met.unwrap_or(Clock::ANY)
    }

    pub(super) fn build(&self, parts: &[ExprId]) -> LeafClocks<Clock> {
        let rows = || parts.iter().map(|part| &self.exprs[part.0 as usize]);
        let mut all = rows().map(LeafClocks::uniform);
        let first = all.next().flatten().unwrap_or(Clock::ANY);
        if all.all(|clock| clock == Some(first))
            && rows().next().is_none_or(|r| r.uniform().is_some())
        {
            return LeafClocks::Uniform(first);
        }
        let leaves = parts
            .iter()
            .flat_map(|part| (0..self.count(*part)).map(|k| self.leaf(*part, k)));
        LeafClocks::from_leaves(leaves, Clock::ANY)
    }

    pub(super) fn replaced(
        &self,
        base: ExprId,
        at: usize,
        value: ExprId,
        count: usize,
    ) -> LeafClocks<Clock> {
        let [whole, part] = [base, value].map(|id| &self.exprs[id.0 as usize]);
        if whole == part && whole.uniform().is_some() {
            return whole.clone();
        }
        let of_part = self.count(value);
        let leaf = |k: usize| match k.checked_sub(at).filter(|k| *k < of_part) {
            Some(inner) => part.leaf(inner),
            None => whole.leaf(k),
        };
        LeafClocks::from_leaves((0..count).map(leaf), Clock::ANY)
    }

    pub(super) fn slice(
        &self,
        base: ExprId,
        (from, step): (u32, i32),
        count: usize,
    ) -> LeafClocks<Clock> {
        let row = &self.exprs[base.0 as usize];
        if row.uniform().is_some() {
            return row.clone();
        }
        let size = element_size(self.unit, base);
        let leaf = |k: usize| {
            let element = i64::from(from) + (k / size) as i64 * i64::from(step);
            row.leaf(usize::try_from(element).unwrap_or(0) * size + k % size)
        };
        LeafClocks::from_leaves((0..count).map(leaf), Clock::ANY)
    }

    /// Returns the clocks of an array element at an index that is computed at run time. Each leaf has the common clock
    /// of that leaf in all elements and of the index. `count` is the number of leaves of the element.
    pub(super) fn select(&self, base: ExprId, index: ExprId, count: usize) -> LeafClocks<Clock> {
        let (row, index) = (&self.exprs[base.0 as usize], self.common_clock(index));
        if let Some(one) = row.uniform() {
            return LeafClocks::Uniform(self.first_or_meet([one, index].into_iter()));
        }
        let (size, total) = (element_size(self.unit, base), self.count(base));
        let leaf = |k: usize| {
            let all = (k..total).step_by(size).map(|k| row.leaf(k));
            self.first_or_meet(all.chain([index]))
        };
        LeafClocks::from_leaves((0..count).map(leaf), Clock::ANY)
    }

    /// Whether an expression has state with a first cycle of its own, such as `a -> b`. Such an expression runs in all
    /// cycles if its operands do not determine its clock. Delays and initialisations of literals do not count.
    pub(super) fn has_first_cycle(&self, id: ExprId) -> bool {
        match &self.unit.expr(id).kind {
            TypedKind::Each(ElementwiseOp::Pre | ElementwiseOp::Last, operands) => {
                !self.is_constant(operands[0])
            }
            TypedKind::Each(ElementwiseOp::Arrow, operands) => {
                !operands.iter().all(|id| self.is_constant(*id))
            }
            TypedKind::Each(ElementwiseOp::Hold, _) | TypedKind::Current(_) => true,
            TypedKind::Prim(call) => {
                let desc = call.prim.desc();
                !matches!(desc.state, StateSize::None) || desc.role == rpi_image::Role::First
            }
            TypedKind::Call(call) => self.units[call.unit.0 as usize].has_state,
            _ => false,
        }
    }

    /// Whether an expression is a literal, a constant, `none` or a parameter. Other constant expressions are not
    /// recognised.
    pub(super) fn is_constant(&self, id: ExprId) -> bool {
        match &self.unit.expr(id).kind {
            TypedKind::Const(_) | TypedKind::Literal(_) | TypedKind::None => true,
            TypedKind::Flow(flow) => self.unit.flow(*flow).role == FlowRole::Param,
            _ => false,
        }
    }
}

/// Returns the number of leaves (scalar parts) of an element of the array `array`.
fn element_size(unit: &Unit, array: ExprId) -> usize {
    match &unit.expr(array).ty {
        crate::ty::Ty::Array(element, _) => element.leaf_count().max(1),
        _ => 1,
    }
}
