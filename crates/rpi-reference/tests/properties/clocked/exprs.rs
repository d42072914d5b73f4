//! Random expressions of a given type and clock.

use std::rc::Rc;

use super::forms::{FORMS, Form, Part, common, form, samplings, then, when};
use super::model::{Clock, Expr, Flow, FlowId, Kind, Node};
use crate::random::Random;

/// Required properties of an expression: type, clock, and whether it may be absent at ticks of that clock.
#[derive(Clone, Debug)]
pub(crate) struct Requirement {
    pub(crate) kind: Kind,
    pub(crate) clock: Clock,
    pub(crate) optional: bool,
}

/// Flow that may be used as a clock.
#[derive(Clone, Debug)]
pub(crate) struct Decider {
    pub(crate) name: String,
    pub(crate) kind: Kind,
    pub(crate) clock: Clock,
}

/// Flows that can be read at a location.
#[derive(Clone, Default, Debug)]
pub(crate) struct Scope {
    /// Flows defined before.
    pub(crate) known: Vec<FlowId>,
    /// Flows that may be read through a delay.
    pub(crate) delayed: Vec<FlowId>,
    /// Flows of fragments and states that have a clock there, so they are optional here.
    pub(crate) outside: Vec<FlowId>,
    pub(crate) deciders: Vec<Decider>,
    /// Flows whose value in the last cycle of the automaton can be read.
    pub(crate) last: Vec<FlowId>,
}

/// Generator of expressions.
pub(crate) struct Exprs<'m> {
    pub(crate) random: &'m mut Random,
    pub(crate) flows: &'m mut Vec<Flow>,
    pub(crate) lustre: bool,
}

impl Exprs<'_> {
    /// Returns an expression, not much deeper than `depth`. An expression without its own clock ticks in all cycles
    /// here.
    pub(crate) fn expr(&mut self, scope: &Scope, want: &Requirement, depth: usize) -> Expr {
        if depth == 0 || self.random.one_in(6) {
            return self.leaf(scope, want);
        }
        let special = match self.random.below(8) {
            0 => self.merge(scope, want, depth - 1),
            1 => self.split(scope, want, depth - 1),
            2 | 3 if want.clock.is_empty() && !want.optional => {
                self.present(scope, want, depth - 1)
            }
            2 | 3 if want.optional => self.absent(scope, want, depth - 1),
            4 if want.clock.is_empty() => self.last(scope, want, depth - 1),
            _ => None,
        };
        let made = match special {
            Some(made) => made,
            None => self.of_form(scope, want, depth - 1),
        };
        match made.clock.is_none() && want.clock.is_empty() || made.is_anchored(&want.clock) {
            true => made,
            false => self.leaf(scope, want),
        }
    }

    fn of_form(&mut self, scope: &Scope, want: &Requirement, depth: usize) -> Expr {
        let lustre = self.lustre;
        let is_possible = |(kind, text, _): &&Form| {
            // Lustre V6 has a different syntax for these.
            let known = !lustre || !text.starts_with("condact") && !text.contains(" with ");
            known && kind.is_none_or(|kind| kind == want.kind)
        };
        let rows: Vec<&Form> = FORMS.iter().filter(is_possible).collect();
        let (_, text, parts) = **self.random.pick(&rows);
        let parts = parts
            .iter()
            .map(|part| self.part(*part, scope, want, depth));
        let parts: Vec<Expr> = parts.collect();
        // The unused part may have another clock.
        let clock = match text.starts_with("(Pair") || text.starts_with("([") {
            true => parts
                .iter()
                .find_map(|part| part.clock.clone().filter(|c| *c == want.clock)),
            false => common(parts.iter().map(|part| part.clock.clone())),
        };
        form(text, parts, want, clock)
    }

    fn part(&mut self, part: Part, scope: &Scope, want: &Requirement, depth: usize) -> Expr {
        let total = |kind| Requirement {
            kind,
            optional: false,
            ..want.clone()
        };
        match part {
            Part::Own => self.expr(scope, want, depth),
            Part::Total => self.expr(scope, &total(want.kind), depth),
            Part::OfType(kind) => self.expr(scope, &total(kind), depth),
            Part::Unused(kind) => {
                let clocks = self.clocks(scope);
                let clock = match self.lustre {
                    true => want.clock.clone(),
                    false => self.random.pick(&clocks).clone(),
                };
                self.expr(
                    scope,
                    &Requirement {
                        clock,
                        ..total(kind)
                    },
                    depth.min(1),
                )
            }
            Part::Delayed => {
                let is_wanted = |id: &&FlowId| self.is_wanted(**id, want);
                let fit: Vec<&FlowId> = scope.delayed.iter().filter(is_wanted).collect();
                match fit.is_empty() || self.random.one_in(4) {
                    true => self.expr(scope, want, depth),
                    false => {
                        let flow = **self.random.pick(&fit);
                        self.read(flow)
                    }
                }
            }
        }
    }

    fn is_wanted(&self, id: FlowId, want: &Requirement) -> bool {
        let flow = &self.flows[id];
        flow.kind == want.kind && flow.clock == want.clock && (want.optional || !flow.optional)
    }

    pub(crate) fn read(&self, id: FlowId) -> Expr {
        let flow = &self.flows[id];
        Expr {
            node: Node::Flow(id),
            kind: flow.kind,
            optional: flow.optional,
            clock: Some(flow.clock.clone()),
        }
    }

    /// Returns all clocks that can be named at a location.
    pub(crate) fn clocks(&self, scope: &Scope) -> Vec<Clock> {
        let mut clocks: Vec<Clock> = vec![Rc::new([])];
        for decider in &scope.deciders {
            clocks.extend(samplings(decider).iter().map(|on| then(&decider.clock, on)));
        }
        clocks
    }

    /// Returns a flow, unchanged or sampled, or a literal.
    pub(crate) fn leaf(&mut self, scope: &Scope, want: &Requirement) -> Expr {
        let exact = scope.known.iter().filter(|id| self.is_wanted(**id, want));
        let exact: Vec<FlowId> = exact.copied().collect();
        let last = want.clock.last().cloned();
        let sampled: Vec<FlowId> = match &last {
            Some(on) if !on.starts_with('?') => {
                let faster = |id: &&FlowId| {
                    let flow = &self.flows[**id];
                    let is_faster =
                        flow.clock.len() < want.clock.len() && want.clock.starts_with(&flow.clock);
                    flow.kind == want.kind && is_faster && !flow.optional
                };
                scope.known.iter().filter(faster).copied().collect()
            }
            _ => Vec::new(),
        };
        if !exact.is_empty()
            && (sampled.is_empty() || self.random.one_in(2))
            && !self.random.one_in(5)
        {
            let flow = *self.random.pick(&exact);
            return self.read(flow);
        }
        match (sampled.is_empty() || self.random.one_in(5), last) {
            (false, Some(on)) => {
                let flow = *self.random.pick(&sampled);
                let mut value = self.read(flow);
                let mut way =
                    want.clock[self.flows[flow].clock.len()..want.clock.len() - 1].to_vec();
                if self.random.one_in(2) {
                    way.clear();
                }
                let mut at = self.flows[flow].clock.clone();
                for step in way {
                    at = then(&at, &step);
                    value = when(value, &step, at.clone());
                }
                when(value, &on, want.clock.clone())
            }
            (_, Some(on)) if !on.starts_with('?') => {
                let literal = self.literal(want);
                when(literal, &on, want.clock.clone())
            }
            (_, Some(_)) if !exact.is_empty() => self.read(exact[0]),
            _ => self.literal(want),
        }
    }

    pub(crate) fn literal(&mut self, want: &Requirement) -> Expr {
        let n = self.random.below(5);
        let text = match want.kind {
            Kind::Bool => (if n.is_multiple_of(2) { "true" } else { "false" }).to_owned(),
            Kind::Int => n.to_string(),
            Kind::Pair => format!("Pair{{u = {n}; v = {}}}", n + 1),
            Kind::Row => format!("[{n}, 7]"),
            Kind::Mode => (*self.random.pick(&["Off", "Slow", "Fast"])).to_owned(),
        };
        let total = Requirement {
            optional: false,
            ..want.clone()
        };
        form(&text, Vec::new(), &total, None)
    }

    /// Returns `merge c (...)`.
    fn merge(&mut self, scope: &Scope, want: &Requirement, depth: usize) -> Option<Expr> {
        let decider = self.decider(scope, &want.clock)?;
        let (mut text, mut parts) = (format!("(merge {}", decider.name), Vec::new());
        for on in samplings(&decider) {
            let clock = then(&want.clock, &on);
            parts.push(self.expr(
                scope,
                &Requirement {
                    clock,
                    ..want.clone()
                },
                depth,
            ));
            let value = match on.split_once('(') {
                Some((value, _)) => value,
                None if on.starts_with("not ") => "false",
                None => "true",
            };
            text.push_str(&format!(" ({value} -> @)"));
        }
        text.push(')');
        Some(form(&text, parts, want, Some(want.clock.clone())))
    }

    fn decider(&mut self, scope: &Scope, clock: &Clock) -> Option<Decider> {
        let fit = scope
            .deciders
            .iter()
            .filter(|decider| decider.clock == *clock);
        let fit: Vec<&Decider> = fit.collect();
        (!fit.is_empty()).then(|| (**self.random.pick(&fit)).clone())
    }

    /// Returns a result of a call whose results have different clocks.
    fn split(&mut self, scope: &Scope, want: &Requirement, depth: usize) -> Option<Expr> {
        if self.lustre || want.kind != Kind::Int {
            return None;
        }
        let total = Requirement {
            optional: false,
            ..want.clone()
        };
        if self.random.one_in(2) {
            let decider = self
                .decider(scope, &want.clock)
                .filter(|one| one.kind == Kind::Bool)?;
            let x = self.expr(scope, &total, depth);
            let text = format!("Split({}, @).b", decider.name);
            return Some(form(&text, vec![x], want, Some(want.clock.clone())));
        }
        let (on, around) = want.clock.split_last()?;
        let is_on = |one: &&Decider| one.name == *on && *one.clock == *around;
        let decider = scope.deciders.iter().find(is_on)?.clone();
        let x = self.expr(
            scope,
            &Requirement {
                clock: decider.clock.clone(),
                ..total
            },
            depth,
        );
        let text = format!("Split({}, @).a", decider.name);
        Some(form(&text, vec![x], want, Some(want.clock.clone())))
    }

    /// Returns `last x`.
    fn last(&mut self, scope: &Scope, want: &Requirement, depth: usize) -> Option<Expr> {
        let has_kind = |id: &&FlowId| self.flows[**id].kind == want.kind;
        let flow = *scope.last.iter().find(has_kind)?;
        let total = Requirement {
            optional: false,
            ..want.clone()
        };
        let first = self.expr(scope, &total, depth);
        let text = format!("(@ -> last {})", self.flows[flow].name);
        Some(form(&text, vec![first], want, Some(want.clock.clone())))
    }

    /// Returns `current x`, which is absent before the first tick of x; in Lustre that would be an error.
    fn current(&mut self, scope: &Scope, want: &Requirement, depth: usize) -> Option<Expr> {
        let clock = self.slower(scope, &want.clock)?;
        let x = self.expr(
            scope,
            &Requirement {
                clock,
                ..want.clone()
            },
            depth,
        );
        let x = vec![x];
        Some(form("(current (@))", x, want, Some(want.clock.clone())))
    }

    /// Returns a clock sampled from another by one flow.
    fn slower(&mut self, scope: &Scope, clock: &Clock) -> Option<Clock> {
        let decider = self.decider(scope, clock)?;
        let samplings = samplings(&decider);
        Some(then(clock, self.random.pick(&samplings[..]).as_str()))
    }

    /// Returns an expression that is always present, made from one that may be absent.
    fn present(&mut self, scope: &Scope, want: &Requirement, depth: usize) -> Option<Expr> {
        if self.lustre {
            return None;
        }
        let kind = if want.kind == Kind::Bool {
            Kind::Int
        } else {
            want.kind
        };
        let outside = scope
            .outside
            .iter()
            .filter(|id| self.flows[**id].kind == kind);
        let outside: Vec<FlowId> = outside.copied().collect();
        let x = match outside.is_empty() || self.random.one_in(2) {
            true => self.maybe(scope, kind, depth),
            false => {
                let flow = *self.random.pick(&outside);
                self.read(flow)
            }
        };
        if want.kind == Kind::Bool {
            return Some(form("present(@)", vec![x], want, None));
        }
        let rest = self.expr(scope, want, depth);
        // `hold` has its own first cycle, that of the body.
        if want.clock.is_empty() && self.random.one_in(2) {
            return Some(form("hold(@, @)", vec![x, rest], want, Some([].into())));
        }
        Some(form("(@ ?? @)", vec![x, rest], want, None))
    }

    /// Returns an expression that may be absent, in all cycles or on any clock.
    fn maybe(&mut self, scope: &Scope, kind: Kind, depth: usize) -> Expr {
        let sampled = scope.known.iter().filter(|id| {
            let flow = &self.flows[**id];
            flow.kind == kind && (flow.optional || !flow.clock.is_empty())
        });
        let sampled: Vec<FlowId> = sampled.copied().collect();
        if !sampled.is_empty() && self.random.one_in(2) {
            let flow = *self.random.pick(&sampled);
            return self.read(flow);
        }
        let clocks = self.clocks(scope);
        let clock = self.random.pick(&clocks).clone();
        let want = Requirement {
            kind,
            clock,
            optional: true,
        };
        self.expr(scope, &want, depth)
    }

    /// Returns an expression that may be absent at ticks of its clock.
    fn absent(&mut self, scope: &Scope, want: &Requirement, depth: usize) -> Option<Expr> {
        let total = |kind| Requirement {
            kind,
            optional: false,
            ..want.clone()
        };
        if self.lustre {
            return None;
        }
        match self.random.below(3) {
            0 => {
                let condition = self.expr(scope, &total(Kind::Bool), depth);
                let value = self.expr(scope, want, depth);
                let clock = common(
                    [&condition, &value]
                        .map(|part| part.clock.clone())
                        .into_iter(),
                );
                Some(form(
                    "(if @ then @ else none)",
                    vec![condition, value],
                    want,
                    clock,
                ))
            }
            1 if matches!(want.kind, Kind::Int | Kind::Bool) => {
                let text = if want.kind == Kind::Int {
                    "((@ + @) mod 1000)"
                } else {
                    "(@ xor @)"
                };
                let [a, b] = [0, 1].map(|_| self.maybe(scope, want.kind, depth));
                let clock = common([&a, &b].map(|part| part.clock.clone()).into_iter());
                // On another clock than the wanted one it would mix clocks in a delay, which is an error.
                if clock.as_ref().is_some_and(|clock| *clock != want.clock) {
                    return None;
                }
                Some(form(text, vec![a, b], want, clock))
            }
            _ => self.current(scope, want, depth),
        }
    }
}
