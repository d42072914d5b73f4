//! Statements of a body: all are declared first, so that their order does not matter, then checked.

use crate::check::bodies::automaton;
use crate::check::bodies::blocks;
use crate::check::bodies::body::Body;
use crate::check::bodies::contract;
use crate::check::bodies::defaults;
use crate::check::bodies::definitions;
use crate::check::bodies::elements;
use crate::check::bodies::inference_errors;
use crate::check::bodies::locals;
use crate::check::bodies::locals::Local;
use crate::check::bodies::type_inference::EquationLhs;
use crate::check::bodies::type_inference::EquationState;
use crate::check::bodies::type_inference::PendingEquation;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::ExpectationReason;
use crate::check::exprs::clocked;
use crate::check::exprs::expr;
use crate::check::exprs::names;
use crate::check::signatures::imported;
use crate::check::types;
use crate::check::types::DeclaredType;
use crate::check::types::consts;
use crate::check::types::exact_time;
use crate::check::types::infer_times;
use crate::check::types::time_sums;
use crate::program::DeclKind;
use crate::ty::Substitution;
use crate::ty::Ty;
use crate::ty::check_assignable;
use crate::typed::{self, BlockId, End, Equation, ExprId, FlowId, FlowPresence, FlowRole};
use rpi_diag::{Code, Diagnostic, Quote, Span};
use rpi_syntax::Dialect;
use rpi_syntax::ast::{self, FragmentDecl, Ident, Locals, Statement, StatementKind, VarDecl};
use smallvec::SmallVec;

/// Statement, or part of one, that is checked after type inference, when the types of all flows are known.
pub(crate) enum DeferredCheck<'a> {
    /// Statement that consists of a call only; the result is not used.
    Call(&'a ast::Expr),
    /// Condition that the program states about itself (`assert` or `check`), and its span.
    Claim(&'a ast::Claim, Span),
    /// Contract of a node, whose names are in a block of its own.
    Contract(&'a ast::Contract),
    /// Statement that ends a command, such as `finish r when c`, and its span.
    End(&'a ast::CommandEnd, Span),
    /// Flow that a command exports, so that it is visible outside of the command.
    Export(&'a ast::Dotted),
    /// Activation condition and time budget of a fragment. The block is that of the fragment.
    Activation(BlockId, &'a FragmentDecl),
    /// Transitions of an automaton, with the index of the automaton in its block.
    Automaton(usize, &'a ast::Automaton),
}

/// Declares all statements of a body, infers the types of its flows, and checks the statements.
pub(crate) fn check_body<'a>(cx: &mut Body<'_, 'a>, body: &'a ast::Body) {
    let mut later = Vec::new();
    declare_body(cx, body, &mut later);
    elements::check_element_order(cx);
    check_equations(cx);
    for (block, item) in later {
        cx.in_block(block, |body| check_deferred(body, item));
    }
    definitions::check_definitions(cx);
    time_sums::check_time_sums(cx);
}

/// Infers the types of all flows, and then checks all equations that have been declared.
pub(crate) fn check_equations(cx: &mut Body<'_, '_>) {
    infer_times::infer_with_times(cx);
    resolve_declared_clocks(cx);
    inference_errors::report_unknown_types(cx);
    for index in 0..cx.pending.len() {
        let block = cx.pending[index].block;
        cx.in_block(block, |body| elements::check_element_equation(body, index));
    }
}

/// Declares the local flows and statements of a body in the current block. Appends the checks that need the types of
/// all flows, with their blocks, to `later`.
pub(crate) fn declare_body<'a>(
    cx: &mut Body<'_, 'a>,
    body: &'a ast::Body,
    later: &mut Vec<(BlockId, DeferredCheck<'a>)>,
) {
    locals::reserve_tables(cx, body);
    for section in &body.locals {
        match section {
            Locals::Var(vars) => vars.iter().for_each(|var| declare_var(cx, var)),
            Locals::Const(defs) => defs.iter().for_each(|def| declare_const(cx, def)),
        }
    }
    cx.definitions
        .declared_clocks
        .push((cx.block, &body.locals[..]));
    elements::count_parts(cx, &body.statements);
    defaults::declare_defaults(cx, &body.statements);
    for statement in &body.statements {
        declare_statement(cx, statement, later);
    }
}

/// Declares the local flows of a `var` declaration. `var x: int = e;` also declares the equation of `x`.
pub(crate) fn declare_var<'a>(cx: &mut Body<'_, 'a>, var: &'a VarDecl) {
    let port = types::resolve_port_type(cx, &var.ty);
    for name in &var.names {
        locals::report_constant_shadowing(cx, name);
        let flow = locals::declare_flow(cx, name, &port, FlowRole::Local);
        time_sums::record_unit(cx, flow, &var.ty);
        if let Some(value) = &var.default {
            cx.pending.push(PendingEquation {
                block: cx.block,
                lhs: EquationLhs::Var(flow),
                value,
                span: var.span,
                inferred_flows: SmallVec::from([None]),
                state: EquationState::Unchecked,
                indices: Vec::new(),
            });
        }
    }
}

pub(crate) fn declare_const<'a>(cx: &mut Body<'_, 'a>, def: &'a ast::ConstDef) {
    let Some(constant) = consts::constant_def(cx, def) else {
        for name in &def.names {
            let nothing = DeclaredType {
                ty: Ty::Unknown,
                optional: false,
            };
            locals::declare_flow(cx, name, &nothing, FlowRole::Param);
        }
        return;
    };
    for name in &def.names {
        locals::declare(cx, name, Local::Constant(constant.clone()));
    }
}

/// Sets the clocks that local declarations state. It runs after type inference, because equations may introduce the
/// flows that the clocks refer to.
fn resolve_declared_clocks(cx: &mut Body<'_, '_>) {
    for (block, sections) in std::mem::take(&mut cx.definitions.declared_clocks) {
        for section in sections {
            if let Locals::Var(vars) = section {
                cx.in_block(block, |body| resolve_clocks_of(body, vars));
            }
        }
    }
}

/// Sets the clock of each flow whose declaration states one: `var x: int when c`.
pub(crate) fn resolve_clocks_of<'a>(cx: &mut Body<'_, 'a>, vars: &'a [VarDecl]) {
    for var in vars {
        let Some(clock) = &var.clock else {
            continue;
        };
        let on = clocked::resolve_clock(cx, clock);
        for name in &var.names {
            if let (Some(flow), Some(on)) = (cx.find_flow(&name.name), on) {
                cx.unit.flows[flow.0 as usize].clock = Some(on);
            }
        }
    }
}

fn declare_statement<'a>(
    cx: &mut Body<'_, 'a>,
    statement: &'a Statement,
    later: &mut Vec<(BlockId, DeferredCheck<'a>)>,
) {
    let block = cx.block;
    match &statement.kind {
        StatementKind::Equation(equation) => declare_equation(cx, equation, statement.span),
        StatementKind::Call(call) => later.push((block, DeferredCheck::Call(call))),
        StatementKind::Claim(claim) => {
            later.push((block, DeferredCheck::Claim(claim, statement.span)));
        }
        StatementKind::CommandEnd(end) => {
            later.push((block, DeferredCheck::End(end, statement.span)))
        }
        StatementKind::Export(flows) => {
            later.extend(
                flows
                    .iter()
                    .map(|flow| (block, DeferredCheck::Export(flow))),
            );
        }
        StatementKind::Fragment(fragment) => declare_fragment(cx, fragment, later),
        StatementKind::Automaton(automaton) => {
            automaton::declare_automaton(cx, automaton, statement.span, later);
        }
        StatementKind::Conditional(choice) => blocks::declare_equation_block(cx, &choice.desugared),
        StatementKind::FrameBlock(keep) => blocks::declare_equation_block(cx, &keep.desugared),
        StatementKind::Error(names) => {
            for name in names {
                let flow = match locals::find_local(cx, &name.name) {
                    None => Some(locals::introduce_flow(cx, name)),
                    Some(Local::Flow(flow)) => Some(flow),
                    Some(_) => None,
                };
                cx.reported.erroneous_flows.extend(flow);
            }
        }
    }
}

pub(crate) fn declare_equation<'a>(cx: &mut Body<'_, 'a>, equation: &'a ast::Equation, span: Span) {
    if elements::defines_elements(cx, equation) {
        return elements::expand_element_equation(cx, equation, span);
    }
    let index = cx.pending.len();
    let introduces = equation
        .targets
        .iter()
        .map(|target| introduced_flow(cx, target, index));
    let introduces = introduces.collect();
    cx.pending.push(PendingEquation {
        block: cx.block,
        lhs: EquationLhs::Targets(&equation.targets),
        value: &equation.value,
        span,
        inferred_flows: introduces,
        state: EquationState::Unchecked,
        indices: Vec::new(),
    });
}

/// Returns the flow whose type the equation with this index in `pending` decides: a flow that the equation introduces
/// by a plain name that is not yet declared, or a flow without a type introduced before. `None` for other targets.
fn introduced_flow(cx: &mut Body<'_, '_>, target: &ast::Target, index: usize) -> Option<FlowId> {
    report_constant_redefinition(cx, &target.name);
    let may = target.path.is_empty() && cx.mode == Dialect::Rpi && target.name.name != "_";
    let own = match locals::find_in_block(cx, cx.block, &target.name.name) {
        Some(Local::Flow(flow)) => Some(defaults::defined_flow(cx, flow)),
        _ => None,
    };
    let flow = match own {
        Some(flow) if may && lacks_type(cx, flow) => flow,
        _ if !may || is_declared(cx, &target.name) => return None,
        _ => locals::introduce_flow(cx, &target.name),
    };
    let around = automaton::enclosing_shared_flows(cx, flow);
    let around: Vec<FlowId> = around.filter(|outer| lacks_type(cx, *outer)).collect();
    for flow in std::iter::once(flow).chain(around) {
        cx.inference.defined_by[flow.0 as usize] = Some(index);
    }
    Some(flow)
}

/// Reports an equation whose left side is the name of a constant of the same file.
pub(crate) fn report_constant_redefinition(cx: &mut Body<'_, '_>, name: &Ident) {
    let Some(id) = cx.checker.program.lookup_own(cx.module, &name.name) else {
        return;
    };
    let decl = cx.checker.program.decl(id);
    if !matches!(decl.kind, DeclKind::Const(_)) || locals::find_local(cx, &name.name).is_some() {
        return;
    }
    let diagnostic = Diagnostic::new(Code::RPI1003, format!("`{}` is a constant", name.name))
        .primary(name.span, "a constant cannot be defined by an equation")
        .secondary(decl.span, "declared here")
        .help(format!(
            "use another name for the new flow: `{}_new = ...;`",
            name.name
        ));
    report::report_diagnostic(cx, diagnostic);
}

/// Whether the type of a flow is to be inferred and no equation for it has been declared yet.
fn lacks_type(cx: &Body<'_, '_>, flow: FlowId) -> bool {
    let inferred = cx.unit.flow(flow).optional == FlowPresence::Inferred;
    inferred && cx.inference.defined_by[flow.0 as usize].is_none()
}

/// Whether the name on the left side of an equation is declared in the current block, or around it as a name that no
/// equation may define, such as an in-port. An equation in a fragment does not define a flow outside of it, which has a
/// value while the fragment is inactive; the fragment gets a flow of its own of that name.
fn is_declared(cx: &Body<'_, '_>, name: &Ident) -> bool {
    if locals::find_in_block(cx, cx.block, &name.name).is_some() {
        return true;
    }
    match locals::find_local(cx, &name.name) {
        Some(Local::Flow(flow)) => !cx.unit.flow(flow).role.has_equation(),
        Some(Local::Constant(_)) => true,
        _ => false,
    }
}

fn declare_fragment<'a>(
    cx: &mut Body<'_, 'a>,
    decl: &'a FragmentDecl,
    later: &mut Vec<(BlockId, DeferredCheck<'a>)>,
) {
    let name = &decl.signature.name;
    let block = locals::add_block(cx, &name.name, name.span);
    locals::declare(cx, name, Local::Block(block));
    later.push((cx.block, DeferredCheck::Activation(block, decl)));
    cx.in_block(block, |body| {
        if let Some(outputs) = &decl.signature.outputs {
            outputs.iter().for_each(|var| declare_var(body, var));
        }
        if let Some(contract) = &decl.contract {
            later.push((
                contract::declare_contract(body, contract),
                DeferredCheck::Contract(contract),
            ));
        }
        declare_body(body, &decl.body, later);
    });
}

fn check_deferred<'a>(cx: &mut Body<'_, 'a>, item: DeferredCheck<'a>) {
    match item {
        DeferredCheck::Call(call) => check_call(cx, call),
        DeferredCheck::Claim(claim, span) => contract::check_claim(cx, claim, span),
        DeferredCheck::Contract(contract) => {
            imported::check_imports(cx, cx.block);
            contract::check_contract(cx, contract);
        }
        DeferredCheck::End(end, span) => check_end(cx, end, span),
        DeferredCheck::Export(flow) => check_export(cx, flow),
        DeferredCheck::Activation(block, decl) => check_activation(cx, block, decl),
        DeferredCheck::Automaton(index, automaton) => {
            automaton::check_automaton(cx, index, automaton)
        }
    }
}

fn check_call<'a>(cx: &mut Body<'_, 'a>, call: &'a ast::Expr) {
    let value = expr::check_expr(cx, call);
    let span = call.span;
    cx.current_block().equations.push(Equation {
        targets: Vec::new(),
        value,
        span,
    });
}

fn check_end<'a>(cx: &mut Body<'_, 'a>, end: &'a ast::CommandEnd, span: Span) {
    if !cx.unit.kind.is_root() || cx.block != BlockId::ROOT {
        let diagnostic = Diagnostic::new(Code::RPI8001, "only the body of a command can end it")
            .primary(span, "not at the top level of a command")
            .help(inner_end_help(cx, end));
        return report::report_diagnostic(cx, diagnostic);
    }
    let same = |other: &&End| other.result == end.result.name;
    if let Some(first) = cx.current_block().ends.iter().find(same) {
        let diagnostic =
            crate::program::duplicate_name_error(&end.result.name, end.result.span, first.span);
        report::report_diagnostic(cx, diagnostic);
    }
    let condition = check_condition(cx, &end.condition, "the end of a command");
    cx.current_block().ends.push(End {
        kind: end.kind,
        result: end.result.name.clone(),
        condition,
        span: end.result.span,
    });
}

/// Returns the way to end a command by a condition that is computed in a fragment, a state or a node.
fn inner_end_help(cx: &Body<'_, '_>, end: &ast::CommandEnd) -> String {
    let (result, condition) = (&end.result.name, Quote::text(end.condition.span));
    let block = &cx.unit.block(cx.block).name;
    let keyword = match end.kind {
        ast::CommandEndKind::Finish => "finish",
        ast::CommandEndKind::Yield => "yield",
        ast::CommandEndKind::Fail => "fail",
    };
    match cx.unit.kind.is_root() && !block.is_empty() {
        true => format!(
            "define a flow here, `{result} = {condition};`, and in the body of the command write `{keyword} {result} when {block}.{result} ?? false;`"
        ),
        false => {
            "return the condition by an out-port, and end the command by it in its body".to_owned()
        }
    }
}

fn check_export<'a>(cx: &mut Body<'_, 'a>, flow: &'a ast::Dotted) {
    let value = names::resolve_dotted(cx, flow);
    let key: Vec<&str> = flow.parts.iter().map(|part| part.name.as_str()).collect();
    let key = key.join(".");
    cx.current_block().exports.push(typed::Export {
        key,
        value,
        span: flow.span,
    });
}

fn check_activation<'a>(cx: &mut Body<'_, 'a>, block: BlockId, decl: &'a FragmentDecl) {
    let when = decl.when.as_ref();
    let condition = when.map(|w| check_condition(cx, &w.condition, "the activation of a fragment"));
    let budget_ns = decl
        .budget
        .as_ref()
        .and_then(|budget| consts::const_nanoseconds(cx, budget));
    let target = &mut cx.unit.blocks[block.0 as usize];
    target.when = condition;
    target.restart = when.is_some_and(|w| w.resets);
    target.budget_ns = budget_ns;
}

/// Checks that an expression is Boolean, reports an error otherwise, and returns its typed expression. `of` is the role
/// of the condition in the message, such as "a claim".
pub(crate) fn check_condition<'a>(
    cx: &mut Body<'_, 'a>,
    condition: &'a ast::Expr,
    of: &str,
) -> ExprId {
    let id = expr::check_expr(cx, condition);
    let wanted =
        ExpectationReason::Because(Span::NONE, format!("{of} must be a Boolean condition"));
    expect_type(cx, id, &Ty::Bool, &wanted);
    id
}

/// Checks that an expression has the expected type, and reports a mismatch. Returns whether the type matches. `wanted`
/// is the reason for the expectation in the message.
pub(crate) fn expect_type(
    cx: &mut Body<'_, '_>,
    id: ExprId,
    expected: &Ty,
    wanted: &ExpectationReason,
) -> bool {
    exact_time::convert_time_for(cx, id, expected);
    let result = check_assignable(expected, cx.ty_of(id), &mut Substitution::default());
    match result {
        Ok(()) => expr::check_angle_unit(cx, id, expected),
        Err(misfit) => {
            report::type_mismatch(cx, id, expected, &misfit, wanted);
            false
        }
    }
}
