//! Random statements other than equations of one flow: fragments, automata, and calls with several results.

use super::exprs::{Decider, Requirement, Scope};
use super::forms::{form, then};
use super::generator::{ClockedGenerator, base};
use super::model::{
    Body, Bound, Clock, Declared, Equation, Expr, Flow, FlowId, Kind, State, Statement, Unit,
};

/// Call of a node whose results have different clocks.
struct CallSite<'c> {
    callee: &'c Unit,
    /// Clock of the call.
    clock: &'c Clock,
    /// Argument of the first in-port, a condition.
    condition: &'c str,
    /// Whether the condition has a name in the caller.
    is_condition_named: bool,
    /// Name of the results.
    name: &'c str,
    /// Whether the results are bound as a whole, `r = f(..)`.
    is_whole: bool,
}

impl ClockedGenerator<'_> {
    /// Returns a statement other than an equation of one flow.
    pub(super) fn statement(
        &mut self,
        scope: &mut Scope,
        body: &mut Body,
        nesting: usize,
    ) -> Option<Statement> {
        match self.random.below(4) {
            0 if nesting > 0 => Some(self.fragment(scope, nesting)),
            1 if nesting > 0 => Some(self.automaton(scope, nesting)),
            _ => self.instance(scope, body),
        }
    }

    fn condition(&mut self, scope: &Scope) -> Expr {
        let want = Requirement {
            kind: Kind::Bool,
            clock: base(),
            optional: false,
        };
        self.exprs().expr(scope, &want, 2)
    }

    /// Returns the flows that can be read in a block: none that are defined later.
    fn inner(&self, scope: &Scope) -> Scope {
        Scope {
            delayed: Vec::new(),
            last: Vec::new(),
            ..scope.clone()
        }
    }

    fn fragment(&mut self, scope: &mut Scope, nesting: usize) -> Statement {
        let name = self.name("F");
        let when = self.condition(scope);
        let kind = self.kind();
        let wanted = self.name("f");
        let wanted = self.flow(wanted, kind, base());
        self.flows[wanted].declared = Declared::Exact;
        let mut body = self.body(self.inner(scope), &[wanted], nesting - 1, 3);
        for flow in body.locals.clone().into_iter().chain([wanted]) {
            let Flow {
                kind,
                clock,
                optional,
                name: own,
                ..
            } = self.flows[flow].clone();
            if flow != wanted && self.random.one_in(2) {
                continue;
            }
            self.flows[flow].is_fixed = true;
            let outer = self.flow(format!("{name}.{own}"), kind, base());
            self.flows[outer].optional = true;
            match clock.is_empty() && !optional {
                true => scope.known.push(outer),
                false => scope.outside.push(outer),
            }
        }
        body.locals.push(wanted);
        Statement::Fragment {
            name,
            when,
            restart: self.random.one_in(2),
            body,
        }
    }

    fn automaton(&mut self, scope: &mut Scope, nesting: usize) -> Statement {
        let (name, kind) = (self.name("s"), self.kind());
        let shared = self.flow(name, kind, base());
        self.flows[shared].declared = Declared::Not;
        let names: Vec<String> = (0..2 + self.random.below(2))
            .map(|_| self.name("S"))
            .collect();
        let mut states = Vec::new();
        let mut outside = Vec::new();
        for name in &names {
            let mut inner = self.inner(scope);
            inner.last.push(shared);
            let unless = self.transition(scope, &names, 4);
            let body = self.body(inner.clone(), &[shared], nesting - 1, 3);
            inner.known.push(shared);
            let until = self.transition(&inner, &names, 1);
            for flow in &body.locals {
                if self.random.one_in(3) {
                    outside.push(*flow);
                }
            }
            states.push(State {
                name: name.clone(),
                body,
                unless,
                until,
            });
        }
        for flow in outside {
            let Flow { kind, name, .. } = self.flows[flow].clone();
            self.flows[flow].declared = Declared::Not;
            self.flows[flow].is_free = false;
            self.flows[flow].is_fixed = true;
            let outer = self.flow(name, kind, base());
            self.flows[outer].optional = true;
            scope.outside.push(outer);
        }
        scope.known.push(shared);
        Statement::Automaton(states)
    }

    fn transition(
        &mut self,
        scope: &Scope,
        names: &[String],
        cases: usize,
    ) -> Vec<(Expr, &'static str, String)> {
        if !self.random.one_in(cases) {
            return Vec::new();
        }
        let condition = self.condition(scope);
        let how = if self.random.one_in(2) {
            "then"
        } else {
            "continue"
        };
        vec![(condition, how, self.random.pick(names).clone())]
    }

    /// Adds a call of a node whose results have different clocks.
    fn instance(&mut self, scope: &mut Scope, body: &mut Body) -> Option<Statement> {
        let known = self.units.len();
        let callee = (known > 0).then(|| self.units[self.random.below(known)].clone())?;
        let bools = scope.deciders.iter().filter(|one| one.kind == Kind::Bool);
        let bools: Vec<Decider> = bools.cloned().collect();
        let decider = self.random.pick(&bools).clone();
        let clock = decider.clock.clone();
        let unnamed = !self.lustre && callee.inputs.len() == 2 && self.random.one_in(4);
        let want = |kind, clock: &Clock| Requirement {
            kind,
            clock: clock.clone(),
            optional: false,
        };
        let mut args = Vec::new();
        let on = match unnamed {
            false => decider.name.clone(),
            true => {
                args.push(self.exprs().expr(scope, &want(Kind::Bool, &clock), 2));
                self.name("?")
            }
        };
        let x = self.exprs().leaf(scope, &want(Kind::Int, &clock));
        if !x.is_anchored(&clock) {
            return None;
        }
        args.push(x);
        let (on_text, on) = (on.clone(), then(&clock, &on));
        if callee.inputs.len() > 2 {
            args.push(self.exprs().expr(scope, &want(Kind::Int, &on), 2));
        }
        let condition = (!unnamed).then_some(&*decider.name);
        let value = call(&callee.name, condition, args, &want(Kind::Int, &clock));
        let whole = self.name("r");
        let is_whole = !self.lustre && (unnamed || self.random.one_in(2));
        let site = CallSite {
            callee: &callee,
            clock: &clock,
            condition: &on_text,
            is_condition_named: !unnamed,
            name: &whole,
            is_whole,
        };
        let targets = self.result_flows(&site, scope);
        if self.lustre {
            body.locals.extend(&targets);
        }
        let bound = if is_whole {
            Bound::Whole(whole)
        } else {
            Bound::Names
        };
        Some(Statement::Equation(Equation {
            targets,
            value,
            bound,
        }))
    }

    /// Adds the flows of the results of a call.
    fn result_flows(&mut self, site: &CallSite<'_>, scope: &mut Scope) -> Vec<FlowId> {
        let (whole, on_text) = (site.name, site.condition);
        let mut targets = Vec::new();
        for output in &site.callee.outputs {
            let own = self.flows[*output].clone();
            let first = &self.flows[site.callee.inputs[0]].name;
            let samplings = own.clock.iter().map(|own| match own == first {
                true => on_text.to_owned(),
                // Neither a condition inside the callee nor an unnamed argument has a name in the caller.
                false if *own == format!("not {first}") && site.is_condition_named => {
                    format!("not {on_text}")
                }
                false => format!("?{whole} {own}"),
            });
            let clock: Clock = site.clock.iter().cloned().chain(samplings).collect();
            let name = match site.is_whole {
                true => format!("{whole}.{}", own.name),
                false => format!("{whole}_{}", own.name),
            };
            let flow = self.flow(name, own.kind, clock);
            self.flows[flow].optional = own.optional;
            self.flows[flow].declared = if self.lustre {
                Declared::Exact
            } else {
                Declared::Not
            };
            scope.known.push(flow);
            scope.delayed.push(flow);
            targets.push(flow);
        }
        targets
    }
}

/// Returns a call of a node. The condition is its first argument, unless it is among the other ones.
fn call(callee: &str, condition: Option<&str>, args: Vec<Expr>, want: &Requirement) -> Expr {
    let given = vec!["@"; args.len()].join(", ");
    let first = condition.map_or_else(String::new, |condition| format!("{condition}, "));
    let text = format!("{callee}({first}{given})");
    form(&text, args, want, Some(want.clock.clone()))
}
