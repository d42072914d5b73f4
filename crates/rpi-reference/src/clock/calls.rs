//! Clocks of calls: the clocks of the ports of the callee, as seen by the caller.

use std::rc::Rc;

use rpi_sema::typed::{Activation, Call, ExprId, FlowId, TargetPlace, TypedKind, Unit, UnitKind};

use super::{Clock, ClockCondition, ClockSolver, Sampling, base, common_prefix};

/// Returns the call if an expression of this kind is a call, else `None`.
pub(crate) fn call_of(kind: &TypedKind) -> Option<&Call> {
    match kind {
        TypedKind::Call(call) => Some(call),
        _ => None,
    }
}

impl<'p> ClockSolver<'p> {
    /// Returns the clock of leaf (scalar part) number `k` of the result of a call, in terms of flows of the caller;
    /// `None` if it is unknown. Stores the clock on which the call runs.
    pub(super) fn call(&mut self, id: ExprId, call: &Call, k: usize) -> Clock {
        let callee = &self.units[call.unit.0 as usize];
        let mut runs = self.runs(call);
        let port = self.port(call, callee, k).filter(|port| !port.is_empty());
        // A callee with state and without clocked arguments has its first cycle in that of the caller, as if its result
        // had a name. In Lustre such a call adopts the clock of its reader.
        let has_own_start = self.has_starts && callee.has_state && !self.unit.is_lustre;
        let is_needed = port.is_some() && self.is_settled;
        if (is_needed || has_own_start) && runs.is_none() {
            runs = base();
        }
        self.clocks.calls[id.0 as usize].clone_from(&runs);
        match port {
            Some(port) => Some(self.in_caller(id, call, runs?.to_vec(), &port)),
            None => runs,
        }
    }

    /// Returns the clock of leaf (scalar part) number `k` of the outputs, in terms of flows of the callee. The results
    /// of a fragment are optional flows of the caller on the base clock (M4.2), and so are those of a call that holds
    /// them between its runs (M4.10).
    fn port(&self, call: &Call, callee: &Unit, mut k: usize) -> Clock {
        let kept = matches!(call.activation, Activation::Condact { .. });
        if kept || callee.kind == UnitKind::Fragment {
            return base();
        }
        let clocks = self.callees[call.unit.0 as usize].as_ref()?;
        for output in &callee.outputs {
            let leaves = &clocks.flows[output.0 as usize];
            match leaves.get(k) {
                Some(clock) => return clock.clone(),
                None => k -= leaves.len(),
            }
        }
        None
    }

    /// Returns the clock on which a call runs: the common prefix of the clocks of its arguments, each without the
    /// sampling steps that the in-port itself requires.
    fn runs(&self, call: &Call) -> Clock {
        let callee = &self.units[call.unit.0 as usize];
        let mut clocks = Vec::new();
        for (port, arg) in callee.inputs.iter().zip(&call.args) {
            let own = self.port_clock(call, *port).len();
            for clock in arg
                .iter()
                .flat_map(|arg| &self.clocks.exprs[arg.0 as usize])
            {
                let outer =
                    |clock: &Rc<[Sampling]>| clock[..clock.len().saturating_sub(own)].into();
                clocks.push(clock.as_ref().map(outer));
            }
        }
        call.activation.operands(&mut |operand| {
            clocks.extend(self.clocks.exprs[operand.0 as usize].iter().cloned());
        });
        common_prefix(clocks.into_iter())
    }

    /// Returns the sampling steps of the clock of an in-port, in terms of flows of the callee; empty if the in-port is
    /// on the base clock.
    fn port_clock(&self, call: &Call, port: FlowId) -> Rc<[Sampling]> {
        let clocks = self.callees[call.unit.0 as usize].as_ref();
        let clock = clocks.and_then(|clocks| clocks.flows[port.0 as usize].first()?.clone());
        clock.unwrap_or_else(|| Rc::new([]))
    }

    /// Returns the clock on which a call reads argument number `number` if the argument has no clock of its own, such
    /// as a literal; `None` if the clock of the call is unknown.
    pub(super) fn argument_clock(&self, id: ExprId, call: &Call, number: usize) -> Clock {
        let port = self.units[call.unit.0 as usize].inputs[number];
        let runs = self.clocks.calls[id.0 as usize].clone()?;
        Some(self.in_caller(id, call, runs.to_vec(), &self.port_clock(call, port)))
    }

    /// Translates a clock of the callee to the caller: returns the clock of the call, followed by the sampling steps
    /// `inner` with flows of the caller in place of ports of the callee.
    fn in_caller(
        &self,
        id: ExprId,
        call: &Call,
        mut clock: Vec<Sampling>,
        inner: &[Sampling],
    ) -> Rc<[Sampling]> {
        for Sampling { by, value } in inner {
            let named = match by {
                ClockCondition::Flow(flow) => self.caller_flow(id, call, *flow),
                ClockCondition::InCall(..) => None,
            };
            let by = match named {
                Some(flow) => self.clock_condition(flow),
                None => ClockCondition::InCall(id, Box::new(by.clone())),
            };
            clock.push(Sampling { by, value: *value });
        }
        clock.into()
    }

    /// Returns the flow of the caller that is the argument for an in-port, or that an equation binds to an out-port;
    /// `None` if there is no such flow, for example for a computed argument.
    fn caller_flow(&self, id: ExprId, call: &Call, port: FlowId) -> Option<FlowId> {
        let callee = &self.units[call.unit.0 as usize];
        if let Some(number) = callee.inputs.iter().position(|input| *input == port) {
            return match self.unit.expr(call.args[number]?).kind {
                TypedKind::Flow(flow) => Some(flow),
                _ => None,
            };
        }
        let number = callee.outputs.iter().position(|output| *output == port)?;
        let equations = self.unit.blocks.iter().flat_map(|block| &block.equations);
        let mut binding = equations.filter(|equation| equation.value == id);
        let targets = &binding.next()?.targets;
        match targets.get(number)?.place {
            TargetPlace::Flow { flow, at: 0 } if targets.len() == callee.outputs.len() => {
                Some(flow)
            }
            _ => None,
        }
    }
}
