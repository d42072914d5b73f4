//! Visitor of a whole declaration, for analyses that need only some kinds of nodes.

use super::children::path_exprs;
use super::{
    Automaton, Body, Callee, Claim, Clock, ClockValue, CommandDecl, ConditionalBlock, ConstDef,
    Contract, DeviceDecl, Equation, Expr, ExprKind, FragmentDecl, Item, ItemKind, Locals, Name,
    NamedType, NodeDecl, NodeDef, Run, Signature, Statement, StatementKind, StaticArg, StaticParam,
    StaticParamKind, StaticValue, Step, StepKind, TaskDecl, TestDecl, Type, TypeKind, Unit,
    VarDecl,
};

/// Visitor of the parts of a declaration, called by [`Walker`]. By default, its methods ignore the parts.
pub trait Visitor<'a> {
    /// Returns whether expressions are visited. Visiting expressions takes most of the time of a traversal.
    fn visits_expressions(&self) -> bool {
        true
    }

    /// Visits a use of a name. Declarations of names and whole flows on the left side of equations are not visited. A
    /// name may be visited repeatedly.
    fn visit_name(&mut self, _: &'a Name) {}

    /// Visits an expression that is evaluated at run time, before its subexpressions.
    fn visit_flow(&mut self, _: &'a Expr) {}

    /// Visits a local fragment, before its contents.
    fn visit_fragment(&mut self, _: &'a FragmentDecl) {}

    /// Visits an automaton, before its contents.
    fn visit_automaton(&mut self, _: &'a Automaton) {}

    /// Visits a statement of a body, before its contents.
    fn visit_statement(&mut self, _: &'a Statement) {}

    /// Visits a step of a task, before its contents.
    fn visit_step(&mut self, _: &'a Step) {}
}

/// Traversal of declarations that calls a visitor.
pub struct Walker<'w, 'a> {
    visitor: &'w mut dyn Visitor<'a>,
}

impl<'a> Walker<'_, 'a> {
    /// Creates a traversal that calls `visitor`.
    pub fn new<'w>(visitor: &'w mut dyn Visitor<'a>) -> Walker<'w, 'a> {
        Walker { visitor }
    }

    /// Visits the parts of a declaration. Imports, includes, constants, types, primitives and frames have no statements
    /// and are left out.
    pub fn item(&mut self, item: &'a Item) {
        match &item.kind {
            ItemKind::Node(node) => self.node(node),
            ItemKind::Fragment(fragment) => self.fragment(fragment),
            ItemKind::Device(device) => self.device(device),
            ItemKind::Command(command) => self.command(command),
            ItemKind::Task(task) => self.task(task),
            ItemKind::Test(test) => self.test(test),
            _ => {}
        }
    }

    /// Visits the parts of a node or function.
    pub fn node(&mut self, node: &'a NodeDecl) {
        self.signature(&node.signature);
        self.contract(node.contract.as_ref());
        match &node.definition {
            NodeDef::Body(body) => self.body(body),
            NodeDef::Alias(callee) => self.callee(callee),
            NodeDef::Extern => {}
        }
    }

    /// Visits the parts of a fragment, at top level or local.
    pub fn fragment(&mut self, fragment: &'a FragmentDecl) {
        self.signature(&fragment.signature);
        let when = fragment.when.iter().map(|when| &when.condition);
        self.exprs(when);
        self.static_exprs(&fragment.budget);
        self.contract(fragment.contract.as_ref());
        self.body(&fragment.body);
    }

    /// Visits the parts of a device type.
    pub fn device(&mut self, device: &'a DeviceDecl) {
        self.statics(&device.statics);
        let ports = device.sections.iter().flat_map(|section| &section.ports);
        ports.for_each(|port| self.vars(&port.alternatives));
    }

    /// Visits the parts of a command.
    pub fn command(&mut self, command: &'a CommandDecl) {
        self.statics(&command.statics);
        self.vars(&command.params);
        self.vars(&command.given);
        self.static_exprs(&command.budget);
        self.contract(command.contract.as_ref());
        self.body(&command.body);
    }

    /// Visits the parts of a task.
    pub fn task(&mut self, task: &'a TaskDecl) {
        self.statics(&task.statics);
        self.vars(&task.params);
        self.steps(&task.steps);
    }

    /// Visits the parts of a test.
    pub fn test(&mut self, test: &'a TestDecl) {
        self.body(&test.body);
    }

    fn signature(&mut self, signature: &'a Signature) {
        self.statics(&signature.statics);
        let ports = [&signature.inputs, &signature.outputs];
        ports
            .into_iter()
            .flatten()
            .for_each(|ports| self.vars(ports));
    }

    fn statics(&mut self, params: &'a [StaticParam]) {
        for param in params {
            match &param.kind {
                StaticParamKind::Type(..) => {}
                StaticParamKind::Value(def) => self.constant(def),
                StaticParamKind::Node(_, signature) => self.signature(signature),
            }
        }
    }

    fn vars(&mut self, vars: &'a [VarDecl]) {
        for var in vars {
            self.ty(&var.ty);
            var.clock.iter().for_each(|clock| self.clock(clock));
            self.static_exprs(&var.default);
        }
    }

    fn constant(&mut self, def: &'a ConstDef) {
        def.ty.iter().for_each(|ty| self.ty(ty));
        self.static_exprs(&def.value);
    }

    fn locals(&mut self, all: &'a [Locals]) {
        for section in all {
            match section {
                Locals::Var(vars) => self.vars(vars),
                Locals::Const(defs) => defs.iter().for_each(|def| self.constant(def)),
            }
        }
    }

    fn contract(&mut self, contract: Option<&'a Contract>) {
        let Some(contract) = contract else { return };
        self.locals(&contract.locals);
        for together in &contract.ghost_tuples {
            self.vars(&together.vars);
            self.expr(&together.equation.value);
        }
        let modes = contract.modes.iter();
        let of_modes = modes.flat_map(|mode| mode.requires.iter().chain(&mode.ensures));
        let claims = contract.claims.iter().chain(of_modes);
        claims.for_each(|claim| self.claim(claim));
        self.exprs(contract.imports.iter().map(|import| &import.call));
    }

    fn claim(&mut self, claim: &'a Claim) {
        self.exprs([&claim.condition].into_iter().chain(&claim.provided));
    }

    fn body(&mut self, body: &'a Body) {
        self.locals(&body.locals);
        self.statements(&body.statements);
    }

    fn statements(&mut self, statements: &'a [Statement]) {
        for statement in statements {
            self.visitor.visit_statement(statement);
            self.statement(&statement.kind);
        }
    }

    fn statement(&mut self, statement: &'a StatementKind) {
        match statement {
            StatementKind::Equation(equation) => self.equation(equation),
            StatementKind::Call(call) => self.expr(call),
            StatementKind::Claim(claim) => self.claim(claim),
            StatementKind::CommandEnd(end) => self.expr(&end.condition),
            StatementKind::Export(flows) => flows
                .iter()
                .filter_map(|flow| flow.parts.first())
                .for_each(|first| self.visitor.visit_name(&first.name)),
            StatementKind::Fragment(fragment) => {
                self.visitor.visit_fragment(fragment);
                self.fragment(fragment);
            }
            StatementKind::Automaton(automaton) => self.automaton(automaton),
            StatementKind::Conditional(choice) => self.conditional(choice),
            StatementKind::FrameBlock(keep) => {
                self.statements(&keep.initial);
                self.statements(&keep.statements);
            }
            StatementKind::Error(_) => {}
        }
    }

    /// Visits the conditions of a conditional block, then the statements of its branches.
    fn conditional(&mut self, choice: &'a ConditionalBlock) {
        let branches = choice.branches.iter();
        self.exprs(branches.clone().map(|branch| &branch.condition));
        let branches = branches.map(|branch| &branch.statements);
        let all = branches.chain(&choice.else_statements);
        all.for_each(|statements| self.statements(statements));
    }

    fn equation(&mut self, equation: &'a Equation) {
        for target in equation.targets.iter().filter(|t| !t.path.is_empty()) {
            self.visitor.visit_name(&target.name.name);
            self.exprs(path_exprs(&target.path));
        }
        self.expr(&equation.value);
    }

    fn automaton(&mut self, automaton: &'a Automaton) {
        self.visitor.visit_automaton(automaton);
        for state in &automaton.states {
            let transitions = state.unless.iter().chain(&state.until);
            self.exprs(transitions.filter_map(|transition| transition.condition.as_ref()));
            self.body(&state.body);
        }
    }

    fn steps(&mut self, steps: &'a [Step]) {
        for step in steps {
            self.visitor.visit_step(step);
            match &step.kind {
                StepKind::Run(run) => self.run(run),
                StepKind::Repeat { count, steps } => {
                    self.exprs(count);
                    self.steps(steps);
                }
                StepKind::Parallel(strands) => {
                    strands.iter().for_each(|strand| self.steps(&strand.steps));
                }
                StepKind::Start(_) | StepKind::Error(_) => {}
            }
        }
    }

    fn run(&mut self, run: &'a Run) {
        self.callee(&run.callee);
        self.exprs(run.args.iter().map(|arg| &arg.value));
    }

    fn exprs(&mut self, exprs: impl IntoIterator<Item = &'a Expr>) {
        exprs.into_iter().for_each(|expr| self.expr(expr));
    }

    /// Visits an expression that is evaluated at run time, and its subexpressions.
    fn expr(&mut self, expr: &'a Expr) {
        self.expr_tree(expr, true);
    }

    /// Visits expressions that are evaluated at compile time, such as array sizes.
    fn static_exprs(&mut self, exprs: impl IntoIterator<Item = &'a Expr>) {
        exprs
            .into_iter()
            .for_each(|expr| self.expr_tree(expr, false));
    }

    /// Visits an expression and its subexpressions; `runs` is true if the expression is evaluated at run time. Uses a
    /// stack instead of recursion, as expressions may be nested deeply.
    fn expr_tree(&mut self, expr: &'a Expr, runs: bool) {
        if !self.visitor.visits_expressions() {
            return;
        }
        let mut open = vec![expr];
        while let Some(expr) = open.pop() {
            if runs {
                self.visitor.visit_flow(expr);
            }
            self.own_names(expr);
            open.extend(expr.children());
        }
    }

    /// Visits the names in an expression itself, such as those of its clock, unit or callee, without those in its
    /// subexpressions.
    fn own_names(&mut self, expr: &'a Expr) {
        match &expr.kind {
            ExprKind::Name(name) => self.visitor.visit_name(name),
            ExprKind::Quantity(quantity) => self.unit(&quantity.unit),
            ExprKind::When(when) => self.clock(&when.clock),
            ExprKind::Call(call) => self.callee(&call.callee),
            ExprKind::Struct(of) => {
                self.visitor.visit_name(&of.ty.name);
                self.static_args(&of.statics);
            }
            ExprKind::Quantified(of) => self.vars(&of.vars),
            ExprKind::Ascription(of) => self.ty(&of.ty),
            ExprKind::EmptySet(types) => self.static_args(types),
            _ => {}
        }
    }

    fn callee(&mut self, callee: &'a Callee) {
        self.visitor.visit_name(&callee.name.name);
        self.static_args(&callee.statics);
    }

    fn static_args(&mut self, args: &'a [StaticArg]) {
        for arg in args {
            match &arg.value {
                StaticValue::Expr(expr) => self.static_exprs([expr]),
                StaticValue::Type(ty) => self.ty(ty),
                StaticValue::Op(_) => {}
                StaticValue::Callee(callee) => self.callee(callee),
            }
        }
    }

    fn clock(&mut self, clock: &'a Clock) {
        self.visitor.visit_name(&clock.flow.name);
        if let ClockValue::Value(value) = &clock.value {
            self.visitor.visit_name(&value.name);
        }
    }

    fn unit(&mut self, unit: &'a Unit) {
        for factor in &unit.factors {
            self.visitor.visit_name(&factor.unit.name);
        }
    }

    fn ty(&mut self, ty: &'a Type) {
        match &ty.kind {
            TypeKind::Bool | TypeKind::Int | TypeKind::Real(None) | TypeKind::Error => {}
            TypeKind::Real(Some(unit)) => self.unit(unit),
            TypeKind::Named(named) => self.named(named),
            TypeKind::Array(array) => {
                self.ty(&array.element);
                self.static_exprs([&array.size]);
            }
            TypeKind::Optional(inner) => self.ty(inner),
            TypeKind::Subrange(range) => self.static_exprs(range.lower.iter().chain(&range.upper)),
            TypeKind::Tuple(types) => types.iter().for_each(|ty| self.ty(ty)),
            TypeKind::Refinement(refined) => {
                self.ty(&refined.base);
                self.static_exprs([&refined.condition]);
            }
            TypeKind::Datatype(all) => all.iter().for_each(|one| self.vars(&one.fields)),
            TypeKind::Enum(_) => {}
            TypeKind::Struct(fields) => self.vars(fields),
        }
    }

    fn named(&mut self, named: &'a NamedType) {
        self.visitor.visit_name(&named.name.name);
        self.static_args(&named.statics);
        let frames = named.frames.iter();
        let frames = frames.flat_map(|frames| frames.located.iter().chain([&frames.reference]));
        let first = frames.filter_map(|frame| frame.parts.first());
        first.for_each(|name| self.visitor.visit_name(&name.name));
    }
}
