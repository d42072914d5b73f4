//! `condact<<node, default>>(c, x, ...)` of Lustre V6: the node runs when `c` is true. The output is held between
//! activations, and is `default` before the first one.

use super::args::Given;
use super::body::Body;
use super::callable::Callable;
use super::report::Wanted;
use crate::ty::Ty;
use crate::typed::{Activation, Each, ExprId, Kind};
use rpi_diag::{Code, Finding, Span};
use rpi_syntax::ast::{Call, Expr, StaticValue};

impl<'a> Body<'_, 'a> {
    /// Checks a call of `condact` with static arguments.
    pub(super) fn condact_of(&mut self, call: &'a Call, span: Span) -> ExprId {
        let given = self.given(&call.args);
        let mut given = self.first_of_list(given).into_iter();
        let (Some(every), [callee, default]) = (given.next(), &call.callee.statics[..]) else {
            let finding = Finding::new(Code::RPI1010, "missing arguments of `condact`")
                .at(span, "invalid arguments")
                .help("write `condact<<node, default>>(condition, arguments)`");
            return self.fault_with(finding, span);
        };
        let StaticValue::Expr(default) = &default.value else {
            let finding = Finding::new(Code::RPI1010, "a value is expected here")
                .at(default.span, "not a value");
            return self.fault_with(finding, span);
        };
        let Some(callable) = self.static_callee(callee) else {
            return self.fault(span);
        };
        self.has_state(span);
        self.expect(every.value, &Ty::Bool, &Wanted::Here);
        let default = self.expr(default);
        let rest = given.collect();
        match callable {
            Callable::Unit(..) => {
                let activation = Activation::Condact {
                    every: every.value,
                    default: Some(default),
                    restart: None,
                };
                self.apply(&callable, rest, activation, span)
            }
            _ => self.held(&callable, rest, [every.value, default], span),
        }
    }

    /// Decomposes the first argument, as the condition may be the first output of a call.
    fn first_of_list(&mut self, mut given: Vec<Given<'a>>) -> Vec<Given<'a>> {
        let rest = given.split_off(given.len().min(1));
        self.spread_tuples(given).into_iter().chain(rest).collect()
    }

    /// Checks the value of the output before the first activation. Between activations the output is held.
    pub(super) fn held_before(&mut self, default: &'a Expr) -> ExprId {
        self.has_state(default.span);
        self.expr(default)
    }

    /// Checks `condact` of an operator, which has no state of its own: its value is held while the condition is false.
    fn held(
        &mut self,
        callable: &Callable,
        given: Vec<Given<'a>>,
        [every, default]: [ExprId; 2],
        span: Span,
    ) -> ExprId {
        let value = self.apply(callable, given, Activation::Always, span);
        let ty = self.ty_of(value).clone();
        self.expect(default, &ty, &Wanted::Here);
        let none = self.add(Kind::None, ty.clone(), span);
        let there = Kind::Each(Each::If, [every, value, none].into());
        let there = self.add(there, ty.clone(), span);
        self.add(Kind::Each(Each::Hold, [there, default].into()), ty, span)
    }
}
