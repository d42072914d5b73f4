//! Clocks of a callee's ports as its caller sees them: relative to the clock of the call, and to the caller's names for
//! what decides.

use super::clock::{Clock, Decider, Tick};
use super::row::Row;
use super::solve::Solver;
use crate::typed::{Activation, BlockId, Call, ExprId, FlowId, Unit, UnitKind};

impl<'u> Solver<'u> {
    /// A call: the clock by which it runs, and those of its results.
    pub(super) fn call(&mut self, id: ExprId, call: &'u Call) -> Row<Clock> {
        let units = self.units;
        let callee = &units[call.unit.0 as usize];
        let mut base = self.base(call, callee);
        if base == Clock::ANY && self.runs_always(callee) {
            base = Clock::BASE;
        }
        self.calls.insert(id, base);
        self.move_exposed(id, call, base);
        let is_kept = !self.unit.is_lustre && matches!(call.activation, Activation::Condact { .. });
        if is_kept || may_be_inactive(callee) {
            return Row::All(base);
        }
        let mut leaves = Vec::new();
        for output in &callee.outputs {
            for k in 0..callee.flow(*output).ty.leaf_count() {
                let path = self.port_path(call, callee, *output, k);
                leaves.push(self.through(id, call, &path, base));
            }
        }
        Row::of(leaves.into_iter(), base)
    }

    /// The clock at which the arguments meet, and what decides about the call.
    fn base(&mut self, call: &Call, callee: &Unit) -> Clock {
        let mut clocks = Vec::new();
        for (formal, arg) in callee.inputs.iter().zip(&call.args) {
            let Some(arg) = arg else { continue };
            let depth = self.port_path(call, callee, *formal, 0).len();
            let outer =
                |clock: Clock| (0..depth).fold(clock, |at, _| self.parent(at).unwrap_or(at));
            clocks.extend(self.exprs[arg.0 as usize].iter().map(outer));
        }
        call.activation
            .operands(&mut |id| clocks.push(self.whole(id)));
        let mut known = clocks.into_iter().filter(|clock| *clock != Clock::ANY);
        let base = match self.unit.is_lustre {
            true => known.next(),
            false => known.reduce(|a, b| self.meet(a, b)),
        };
        base.unwrap_or(Clock::ANY)
    }

    /// What decides inside of the call has a clock of the caller, too.
    fn move_exposed(&mut self, id: ExprId, call: &Call, base: Clock) {
        let clocks = &self.facts[call.unit.0 as usize].clocks;
        for (number, (_, clock)) in (0..).zip(clocks.exposed()) {
            let clock = self.through(id, call, clocks.path(*clock), base);
            self.move_inside(id, number, clock);
        }
    }

    /// A clock of the callee for the caller.
    pub(super) fn through(&mut self, id: ExprId, call: &Call, path: &[Tick], base: Clock) -> Clock {
        let Some(tick) = path.last() else {
            return base;
        };
        match self.decider_inside(id, call, tick.by) {
            Some(by) => self.ticks.clock(Tick { by, ..*tick }),
            None => Clock::ANY,
        }
    }

    /// What decides inside of a call, as the caller knows it: the flow that is given for it, if that has a name.
    fn decider_inside(&mut self, id: ExprId, call: &Call, by: Decider) -> Option<Decider> {
        let callee = &self.units[call.unit.0 as usize];
        if let Decider::Flow(flow) = by
            && let Some(port) = callee.inputs.iter().position(|input| *input == flow)
            && let Some(given) = call.args[port].and_then(|arg| self.decider(arg, 0))
        {
            return Some(given);
        }
        let exposed = self.facts[call.unit.0 as usize].clocks.exposed();
        let number = exposed.iter().position(|(known, _)| *known == by)?;
        Some(Decider::Inside(id, u32::try_from(number).ok()?))
    }

    /// What a leaf of a callee's port is sampled by, in the callee's terms.
    pub(super) fn port_path(
        &self,
        call: &Call,
        callee: &Unit,
        port: FlowId,
        k: usize,
    ) -> Vec<Tick> {
        let clocks = &self.facts[call.unit.0 as usize].clocks;
        if clocks.any() {
            return clocks.path(clocks.flow(port).leaf(k)).to_vec();
        }
        let mut path = Vec::new();
        let mut at = port;
        // A flow that decides about itself has been reported in the callee.
        let declared = |at: FlowId| callee.flow(at).clock;
        while let Some(on) = declared(at).filter(|_| path.len() < callee.flows.len()) {
            let by = Decider::Flow(on.flow);
            path.push(Tick {
                by,
                value: on.value,
            });
            at = on.flow;
        }
        path.reverse();
        path
    }

    /// What decides about the clocks of the out-ports.
    pub(super) fn exposed(&self) -> Vec<(Decider, Clock)> {
        let mut exposed: Vec<(Decider, Clock)> = Vec::new();
        let rows = self
            .unit
            .outputs
            .iter()
            .map(|id| &self.flows[id.0 as usize]);
        for clock in rows.flat_map(Row::iter) {
            let chain = self.chain(clock).unwrap_or_default();
            for tick in chain.iter().filter_map(|clock| self.ticks.tick(*clock)) {
                if exposed.iter().all(|(known, _)| *known != tick.by) {
                    let clock = self.ticks.clock_of(tick).and_then(|at| self.parent(at));
                    exposed.push((tick.by, clock.unwrap_or(Clock::BASE)));
                }
            }
        }
        exposed
    }
}

/// Whether a called fragment may be inactive in a cycle of its caller: then its results are optional flows of the caller.
pub(crate) fn may_be_inactive(callee: &Unit) -> bool {
    callee.kind == UnitKind::Fragment && callee.block(BlockId::ROOT).when.is_some()
}
