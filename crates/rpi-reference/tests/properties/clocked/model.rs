//! A program with clocks as a model: enough to write it in several ways that mean the same.

use std::rc::Rc;

/// A type without presence.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Kind {
    Bool,
    Int,
    Pair,
    Row,
    Mode,
}

/// What a flow is sampled by, one after the other, as a program writes it (`c`, `not c`, `Slow(m)`). A sampling that has
/// no name at the place begins with `?`.
pub(crate) type Clock = Rc<[String]>;

/// Index of a flow in [`Model::flows`].
pub(crate) type FlowId = usize;

/// How a flow is declared.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Declared {
    /// Not at all.
    Not,
    /// By its type and clock.
    Exact,
    /// `T?`
    Optional,
}

/// A flow.
#[derive(Clone, Debug)]
pub(crate) struct Flow {
    /// As a program writes it; parts of others have their path.
    pub(crate) name: String,
    pub(crate) kind: Kind,
    pub(crate) clock: Clock,
    /// Whether its readers take it for one that may be absent.
    pub(crate) optional: bool,
    pub(crate) declared: Declared,
    /// Whether its declaration may change.
    pub(crate) is_free: bool,
    /// Whether something ticks by it, or it is seen from outside: then it keeps its name and equation.
    pub(crate) is_fixed: bool,
}

/// An expression.
#[derive(Clone, Debug)]
pub(crate) struct Expr {
    pub(crate) node: Node,
    pub(crate) kind: Kind,
    pub(crate) optional: bool,
    /// The clock that its parts give it, if they give it one.
    pub(crate) clock: Option<Clock>,
}

/// What an expression is.
#[derive(Clone, Debug)]
pub(crate) enum Node {
    Flow(FlowId),
    /// A text in which `@` stands for a part.
    Form(Rc<str>, Vec<Expr>),
}

/// A statement.
#[derive(Clone, Debug)]
pub(crate) enum Statement {
    /// Flows and what defines them: one flow, or the results of a call.
    Equation(Equation),
    /// `fragment F when c let ... tel`
    Fragment {
        name: String,
        when: Expr,
        restart: bool,
        body: Body,
    },
    /// `automaton state A let ... tel until c then B; ... end`; the first state is initial.
    Automaton(Vec<State>),
}

/// `x = e`
#[derive(Clone, Debug)]
pub(crate) struct Equation {
    pub(crate) targets: Vec<FlowId>,
    pub(crate) value: Expr,
    pub(crate) bound: Bound,
}

/// How an equation gives its value to its flows.
#[derive(Clone, Debug)]
pub(crate) enum Bound {
    /// `x = e`, `(x, y) = e`
    Names,
    /// `r = e`, the flows are `r.x`, `r.y`.
    Whole(String),
}

/// A state.
#[derive(Clone, Debug)]
pub(crate) struct State {
    pub(crate) name: String,
    pub(crate) body: Body,
    /// Conditions, `then` or `continue`, and targets.
    pub(crate) unless: Vec<(Expr, &'static str, String)>,
    pub(crate) until: Vec<(Expr, &'static str, String)>,
}

/// What stands in a node, fragment or state.
#[derive(Clone, Default, Debug)]
pub(crate) struct Body {
    /// Flows that it may declare.
    pub(crate) locals: Vec<FlowId>,
    pub(crate) statements: Vec<Statement>,
}

/// A node.
#[derive(Clone, Debug)]
pub(crate) struct Unit {
    pub(crate) name: String,
    pub(crate) inputs: Vec<FlowId>,
    pub(crate) outputs: Vec<FlowId>,
    pub(crate) body: Body,
}

/// A program: called nodes, then `main`.
#[derive(Clone, Debug)]
pub(crate) struct Model {
    pub(crate) lustre: bool,
    pub(crate) flows: Vec<Flow>,
    pub(crate) units: Vec<Unit>,
}

impl Kind {
    pub(crate) fn text(self) -> &'static str {
        match self {
            Kind::Bool => "bool",
            Kind::Int => "int",
            Kind::Pair => "Pair",
            Kind::Row => "int^2",
            Kind::Mode => "Mode",
        }
    }

    pub(crate) fn literal(self) -> &'static str {
        match self {
            Kind::Bool => "false",
            Kind::Int => "1",
            Kind::Pair => "Pair{u = 1; v = 1}",
            Kind::Row => "[1, 1]",
            Kind::Mode => "Off",
        }
    }
}

impl Expr {
    /// Calls `visit` with all flows that it reads.
    pub(crate) fn flows(&self, visit: &mut impl FnMut(FlowId)) {
        match &self.node {
            Node::Flow(flow) => visit(*flow),
            Node::Form(_, parts) => parts.iter().for_each(|part| part.flows(visit)),
        }
    }

    /// Calls `change` with all parts, the innermost first.
    pub(crate) fn each_mut(&mut self, change: &mut impl FnMut(&mut Expr)) {
        if let Node::Form(_, parts) = &mut self.node {
            parts.iter_mut().for_each(|part| part.each_mut(change));
        }
        change(self);
    }

    pub(crate) fn size(&self) -> usize {
        match &self.node {
            Node::Flow(_) => 1,
            Node::Form(_, parts) => 1 + parts.iter().map(Expr::size).sum::<usize>(),
        }
    }

    /// Whether it gives its clock to all that reads it, and all of that can be written elsewhere in its body.
    pub(crate) fn is_anchored(&self, clock: &Clock) -> bool {
        self.clock.as_ref() == Some(clock)
    }
}

impl Statement {
    /// Calls `change` with the expressions that stand in the same body as it.
    pub(crate) fn own_exprs_mut(&mut self, change: &mut impl FnMut(&mut Expr)) {
        match self {
            Statement::Equation(equation) => change(&mut equation.value),
            Statement::Fragment { when, .. } => change(when),
            Statement::Automaton(states) => {
                let unless = states.iter_mut().flat_map(|state| &mut state.unless);
                unless.for_each(|(condition, ..)| change(condition));
            }
        }
    }

    /// The bodies in it.
    pub(crate) fn bodies_mut(&mut self) -> Vec<&mut Body> {
        match self {
            Statement::Equation(_) => Vec::new(),
            Statement::Fragment { body, .. } => vec![body],
            Statement::Automaton(states) => states.iter_mut().map(|s| &mut s.body).collect(),
        }
    }
}

impl Body {
    /// Calls `change` with this body and those in it.
    pub(crate) fn each_body(&mut self, change: &mut impl FnMut(&mut Body)) {
        for statement in &mut self.statements {
            for body in statement.bodies_mut() {
                body.each_body(change);
            }
        }
        change(self);
    }

    /// Calls `change` with all expressions in it and in the bodies in it, each as a whole.
    pub(crate) fn each_expr(&mut self, change: &mut impl FnMut(&mut Expr)) {
        for statement in &mut self.statements {
            statement.own_exprs_mut(change);
            if let Statement::Automaton(states) = statement {
                for (condition, ..) in states.iter_mut().flat_map(|state| &mut state.until) {
                    change(condition);
                }
            }
            for body in statement.bodies_mut() {
                body.each_expr(change);
            }
        }
    }
}
