//! Clocks of calls: what a callee's ports tick by, as the caller sees it.

use std::rc::Rc;

use rpi_sema::typed::{Activation, Call, ExprId, FlowId, Kind, Place, Unit, UnitKind};

use super::{Clock, Decider, Finder, Sampling, base, common};

/// The call that an expression is.
pub(crate) fn call_of(kind: &Kind) -> Option<&Call> {
    match kind {
        Kind::Call(call) => Some(call),
        _ => None,
    }
}

impl<'p> Finder<'p> {
    /// The clock of a leaf of what a call gives: that of the out-port, seen from the caller.
    pub(super) fn call(&mut self, id: ExprId, call: &Call, k: usize) -> Clock {
        let callee = &self.units[call.unit.0 as usize];
        let mut runs = self.runs(call);
        let port = self.port(call, callee, k).filter(|port| !port.is_empty());
        // A callee with state that no argument gives a clock has its first cycle where the caller has it, as if its result
        // had a name. In Lustre such a call has the clock of what reads it.
        let has_own_start = self.has_starts && callee.has_state && !self.unit.is_lustre;
        let is_needed = port.is_some() && self.is_settled;
        if (is_needed || has_own_start) && runs.is_none() {
            runs = base();
        }
        self.found.calls[id.0 as usize].clone_from(&runs);
        match port {
            Some(port) => Some(self.seen(id, call, runs?.to_vec(), &port)),
            None => runs,
        }
    }

    /// The clock of an out-port in the callee. A fragment's results are optional flows of the surroundings (M4.2), and so
    /// are those of a call that keeps them between its runs (M4.10).
    fn port(&self, call: &Call, callee: &Unit, mut k: usize) -> Clock {
        let kept = matches!(call.activation, Activation::Condact { .. });
        if kept || callee.kind == UnitKind::Fragment {
            return base();
        }
        let clocks = self.known[call.unit.0 as usize].as_ref()?;
        for output in &callee.outputs {
            let leaves = &clocks.flows[output.0 as usize];
            match leaves.get(k) {
                Some(clock) => return clock.clone(),
                None => k -= leaves.len(),
            }
        }
        None
    }

    /// The clock by which a call runs: what its arguments have in common, each without what its port is sampled by.
    fn runs(&self, call: &Call) -> Clock {
        let callee = &self.units[call.unit.0 as usize];
        let mut clocks = Vec::new();
        for (port, arg) in callee.inputs.iter().zip(&call.args) {
            let own = self.of_port(call, *port).len();
            for clock in arg.iter().flat_map(|arg| &self.found.exprs[arg.0 as usize]) {
                let outer =
                    |clock: &Rc<[Sampling]>| clock[..clock.len().saturating_sub(own)].into();
                clocks.push(clock.as_ref().map(outer));
            }
        }
        call.activation.operands(&mut |operand| {
            clocks.extend(self.found.exprs[operand.0 as usize].iter().cloned());
        });
        common(clocks.into_iter())
    }

    /// The clock of an in-port in the callee.
    fn of_port(&self, call: &Call, port: FlowId) -> Rc<[Sampling]> {
        let clocks = self.known[call.unit.0 as usize].as_ref();
        let clock = clocks.and_then(|clocks| clocks.flows[port.0 as usize].first()?.clone());
        clock.unwrap_or_else(|| Rc::new([]))
    }

    /// The clock of an argument that has none of its own.
    pub(super) fn of_argument(&self, id: ExprId, call: &Call, number: usize) -> Clock {
        let port = self.units[call.unit.0 as usize].inputs[number];
        let runs = self.found.calls[id.0 as usize].clone()?;
        Some(self.seen(id, call, runs.to_vec(), &self.of_port(call, port)))
    }

    /// A clock of the callee behind the clock of the call, by the caller's names.
    fn seen(
        &self,
        id: ExprId,
        call: &Call,
        mut clock: Vec<Sampling>,
        inner: &[Sampling],
    ) -> Rc<[Sampling]> {
        for Sampling { by, value } in inner {
            let named = match by {
                Decider::Flow(flow) => self.name(id, call, *flow),
                Decider::Behind(..) => None,
            };
            let by = match named {
                Some(flow) => self.by(flow),
                None => Decider::Behind(id, Box::new(by.clone())),
            };
            clock.push(Sampling { by, value: *value });
        }
        clock.into()
    }

    /// The flow of the caller that is given for a port, or that takes it.
    fn name(&self, id: ExprId, call: &Call, port: FlowId) -> Option<FlowId> {
        let callee = &self.units[call.unit.0 as usize];
        if let Some(number) = callee.inputs.iter().position(|input| *input == port) {
            return match self.unit.expr(call.args[number]?).kind {
                Kind::Flow(flow) => Some(flow),
                _ => None,
            };
        }
        let number = callee.outputs.iter().position(|output| *output == port)?;
        let equations = self.unit.blocks.iter().flat_map(|block| &block.equations);
        let mut binding = equations.filter(|equation| equation.value == id);
        let targets = &binding.next()?.targets;
        match targets.get(number)?.place {
            Place::Flow { flow, at: 0 } if targets.len() == callee.outputs.len() => Some(flow),
            _ => None,
        }
    }
}
