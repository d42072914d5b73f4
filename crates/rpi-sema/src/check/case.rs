//! Activations in cases of a `merge`. In Kind 2, the case `(activate f every c)(x)` means `f(x when c)`.

use super::body::Body;
use crate::facts::literal;
use crate::typed::{Activation, Call, ClockOn, ExprId, Kind};

impl Body<'_, '_> {
    /// Gives a call in a case of a `merge` and its arguments the clock of the case, if the call is activated by the
    /// same condition. Returns any other case as it is.
    pub(super) fn activated_by(&mut self, on: ExprId, value: u32, case: ExprId) -> ExprId {
        let Some((clock, call, restart)) = self.activation_of(on, value, case) else {
            return case;
        };
        let args = call
            .args
            .iter()
            .map(|arg| arg.map(|arg| self.sampled(arg, clock)));
        let args = args.collect();
        let activation = match restart {
            Some(every) => Activation::Restart {
                every: self.sampled(every, clock),
            },
            None => Activation::Always,
        };
        let call = Call {
            unit: call.unit,
            args,
            activation,
        };
        let (ty, span) = (self.ty_of(case).clone(), self.span_of(case));
        self.add(Kind::Call(Box::new(call)), ty, span)
    }

    /// Returns the clock of a case, its call, and the restart condition of the call.
    fn activation_of(
        &self,
        on: ExprId,
        value: u32,
        case: ExprId,
    ) -> Option<(ClockOn, Call, Option<ExprId>)> {
        let (Kind::Flow(flow), Kind::Call(call)) =
            (&self.unit.expr(on).kind, &self.unit.expr(case).kind)
        else {
            return None;
        };
        let Activation::Condact {
            every,
            default: None,
            restart,
        } = call.activation
        else {
            return None;
        };
        let decides = literal(&self.unit, every, true) == Some((flow.0, value == 1));
        let clock = ClockOn { flow: *flow, value };
        decides.then(|| (clock, (**call).clone(), restart))
    }

    fn sampled(&mut self, value: ExprId, clock: ClockOn) -> ExprId {
        let (ty, span) = (self.ty_of(value).clone(), self.span_of(value));
        self.add(Kind::When { value, clock }, ty, span)
    }
}
