//! Random programs with clocks: flows that are sampled by one another, in nodes, fragments and states.

use std::rc::Rc;

use super::exprs::{Decider, Exprs, Requirement, Scope};
use super::model::{
    Body, Bound, Clock, Declared, Equation, Expr, Flow, FlowId, Kind, Model, Statement, Unit,
};
use crate::random::Random;

/// Generates the program of a seed.
pub(crate) fn model(seed: u64, lustre: bool) -> Model {
    let mut random = Random::new(seed);
    let mut maker = ClockedGenerator {
        random: &mut random,
        lustre,
        flows: Vec::new(),
        units: Vec::new(),
        serial: 0,
    };
    for k in 0..maker.random.below(3) {
        let unit = maker.called(k);
        maker.units.push(unit);
    }
    let main = maker.main();
    maker.units.push(main);
    Model {
        lustre,
        flows: maker.flows,
        units: maker.units,
    }
}

pub(crate) struct ClockedGenerator<'r> {
    pub(crate) random: &'r mut Random,
    pub(crate) lustre: bool,
    pub(crate) flows: Vec<Flow>,
    pub(crate) units: Vec<Unit>,
    serial: usize,
}

pub(crate) fn base() -> Clock {
    Rc::new([])
}

impl ClockedGenerator<'_> {
    pub(crate) fn exprs(&mut self) -> Exprs<'_> {
        Exprs {
            random: self.random,
            flows: &mut self.flows,
            lustre: self.lustre,
        }
    }

    pub(crate) fn name(&mut self, start: &str) -> String {
        self.serial += 1;
        format!("{start}{}", self.serial)
    }

    pub(crate) fn flow(&mut self, name: String, kind: Kind, clock: Clock) -> FlowId {
        self.flows.push(Flow {
            name,
            kind,
            clock,
            optional: false,
            declared: Declared::Exact,
            is_free: false,
            is_fixed: true,
        });
        self.flows.len() - 1
    }

    /// Adds in-ports, and returns the scope in which they can be used as clocks.
    fn inputs(&mut self, ports: &[(&str, Kind)]) -> (Vec<FlowId>, Scope) {
        let mut scope = Scope::default();
        for (start, kind) in ports {
            let name = self.name(start);
            let flow = self.flow(name, *kind, base());
            self.decides(flow, &mut scope);
            scope.known.push(flow);
        }
        (scope.known.clone(), scope)
    }

    /// Allows a flow to be used as a clock from here on.
    fn decides(&mut self, flow: FlowId, scope: &mut Scope) {
        let flow = &mut self.flows[flow];
        if matches!(flow.kind, Kind::Bool | Kind::Mode) && !flow.optional {
            flow.is_fixed = true;
            scope.deciders.push(Decider {
                name: flow.name.clone(),
                kind: flow.kind,
                clock: flow.clock.clone(),
            });
        }
    }

    /// Generates a called node: `a` is sampled by its first in-port, `e` by a local flow.
    fn called(&mut self, k: usize) -> Unit {
        let (mut inputs, mut scope) = self.inputs(&[("c", Kind::Bool), ("x", Kind::Int)]);
        let on: Clock = Rc::new([self.flows[inputs[0]].name.clone()]);
        if self.random.one_in(2) {
            let name = self.name("w");
            let slow = self.flow(name, Kind::Int, on.clone());
            inputs.push(slow);
            scope.known.push(slow);
        }
        let mut outputs = Vec::new();
        for (start, clock) in [("a", on), ("b", base())] {
            let name = self.name(start);
            outputs.push(self.flow(name, Kind::Int, clock));
        }
        if !self.lustre && self.random.one_in(2) {
            let name = self.name("e");
            outputs.push(self.flow(name, Kind::Int, base()));
        }
        let body = self.body(scope, &outputs, 0, 3);
        Unit {
            name: format!("Sub{k}"),
            inputs,
            outputs,
            body,
        }
    }

    fn main(&mut self) -> Unit {
        let ports = [
            ("c", Kind::Bool),
            ("d", Kind::Bool),
            ("m", Kind::Mode),
            ("x", Kind::Int),
            ("z", Kind::Int),
        ];
        let (inputs, scope) = self.inputs(&ports);
        let clocks = self.exprs().clocks(&scope);
        let mut outputs = Vec::new();
        for _ in 0..2 + self.random.below(3) {
            let (name, kind) = (self.name("y"), self.kind());
            let clock = self.random.pick(&clocks).clone();
            let clock = if self.lustre || self.random.one_in(2) {
                clock
            } else {
                base()
            };
            outputs.push(self.flow(name, kind, clock));
        }
        let nesting = if self.lustre { 0 } else { 2 };
        let body = self.body(scope, &outputs, nesting, 6);
        Unit {
            name: "main".to_owned(),
            inputs,
            outputs,
            body,
        }
    }

    pub(crate) fn kind(&mut self) -> Kind {
        let kinds = [
            Kind::Bool,
            Kind::Bool,
            Kind::Int,
            Kind::Int,
            Kind::Int,
            Kind::Pair,
            Kind::Row,
            Kind::Mode,
        ];
        *self.random.pick(&kinds)
    }

    /// Adds a local flow with any clock available so far. More flows provide more clocks for others.
    fn local(&mut self, clocks: &mut Scope) -> FlowId {
        let all = self.exprs().clocks(clocks);
        let (name, kind) = (self.name("v"), self.kind());
        let clock = match self.random.one_in(3) {
            true => base(),
            false => self.random.pick(&all).clone(),
        };
        let flow = self.flow(name, kind, clock);
        self.flows[flow].is_fixed = false;
        if self.random.one_in(2) {
            self.decides(flow, clocks);
        } else if !self.lustre {
            self.flows[flow].optional = self.random.one_in(3);
        }
        self.flows[flow].is_free = !self.lustre;
        self.flows[flow].declared = self.declaration(flow);
        flow
    }

    /// Returns a random way to declare a flow.
    fn declaration(&mut self, flow: FlowId) -> Declared {
        let may_be_optional = self.flows[flow].optional;
        match self.random.below(3) {
            _ if self.lustre => Declared::Exact,
            0 => Declared::Not,
            1 if may_be_optional => Declared::Optional,
            _ => Declared::Exact,
        }
    }

    /// Generates equations for the required flows and for some local ones.
    pub(crate) fn body(
        &mut self,
        outer: Scope,
        wanted: &[FlowId],
        nesting: usize,
        most: usize,
    ) -> Body {
        let mut clocks = Scope {
            deciders: outer.deciders.clone(),
            ..Scope::default()
        };
        let count = 1 + self.random.below(most);
        let locals: Vec<FlowId> = (0..count).map(|_| self.local(&mut clocks)).collect();
        let mut outputs = wanted.to_vec();
        for flow in wanted {
            // An out-port `T?` may have any clock.
            if !self.lustre
                && self.flows[*flow].clock.is_empty()
                && self.flows[*flow].name.starts_with(['y', 'e'])
                && self.random.one_in(2)
            {
                let all = self.exprs().clocks(&clocks);
                self.flows[*flow].clock = self.random.pick(&all).clone();
                self.flows[*flow].optional = true;
                self.flows[*flow].declared = Declared::Optional;
            }
        }
        let mut scope = outer;
        scope.delayed = [&scope.known[..], &locals, wanted].concat();
        let mut body = Body {
            locals: locals.clone(),
            statements: Vec::new(),
        };
        let own = scope.deciders.len();
        scope.deciders.truncate(own);
        for flow in locals.into_iter().chain(outputs.drain(..)) {
            if self.random.one_in(4) {
                let statement = self.statement(&mut scope, &mut body, nesting);
                body.statements.extend(statement);
            }
            let value = self.value(&scope, flow);
            body.statements.push(equation(flow, value));
            scope.known.push(flow);
            let name = &self.flows[flow].name;
            scope.deciders.extend(
                clocks
                    .deciders
                    .iter()
                    .filter(|one| one.name == *name)
                    .cloned(),
            );
        }
        body
    }

    /// Returns the definition of a flow, which determines its clock.
    fn value(&mut self, scope: &Scope, flow: FlowId) -> Expr {
        let Flow {
            kind,
            clock,
            optional,
            ..
        } = self.flows[flow].clone();
        let want = Requirement {
            kind,
            clock,
            optional,
        };
        for _ in 0..4 {
            let made = self.exprs().expr(scope, &want, 3);
            if made.is_anchored(&want.clock) || want.clock.is_empty() {
                return made;
            }
        }
        self.exprs().leaf(
            scope,
            &Requirement {
                optional: false,
                ..want
            },
        )
    }
}

fn equation(flow: FlowId, value: Expr) -> Statement {
    Statement::Equation(Equation {
        targets: vec![flow],
        value,
        bound: Bound::Names,
    })
}
