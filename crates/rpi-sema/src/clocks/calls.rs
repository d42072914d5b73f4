//! Clocks of a callee's ports as its caller sees them: relative to the clock of the call, and to the caller's names for
//! the flows that decide.

use super::infer::{Inference, Of, flow_of};
use super::terms::Term;
use crate::typed::{Call, ClockOn, ExprId, FlowId, Place, Unit};
use rpi_diag::Span;

impl Inference<'_> {
    /// A call: clocks of arguments and results.
    pub(super) fn call(&mut self, id: ExprId, call: &Call) -> Of {
        let callee = &self.units[call.unit.0 as usize];
        let mut given: Vec<ExprId> = call.args.iter().flatten().copied().collect();
        let mut deciding = Vec::new();
        call.activation.operands(&mut |id| deciding.push(id));
        given.extend(&deciding);
        let mut ports = callee.inputs.iter();
        let meeting = match ports.any(|port| callee.flow(*port).clock.is_some()) {
            true => None,
            false => self.meeting(&given),
        };
        let base = meeting.unwrap_or_else(|| self.terms.open());
        self.place(id, base);
        let names = self.names(id, call, callee);
        if meeting.is_none() {
            for (formal, arg) in callee.inputs.iter().zip(&call.args) {
                if let Some(arg) = arg {
                    let wanted = self.seen(callee, *formal, base, &names);
                    self.all(*arg, wanted);
                }
            }
            // What decides about a call has the call's clock.
            for deciding in deciding {
                self.all(deciding, base);
            }
        }
        let mut results = Vec::with_capacity(callee.outputs.len());
        for output in &callee.outputs {
            self.has_named_clock(callee, *output, &names, self.unit.expr(id).span);
            let term = self.seen(callee, *output, base, &names);
            results.push((term, callee.flow(*output).ty.leaf_count()));
        }
        match results[..] {
            [(one, _)] => Of::One(one),
            _ => Of::Each(results),
        }
    }

    /// What the caller calls the callee's ports: the flows given, and those that take the results.
    fn names(&self, id: ExprId, call: &Call, callee: &Unit) -> Vec<(FlowId, FlowId)> {
        let given = callee.inputs.iter().zip(&call.args);
        let given = given.filter_map(|(formal, arg)| Some((*formal, flow_of(self.unit, (*arg)?)?)));
        let mut names: Vec<(FlowId, FlowId)> = given.collect();
        // A name for all results together is one for none of them.
        let bound = self.is_bound_to(id);
        if let Some(equation) = bound.filter(|e| e.targets.len() == callee.outputs.len()) {
            let targets = equation.targets.iter().map(|target| target.place.clone());
            for (formal, place) in callee.outputs.iter().zip(targets) {
                if let Place::Flow { flow, at: 0 } = place {
                    names.push((*formal, flow));
                }
            }
        }
        names
    }

    /// Reports an out-port that ticks by what the caller has no name for: whether it does could not be asked. In Lustre
    /// such a clock is one by itself.
    fn has_named_clock(
        &mut self,
        callee: &Unit,
        port: FlowId,
        names: &[(FlowId, FlowId)],
        span: Span,
    ) {
        let Some(on) = callee.flow(port).clock.filter(|_| !self.unit.is_lustre) else {
            return;
        };
        if names.iter().any(|(formal, _)| *formal == on.flow) {
            return;
        }
        let name_of = |flow: &FlowId| callee.flow(*flow).name.as_str();
        let [name, clock] = [port, on.flow].map(|flow| name_of(&flow));
        let callee_name = &callee.name;
        let text =
            format!("`{name}` of `{callee_name}` ticks by `{clock}`, which has no name here");
        let help = match callee.inputs.contains(&on.flow) {
            true => format!("give `{clock}` a flow that has a name"),
            false => {
                let names: Vec<&str> = callee.outputs.iter().map(name_of).collect();
                let names = names.join(", ");
                format!("name the results one by one: `let ({names}) = {callee_name}(...)`")
            }
        };
        self.report_with(span, text, help);
    }

    /// The clock of a port.
    fn seen(
        &mut self,
        callee: &Unit,
        port: FlowId,
        base: Term,
        names: &[(FlowId, FlowId)],
    ) -> Term {
        let mut way = Vec::new();
        let mut at = port;
        // A flow that decides about itself has been reported in the callee.
        while let Some(on) = callee
            .flow(at)
            .clock
            .filter(|_| way.len() < callee.flows.len())
        {
            way.push(on);
            at = on.flow;
        }
        let mut term = base;
        for on in way.into_iter().rev() {
            let name = names.iter().find(|(formal, _)| *formal == on.flow);
            term = match name {
                Some((_, flow)) => {
                    let on = ClockOn { flow: *flow, ..on };
                    self.terms.on(term, on)
                }
                // The caller has no name for it: nothing else can have this clock.
                None => self.terms.open(),
            };
        }
        term
    }
}
