//! Statements of a body: all are declared first, so that their order does not matter, then checked.

use super::body::Body;
use super::locals::Local;
use super::order::{Goal, Pending, State};
use super::report::Wanted;
use super::types::PortTy;
use crate::program::DeclKind;
use crate::ty::{Subst, Ty, fit};
use crate::typed::{self, BlockId, End, Equation, ExprId, FlowId, FlowRole, Optional};
use rpi_diag::{Code, Finding, Span};
use rpi_syntax::Mode;
use rpi_syntax::ast::{self, FragmentDecl, Ident, Locals, Statement, StatementKind, VarDecl};
use smallvec::SmallVec;

/// A statement that is checked when the types of all flows are known.
pub(super) enum Later<'a> {
    /// Call without a target.
    Call(&'a ast::Expr),
    /// Condition that is claimed to hold.
    Claim(&'a ast::Claim, Span),
    /// Contract, in its own block.
    Contract(&'a ast::Contract),
    /// End of the command.
    End(&'a ast::End, Span),
    /// Exported flow.
    Export(&'a ast::Dotted),
    /// Activation condition and time budget of a fragment's block.
    Activation(BlockId, &'a FragmentDecl),
    /// Transitions of an automaton.
    Automaton(usize, &'a ast::Automaton),
}

impl<'a> Body<'_, 'a> {
    /// Declares and checks all statements of a body.
    pub(super) fn check_body(&mut self, body: &'a ast::Body) {
        let mut later = Vec::new();
        self.declare_body(body, &mut later);
        self.elements_in_order();
        self.check_equations();
        for (block, item) in later {
            self.within(block, |body| body.check_later(item));
        }
        self.check_definitions();
        self.check_sums();
    }

    /// Checks all declared equations.
    pub(super) fn check_equations(&mut self) {
        self.infer_with_times();
        self.state_clocks();
        self.report_unknown_types();
        for index in 0..self.pending.len() {
            let block = self.pending[index].block;
            self.within(block, |body| body.check_element(index));
        }
    }

    /// Declares the locals and statements of a body in the current block.
    pub(super) fn declare_body(
        &mut self,
        body: &'a ast::Body,
        later: &mut Vec<(BlockId, Later<'a>)>,
    ) {
        self.make_room(body);
        for section in &body.locals {
            match section {
                Locals::Var(vars) => vars.iter().for_each(|var| self.declare_var(var)),
                Locals::Const(defs) => defs.iter().for_each(|def| self.declare_const(def)),
            }
        }
        self.clocks_stated.push((self.block, &body.locals[..]));
        self.count_parts(&body.statements);
        self.declare_defaults(&body.statements);
        for statement in &body.statements {
            self.declare_statement(statement, later);
        }
    }

    /// Declares local flows; `var x: int = e;` also defines `x`.
    pub(super) fn declare_var(&mut self, var: &'a VarDecl) {
        let port = self.port_ty(&var.ty);
        for name in &var.names {
            self.hides_nothing(name);
            let flow = self.declare_flow(name, &port, FlowRole::Local);
            self.notes_seconds(flow, &var.ty);
            if let Some(value) = &var.default {
                self.pending.push(Pending {
                    block: self.block,
                    goal: Goal::Var(flow),
                    value,
                    span: var.span,
                    introduces: SmallVec::from([None]),
                    state: State::Open,
                    indices: Vec::new(),
                });
            }
        }
    }

    pub(super) fn declare_const(&mut self, def: &'a ast::ConstDef) {
        let Some(constant) = self.constant_def(def) else {
            for name in &def.names {
                let nothing = PortTy {
                    ty: Ty::Unknown,
                    optional: false,
                };
                self.declare_flow(name, &nothing, FlowRole::Param);
            }
            return;
        };
        for name in &def.names {
            self.declare(name, Local::Constant(constant.clone()));
        }
    }

    /// Sets the clocks of declared flows after type inference, because equations may introduce the flows that the
    /// clocks refer to.
    fn state_clocks(&mut self) {
        for (block, sections) in std::mem::take(&mut self.clocks_stated) {
            for section in sections {
                if let Locals::Var(vars) = section {
                    self.within(block, |body| body.state_clocks_of(vars));
                }
            }
        }
    }

    /// Sets the clocks that declarations state.
    pub(super) fn state_clocks_of(&mut self, vars: &'a [VarDecl]) {
        for var in vars {
            let Some(clock) = &var.clock else {
                continue;
            };
            let on = self.clock_on(clock);
            for name in &var.names {
                if let (Some(flow), Some(on)) = (self.local_flow(&name.name), on) {
                    self.unit.flows[flow.0 as usize].clock = Some(on);
                }
            }
        }
    }

    fn declare_statement(
        &mut self,
        statement: &'a Statement,
        later: &mut Vec<(BlockId, Later<'a>)>,
    ) {
        let block = self.block;
        match &statement.kind {
            StatementKind::Equation(equation) => self.declare_equation(equation, statement.span),
            StatementKind::Call(call) => later.push((block, Later::Call(call))),
            StatementKind::Claim(claim) => {
                later.push((block, Later::Claim(claim, statement.span)));
            }
            StatementKind::End(end) => later.push((block, Later::End(end, statement.span))),
            StatementKind::Export(flows) => {
                later.extend(flows.iter().map(|flow| (block, Later::Export(flow))));
            }
            StatementKind::Fragment(fragment) => self.declare_fragment(fragment, later),
            StatementKind::Automaton(automaton) => {
                self.declare_automaton(automaton, statement.span, later);
            }
            StatementKind::Choice(choice) => self.declare_meaning(&choice.means),
            StatementKind::Keep(keep) => self.declare_meaning(&keep.means),
            StatementKind::Broken(names) => {
                for name in names {
                    let flow = match self.find_local(&name.name) {
                        None => Some(self.introduce_flow(name)),
                        Some(Local::Flow(flow)) => Some(flow),
                        Some(_) => None,
                    };
                    self.broken.extend(flow);
                }
            }
        }
    }

    pub(super) fn declare_equation(&mut self, equation: &'a ast::Equation, span: Span) {
        if self.defines_elements(equation) {
            return self.declare_elements(equation, span);
        }
        let index = self.pending.len();
        let introduces = equation
            .targets
            .iter()
            .map(|target| self.introduced(target, index));
        let introduces = introduces.collect();
        self.pending.push(Pending {
            block: self.block,
            goal: Goal::Targets(&equation.targets),
            value: &equation.value,
            span,
            introduces,
            state: State::Open,
            indices: Vec::new(),
        });
    }

    /// Returns the flow that a target introduces: a plain name that no surrounding block declares.
    fn introduced(&mut self, target: &ast::Target, index: usize) -> Option<FlowId> {
        self.hides_no_constant(&target.name);
        let may = target.path.is_empty() && self.mode == Mode::Rpi && target.name.name != "_";
        let own = match self.find_in(self.block, &target.name.name) {
            Some(Local::Flow(flow)) => Some(self.defined_here(flow)),
            _ => None,
        };
        let flow = match own {
            Some(flow) if may && self.waits_for_type(flow) => flow,
            _ if !may || self.is_declared(&target.name) => return None,
            _ => self.introduce_flow(&target.name),
        };
        let around = self.shared_around(flow);
        let around: Vec<FlowId> = around.filter(|outer| self.waits_for_type(*outer)).collect();
        for flow in std::iter::once(flow).chain(around) {
            self.defined_by[flow.0 as usize] = Some(index);
        }
        Some(flow)
    }

    /// Reports an equation that seems to define a constant of the same file.
    pub(super) fn hides_no_constant(&mut self, name: &Ident) {
        let Some(id) = self.c.program.own(self.module, &name.name) else {
            return;
        };
        let decl = self.c.program.decl(id);
        if !matches!(decl.kind, DeclKind::Const(_)) || self.find_local(&name.name).is_some() {
            return;
        }
        let finding = Finding::new(Code::RPI1003, format!("`{}` is a constant", name.name))
            .at(name.span, "a constant cannot be defined by an equation")
            .also(decl.span, "declared here")
            .help(format!(
                "use another name for the new flow: `{}_new = ...;`",
                name.name
            ));
        self.report(finding);
    }

    /// Whether a flow gets its type from an equation that has not been declared yet.
    fn waits_for_type(&self, flow: FlowId) -> bool {
        let inferred = self.unit.flow(flow).optional == Optional::Inferred;
        inferred && self.defined_by[flow.0 as usize].is_none()
    }

    /// Whether the name of a target is declared in this block, or around it as a name that no equation defines. A
    /// fragment does not define flows of its surroundings, which continue while it is inactive; it gets its own flow of
    /// that name.
    fn is_declared(&self, name: &Ident) -> bool {
        if self.find_in(self.block, &name.name).is_some() {
            return true;
        }
        match self.find_local(&name.name) {
            Some(Local::Flow(flow)) => !self.unit.flow(flow).role.has_equation(),
            Some(Local::Constant(_)) => true,
            _ => false,
        }
    }

    fn declare_fragment(&mut self, decl: &'a FragmentDecl, later: &mut Vec<(BlockId, Later<'a>)>) {
        let name = &decl.signature.name;
        let block = self.add_block(&name.name, name.span);
        self.declare(name, Local::Block(block));
        later.push((self.block, Later::Activation(block, decl)));
        self.within(block, |body| {
            if let Some(outputs) = &decl.signature.outputs {
                outputs.iter().for_each(|var| body.declare_var(var));
            }
            if let Some(contract) = &decl.contract {
                later.push((body.declare_contract(contract), Later::Contract(contract)));
            }
            body.declare_body(&decl.body, later);
        });
    }

    fn check_later(&mut self, item: Later<'a>) {
        match item {
            Later::Call(call) => self.check_call(call),
            Later::Claim(claim, span) => self.check_claim(claim, span),
            Later::Contract(contract) => {
                self.check_imports(self.block);
                self.check_contract(contract);
            }
            Later::End(end, span) => self.check_end(end, span),
            Later::Export(flow) => self.check_export(flow),
            Later::Activation(block, decl) => self.check_activation(block, decl),
            Later::Automaton(index, automaton) => self.check_automaton(index, automaton),
        }
    }

    fn check_call(&mut self, call: &'a ast::Expr) {
        let value = self.expr(call);
        let span = call.span;
        self.current().equations.push(Equation {
            targets: Vec::new(),
            value,
            span,
        });
    }

    fn check_end(&mut self, end: &'a ast::End, span: Span) {
        if !self.unit.kind.is_root() || self.block != BlockId::ROOT {
            let finding = Finding::new(Code::RPI8001, "only the body of a command can end it")
                .at(span, "not at the top level of a command")
                .help(
                    "define the condition as a flow here, and end the command by that flow at the top level",
                );
            return self.report(finding);
        }
        let same = |other: &&End| other.result == end.result.name;
        if let Some(first) = self.current().ends.iter().find(same) {
            let finding = crate::program::twice(&end.result.name, end.result.span, first.span);
            self.report(finding);
        }
        let condition = self.condition(&end.condition, "the end of a command");
        self.current().ends.push(End {
            kind: end.kind,
            result: end.result.name.clone(),
            condition,
            span: end.result.span,
        });
    }

    fn check_export(&mut self, flow: &'a ast::Dotted) {
        let value = self.dotted(flow);
        let key: Vec<&str> = flow.parts.iter().map(|part| part.name.as_str()).collect();
        let key = key.join(".");
        self.current().exports.push(typed::Export {
            key,
            value,
            span: flow.span,
        });
    }

    fn check_activation(&mut self, block: BlockId, decl: &'a FragmentDecl) {
        let when = decl.when.as_ref();
        let condition = when.map(|w| self.condition(&w.condition, "the activation of a fragment"));
        let budget_ns = decl
            .budget
            .as_ref()
            .and_then(|budget| self.nanoseconds(budget));
        let target = &mut self.unit.blocks[block.0 as usize];
        target.when = condition;
        target.restart = when.is_some_and(|w| w.restart);
        target.budget_ns = budget_ns;
    }

    /// Checks a condition; `of` is its role in the message.
    pub(super) fn condition(&mut self, condition: &'a ast::Expr, of: &str) -> ExprId {
        let id = self.expr(condition);
        let wanted = Wanted::By(Span::NONE, format!("{of} must be a Boolean condition"));
        self.expect(id, &Ty::Bool, &wanted);
        id
    }

    /// Checks that an expression has an expected type; reports a mismatch.
    pub(super) fn expect(&mut self, id: ExprId, expected: &Ty, wanted: &Wanted) -> bool {
        self.suits(id, expected);
        let result = fit(expected, self.ty_of(id), &mut Subst::default());
        match result {
            Ok(()) => self.angle_has_unit(id, expected),
            Err(misfit) => {
                self.misfit(id, expected, &misfit, wanted);
                false
            }
        }
    }
}
