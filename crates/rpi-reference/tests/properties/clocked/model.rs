//! Data model of a program with clocks, from which equivalent variants can be written.

use std::rc::Rc;

/// Type without presence.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Kind {
    Bool,
    Int,
    Pair,
    Row,
    Mode,
}

/// Clock: the sampling conditions in order, as written in a program (`c`, `not c`, `Slow(m)`). A condition that has no
/// name at the location begins with `?`.
pub(crate) type Clock = Rc<[String]>;

/// Index of a flow in [`Model::flows`].
pub(crate) type FlowId = usize;

/// Form of the declaration of a flow.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Declared {
    /// Not declared.
    Not,
    /// With its type and clock.
    Exact,
    /// As `T?`.
    Optional,
}

/// Flow.
#[derive(Clone, Debug)]
pub(crate) struct Flow {
    /// Name as written in a program; members include their path.
    pub(crate) name: String,
    pub(crate) kind: Kind,
    pub(crate) clock: Clock,
    /// Whether readers must treat it as possibly absent.
    pub(crate) optional: bool,
    pub(crate) declared: Declared,
    /// Whether its declaration may be changed.
    pub(crate) is_free: bool,
    /// Whether it is used as a clock or from outside, so that its name and equation must be kept.
    pub(crate) is_fixed: bool,
}

/// Expression.
#[derive(Clone, Debug)]
pub(crate) struct Expr {
    pub(crate) node: Node,
    pub(crate) kind: Kind,
    pub(crate) optional: bool,
    /// Clock given by the parts, if any.
    pub(crate) clock: Option<Clock>,
}

/// Form of an expression.
#[derive(Clone, Debug)]
pub(crate) enum Node {
    Flow(FlowId),
    /// Text in which each `@` stands for a part.
    Template(Rc<str>, Vec<Expr>),
}

/// Statement.
#[derive(Clone, Debug)]
pub(crate) enum Statement {
    /// Flows and their definition: one flow, or the results of a call.
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

/// Binding of the value of an equation to its flows.
#[derive(Clone, Debug)]
pub(crate) enum Bound {
    /// `x = e`, `(x, y) = e`
    Names,
    /// `r = e`; the flows are `r.x`, `r.y`.
    Whole(String),
}

/// State of an automaton.
#[derive(Clone, Debug)]
pub(crate) struct State {
    pub(crate) name: String,
    pub(crate) body: Body,
    /// Condition, `then` or `continue`, and target of each transition.
    pub(crate) unless: Vec<(Expr, &'static str, String)>,
    pub(crate) until: Vec<(Expr, &'static str, String)>,
}

/// Content of a node, fragment or state.
#[derive(Clone, Default, Debug)]
pub(crate) struct Body {
    /// Flows that it may declare.
    pub(crate) locals: Vec<FlowId>,
    pub(crate) statements: Vec<Statement>,
}

/// Node.
#[derive(Clone, Debug)]
pub(crate) struct Unit {
    pub(crate) name: String,
    pub(crate) inputs: Vec<FlowId>,
    pub(crate) outputs: Vec<FlowId>,
    pub(crate) body: Body,
}

/// Program: called nodes, then `main`.
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
    /// Calls `visit` with all flows that the expression reads.
    pub(crate) fn flows(&self, visit: &mut impl FnMut(FlowId)) {
        match &self.node {
            Node::Flow(flow) => visit(*flow),
            Node::Template(_, parts) => parts.iter().for_each(|part| part.flows(visit)),
        }
    }

    /// Calls `change` with all parts, the innermost first.
    pub(crate) fn each_mut(&mut self, change: &mut impl FnMut(&mut Expr)) {
        if let Node::Template(_, parts) = &mut self.node {
            parts.iter_mut().for_each(|part| part.each_mut(change));
        }
        change(self);
    }

    pub(crate) fn size(&self) -> usize {
        match &self.node {
            Node::Flow(_) => 1,
            Node::Template(_, parts) => 1 + parts.iter().map(Expr::size).sum::<usize>(),
        }
    }

    /// Returns whether the expression itself determines the given clock, so that it does not depend on its reader.
    pub(crate) fn is_anchored(&self, clock: &Clock) -> bool {
        self.clock.as_ref() == Some(clock)
    }
}

impl Statement {
    /// Calls `change` with the expressions of the statement that belong to the enclosing body.
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

    /// Returns the nested bodies.
    pub(crate) fn bodies_mut(&mut self) -> Vec<&mut Body> {
        match self {
            Statement::Equation(_) => Vec::new(),
            Statement::Fragment { body, .. } => vec![body],
            Statement::Automaton(states) => states.iter_mut().map(|s| &mut s.body).collect(),
        }
    }
}

impl Body {
    /// Calls `change` with this body and all nested bodies.
    pub(crate) fn each_body(&mut self, change: &mut impl FnMut(&mut Body)) {
        for statement in &mut self.statements {
            for body in statement.bodies_mut() {
                body.each_body(change);
            }
        }
        change(self);
    }

    /// Calls `change` with all whole expressions of this body and of all nested bodies.
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
