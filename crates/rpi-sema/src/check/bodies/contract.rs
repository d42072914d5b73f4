//! Contracts: assumptions that the caller must satisfy, guarantees that the body must satisfy, and modes.
//!
//! A contract is a block inside the body that it describes. Nothing outside of it reads its names, so that it can be
//! omitted as a whole. The `ensure` of a mode becomes a guarantee under the condition of the mode's `require`; in every
//! cycle at least one mode must apply.

use crate::check::bodies::body::Body;
use crate::check::bodies::locals;
use crate::check::bodies::statement;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::join_names;
use crate::check::exprs::bindings::NotEvaluable;
use crate::check::exprs::ops;
use crate::check::signatures::imported;
use crate::ty::Ty;
use crate::typed::TypedKind;
use crate::typed::{BlockId, Claim, ClaimKind, ExprId, FlowRole, Leaf};
use rpi_diag::{Code, Diagnostic, Span};
use rpi_syntax::Name;
use rpi_syntax::ast::{self, Contract, ContractMode, Locals};
use rpi_syntax::ops::BinaryOp;

/// Declares the flows or constants of a section (`var` or `const`) of local declarations in a contract.
fn declare_section<'a>(cx: &mut Body<'_, 'a>, section: &'a Locals) {
    match section {
        Locals::Var(vars) => vars.iter().for_each(|var| {
            var.names
                .iter()
                .for_each(|name| report_hidden_ports(cx, name));
            statement::declare_var(cx, var);
        }),
        Locals::Const(defs) => defs
            .iter()
            .for_each(|def| statement::declare_const(cx, def)),
    }
}

/// Adds a block for the contract of the current block, declares the names of the contract in it, and returns the block.
pub(crate) fn declare_contract<'a>(cx: &mut Body<'_, 'a>, contract: &'a Contract) -> BlockId {
    let block = locals::add_block(cx, &Name::from("contract"), contract.span);
    cx.unit.blocks[block.0 as usize].is_contract = true;
    cx.in_block(block, |body| {
        for section in &contract.locals {
            declare_section(body, section);
        }
        for together in &contract.ghost_tuples {
            together
                .vars
                .iter()
                .for_each(|var| statement::declare_var(body, var));
            statement::declare_equation(body, &together.equation, together.span);
        }
        declare_modes(body, contract);
        imported::declare_imports(body, contract);
    });
    block
}

/// Reports a local flow of a contract that has the name of a port of the node, because claims could not refer to the
/// port.
fn report_hidden_ports(cx: &mut Body<'_, '_>, name: &ast::Ident) {
    let is_twice_here = locals::find_in_block(cx, cx.block, &name.name).is_some();
    if let Some(port) = port_span(cx, &name.name).filter(|_| !is_twice_here) {
        let diagnostic = crate::program::duplicate_name_error(&name.name, name.span, port);
        report::report_diagnostic(cx, diagnostic);
    }
}

/// Returns the diagnostic for a contract that reads `name`, a local flow of the body whose contract it is; `None` if
/// the body has no such local flow. `span` is the location of the read.
pub(crate) fn hidden_local_error(cx: &Body<'_, '_>, name: &Name, span: Span) -> Option<Diagnostic> {
    let mut vars = cx
        .contract
        .hidden_locals
        .iter()
        .flat_map(|section| match section {
            Locals::Var(vars) => &vars[..],
            Locals::Const(_) => &[],
        });
    let local = vars.find_map(|var| var.names.iter().find(|local| local.name == *name))?;
    let message = format!("a contract cannot read `{name}`, a local flow of the body");
    let diagnostic = Diagnostic::new(Code::RPI1001, message)
        .primary(span, "not visible in the contract")
        .secondary(local.span, "declared in the body");
    Some(diagnostic.help(format!(
        "a contract reads the ports and global constants; define the value in it: `var {name}: int = ...;`"
    )))
}

/// Returns the location of the flow `name` that is visible around a contract. `None` if there is none, or if it is an
/// in-port of a contract declared on its own.
fn port_span(cx: &Body<'_, '_>, name: &Name) -> Option<Span> {
    let flow = cx.find_flow(name).map(|flow| cx.unit.flow(flow));
    let flow = flow.filter(|flow| !cx.unit.is_contract || flow.role != FlowRole::Input);
    flow.map(|flow| flow.span)
}

/// Records the modes of a contract. Reports a mode with the name of another mode or of a flow.
fn declare_modes<'a>(cx: &mut Body<'_, 'a>, contract: &'a Contract) {
    for (k, mode) in contract.modes.iter().enumerate() {
        let name = &mode.name;
        let twin = contract.modes[..k]
            .iter()
            .find(|m| m.name.name == name.name);
        let flow = port_span(cx, &name.name);
        if let Some(first) = twin.map(|twin| twin.name.span).or(flow) {
            let diagnostic = crate::program::duplicate_name_error(&name.name, name.span, first);
            report::report_diagnostic(cx, diagnostic);
        }
    }
    cx.contract.modes = contract.modes.iter().collect();
}

/// Checks a reference to a mode and returns a Boolean expression that is true while the mode applies. `m` is a mode of
/// the contract being checked (written `::m`), and `c::m` is a mode of an imported contract.
pub(crate) fn mode_condition(cx: &mut Body<'_, '_>, name: &str, span: Span) -> ExprId {
    if let Some((contract, mode)) = name.split_once("::") {
        return imported::imported_mode_condition(cx, contract, mode, span);
    }
    let Some(mode) = cx
        .contract
        .modes
        .iter()
        .copied()
        .find(|mode| mode.name.name == *name)
    else {
        let near = rpi_diag::suggest(
            name,
            cx.contract.modes.iter().map(|mode| mode.name.name.as_str()),
        );
        let diagnostic =
            crate::check::diagnostics::report::undefined_name("mode", name, span, near);
        let names = cx.contract.modes.iter().map(|mode| mode.name.name.as_str());
        let diagnostic = match cx.contract.modes.is_empty() {
            true => diagnostic.help("declare it: `mode ... (require ...; ensure ...;);`"),
            false => diagnostic.help(match cx.contract.modes.len() {
                1 => format!("the only mode of this contract is {}", join_names(names)),
                _ => format!("the modes of this contract are {}", join_names(names)),
            }),
        };
        return cx.report_error_expr(diagnostic, span);
    };
    if cx.contract.modes_in_progress.contains(&mode.name.name) {
        if std::mem::replace(&mut cx.contract.mode_cycle_reported, true) {
            return cx.error_expr(span);
        }
        let message = format!("dependency cycle: the mode `{name}` depends on itself");
        let diagnostic = Diagnostic::new(Code::RPI1007, message)
            .primary(span, format!("the condition of `{name}` reads it"))
            .secondary(mode.name.span, "declared here")
            .help("state the condition of one of the modes by flows instead of modes");
        let diagnostic =
            modes_between(cx, name)
                .into_iter()
                .fold(diagnostic, |diagnostic, (other, span)| {
                    diagnostic.secondary(span, format!("`{name}` depends on the mode `{other}`"))
                });
        return cx.report_error_expr(diagnostic, span);
    }
    cx.contract.modes_in_progress.push(mode.name.name.clone());
    let applies = requirement_condition(cx, mode);
    cx.contract.modes_in_progress.pop();
    applies
}

/// Returns the modes on the dependency cycle of the mode `name`, apart from that mode itself, with their places.
fn modes_between(cx: &Body<'_, '_>, name: &str) -> Vec<(Name, Span)> {
    let open = &cx.contract.modes_in_progress;
    let from = open.iter().position(|mode| *mode == *name);
    let between = &open[from.map_or(open.len(), |at| at + 1)..];
    let place = |name: &Name| {
        let mode = cx
            .contract
            .modes
            .iter()
            .find(|mode| mode.name.name == *name)?;
        Some((name.clone(), mode.name.span))
    };
    between.iter().filter_map(place).collect()
}

/// Returns the condition under which a mode applies: the conjunction of its `require` clauses.
fn requirement_condition<'a>(cx: &mut Body<'_, 'a>, mode: &'a ContractMode) -> ExprId {
    let requires = mode.requires.iter();
    let requires = requires
        .map(|claim| statement::check_condition(cx, &claim.condition, "a claim"))
        .collect();
    join_conditions(cx, BinaryOp::And, requires, mode.name.span)
}

/// Checks the claims and modes of a contract in the current block, and adds the claim that at least one mode applies.
pub(crate) fn check_contract<'a>(cx: &mut Body<'_, 'a>, contract: &'a Contract) {
    for claim in &contract.claims {
        check_claim(cx, claim, claim.condition.span);
    }
    let modes = contract.modes.iter();
    let applies: Vec<ExprId> = modes.map(|mode| check_mode(cx, mode)).collect();
    let (Some(first), Some(last)) = (contract.modes.first(), contract.modes.last()) else {
        return;
    };
    let span = Span {
        end: last.name.span.end,
        ..first.name.span
    };
    cx.contract.mode_conditions.clone_from(&applies);
    let condition = join_conditions(cx, BinaryOp::Or, applies, span);
    cx.current_block().claims.push(Claim {
        kind: ClaimKind::ModeCompleteness,
        condition,
        mode: None,
        label: None,
        span,
    });
}

/// Checks a mode of a contract: adds a claim for each `ensure` clause, which must hold while the mode applies. Returns
/// the condition under which the mode applies.
fn check_mode<'a>(cx: &mut Body<'_, 'a>, mode: &'a ContractMode) -> ExprId {
    cx.contract.modes_in_progress.push(mode.name.name.clone());
    let applies = requirement_condition(cx, mode);
    cx.contract.modes_in_progress.pop();
    for ensure in &mode.ensures {
        let (label, span) = (claim_label(ensure), ensure.condition.span);
        let Some(holds) = check_claim_condition(cx, &ensure.condition) else {
            continue;
        };
        let condition = ops::binary_prim(cx, BinaryOp::Implies, applies, holds, span);
        cx.current_block().claims.push(Claim {
            kind: ClaimKind::Guarantee,
            condition,
            mode: Some(mode.name.name.clone()),
            label,
            span,
        });
    }
    applies
}

/// Returns an expression that joins conditions by the operator `by`; the constant `true` if there are no conditions.
fn join_conditions(
    cx: &mut Body<'_, '_>,
    by: BinaryOp,
    conditions: Vec<ExprId>,
    span: Span,
) -> ExprId {
    let joined = conditions
        .into_iter()
        .reduce(|all, next| ops::binary_prim(cx, by, all, next, span));
    joined.unwrap_or_else(|| cx.add(TypedKind::Literal(Leaf::bool(true)), Ty::Bool, span))
}

/// Checks the condition of a claim and returns its expression. Returns `None`, with a warning, if the condition cannot
/// be evaluated at run time because of a quantifier.
fn check_claim_condition<'a>(cx: &mut Body<'_, 'a>, condition: &'a ast::Expr) -> Option<ExprId> {
    let before = cx.diagnostics.len();
    cx.contract.claim_check = Some(NotEvaluable::default());
    let value = statement::check_condition(cx, condition, "a claim");
    let NotEvaluable(Some(span)) = cx.contract.claim_check.take().unwrap_or_default() else {
        return Some(value);
    };
    if !report::has_error_since(cx, before) {
        report::report_diagnostic(
            cx,
            Diagnostic::new(Code::RPI1013, "this claim is not checked at run time")
                .primary(span, "a cycle cannot try all values of its variables")
                .help("compute the claim over the elements of the array with `red`; a model checker such as Kind 2 reads it as it is"),
        );
    }
    None
}

/// Checks an `assert`, a `check`, or a clause of a contract, and adds it to the current block.
pub(crate) fn check_claim<'a>(cx: &mut Body<'_, 'a>, claim: &'a ast::Claim, span: Span) {
    let Some(mut condition) = check_claim_condition(cx, &claim.condition) else {
        return;
    };
    if let Some(provided) = &claim.provided {
        let provided = statement::check_condition(cx, provided, "the expression after `provided`");
        condition = ops::binary_prim(cx, BinaryOp::Implies, provided, condition, span);
    }
    cx.current_block().claims.push(Claim {
        kind: claim_kind(claim.kind),
        condition,
        mode: None,
        label: claim_label(claim),
        span,
    });
}

fn claim_kind(kind: ast::ClaimKind) -> ClaimKind {
    match kind {
        ast::ClaimKind::Assert => ClaimKind::Assert,
        ast::ClaimKind::Check | ast::ClaimKind::Property => ClaimKind::Check,
        ast::ClaimKind::Assume => ClaimKind::Assume,
        ast::ClaimKind::Guarantee => ClaimKind::Guarantee,
    }
}

fn claim_label(claim: &ast::Claim) -> Option<Name> {
    claim.label.as_ref().map(|label| label.name.clone())
}
