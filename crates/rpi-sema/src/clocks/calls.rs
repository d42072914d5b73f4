//! Clocks of a callee's ports, translated into the caller's terms: relative to the clock of the call, with the caller's
//! names for the deciding flows.

use super::canonical_condition;
use crate::clocks::clock::{Clock, ClockCondition, Sampling};
use crate::clocks::leaf_clocks::LeafClocks;
use crate::clocks::solve::Solver;
use crate::typed::{Activation, Call};
use crate::typed::{BlockId, ExprId, FlowId, Unit, UnitKind};

impl<'u> Solver<'u> {
    /// Returns the clocks of a call's results, leaf by leaf (scalar part), and records the clock on which the call
    /// itself runs.
    pub(super) fn call(&mut self, id: ExprId, call: &'u Call) -> LeafClocks<Clock> {
        let units = self.units;
        let callee = &units[call.unit.0 as usize];
        let mut base = self.call_clock(call, callee);
        if base == Clock::ANY && canonical_condition::runs_always(self, callee) {
            base = Clock::BASE;
        }
        self.calls.insert(id, base);
        self.update_exposed(id, call, base);
        let is_kept = !self.unit.is_lustre && matches!(call.activation, Activation::Condact { .. });
        if is_kept || may_be_inactive(callee) {
            return LeafClocks::Uniform(base);
        }
        let mut leaves = Vec::new();
        for output in &callee.outputs {
            for k in 0..callee.flow(*output).ty.leaf_count() {
                let path = self.port_path(call, callee, *output, k);
                leaves.push(self.translate_clock(id, call, &path, base));
            }
        }
        LeafClocks::from_leaves(leaves.into_iter(), base)
    }

    /// Returns the clock on which a call runs: the common clock of its arguments and of the operands of its activation.
    fn call_clock(&mut self, call: &Call, callee: &Unit) -> Clock {
        let mut clocks = Vec::new();
        for (formal, arg) in callee.inputs.iter().zip(&call.args) {
            let Some(arg) = arg else { continue };
            let depth = self.port_path(call, callee, *formal, 0).len();
            let outer =
                |clock: Clock| (0..depth).fold(clock, |at, _| self.parent(at).unwrap_or(at));
            clocks.extend(self.exprs[arg.0 as usize].iter().map(outer));
        }
        call.activation
            .operands(&mut |id| clocks.push(self.common_clock(id)));
        let mut known = clocks.into_iter().filter(|clock| *clock != Clock::ANY);
        let base = match self.unit.is_lustre {
            true => known.next(),
            false => known.reduce(|a, b| self.meet(a, b)),
        };
        base.unwrap_or(Clock::ANY)
    }

    /// Records the caller's clock of each flow inside of the callee that is a clock condition of the callee's outputs.
    /// `base` is the clock on which the call runs.
    fn update_exposed(&mut self, id: ExprId, call: &Call, base: Clock) {
        let clocks = &self.facts[call.unit.0 as usize].clocks;
        for (number, (_, clock)) in (0..).zip(clocks.exposed()) {
            let clock = self.translate_clock(id, call, clocks.path(*clock), base);
            self.set_exposed_clock(id, number, clock);
        }
    }

    /// Returns the clock of the caller that corresponds to a clock of the called unit. `path` is the clock in the unit,
    /// as samplings from its base clock on, and `base` is the clock on which the call runs.
    pub(super) fn translate_clock(
        &mut self,
        id: ExprId,
        call: &Call,
        path: &[Sampling],
        base: Clock,
    ) -> Clock {
        let Some(tick) = path.last() else {
            return base;
        };
        match self.translate_condition(id, call, tick.condition) {
            Some(by) => self.ticks.intern(Sampling {
                condition: by,
                ..*tick
            }),
            None => Clock::ANY,
        }
    }

    /// Returns the clock condition of the caller that corresponds to a clock condition `by` of the called unit, a flow
    /// whose value decides when a clock ticks. It is the argument passed for that flow if this is a flow itself, else
    /// the condition inside of this call. `None` if the condition is not visible to the caller.
    fn translate_condition(
        &mut self,
        id: ExprId,
        call: &Call,
        by: ClockCondition,
    ) -> Option<ClockCondition> {
        let callee = &self.units[call.unit.0 as usize];
        if let ClockCondition::Flow(flow) = by
            && let Some(port) = callee.inputs.iter().position(|input| *input == flow)
            && let Some(given) =
                call.args[port].and_then(|arg| canonical_condition::condition(self, arg, 0))
        {
            return Some(given);
        }
        let exposed = self.facts[call.unit.0 as usize].clocks.exposed();
        let number = exposed.iter().position(|(known, _)| *known == by)?;
        Some(ClockCondition::CallInternal(
            id,
            u32::try_from(number).ok()?,
        ))
    }

    /// Returns the clock of leaf `k` (scalar part) of a port of the called unit, as samplings from the base clock of
    /// that unit on.
    pub(super) fn port_path(
        &self,
        call: &Call,
        callee: &Unit,
        port: FlowId,
        k: usize,
    ) -> Vec<Sampling> {
        let clocks = &self.facts[call.unit.0 as usize].clocks;
        if clocks.has_samplings() {
            return clocks.path(clocks.flow_clocks(port).leaf(k)).to_vec();
        }
        let mut path = Vec::new();
        let mut at = port;
        // A flow that decides about its own clock has been reported in the callee. The bound on the length ends the
        // loop here.
        let declared = |at: FlowId| callee.flow(at).clock;
        while let Some(on) = declared(at).filter(|_| path.len() < callee.flows.len()) {
            let by = ClockCondition::Flow(on.flow);
            path.push(Sampling {
                condition: by,
                value: on.value,
            });
            at = on.flow;
        }
        path.reverse();
        path
    }

    /// Returns the clock conditions of the unit's outputs, flows whose values decide when the outputs have a value,
    /// each with its own clock. Callers refer to them by their index in this list.
    pub(super) fn exposed(&self) -> Vec<(ClockCondition, Clock)> {
        let mut exposed: Vec<(ClockCondition, Clock)> = Vec::new();
        let rows = self
            .unit
            .outputs
            .iter()
            .map(|id| &self.flows[id.0 as usize]);
        for clock in rows.flat_map(LeafClocks::iter) {
            let chain = self.chain(clock).unwrap_or_default();
            for tick in chain.iter().filter_map(|clock| self.ticks.sampling(*clock)) {
                if exposed.iter().all(|(known, _)| *known != tick.condition) {
                    let clock = self.ticks.clock_of(tick).and_then(|at| self.parent(at));
                    exposed.push((tick.condition, clock.unwrap_or(Clock::BASE)));
                }
            }
        }
        exposed
    }
}

/// Whether a called fragment may be inactive in a cycle of its caller, because it has an activation condition. Its
/// results are then optional flows of the caller.
pub(crate) fn may_be_inactive(callee: &Unit) -> bool {
    callee.kind == UnitKind::Fragment && callee.block(BlockId::ROOT).when.is_some()
}
