//! Printing of contracts.

use super::Printer;
use super::body;
use super::call;
use super::expr;
use super::layout::{Doc, concat, empty, group, indent, text, word};
use super::list;
use super::ty;
use crate::ast::*;
use rpi_diag::Span;

/// Prints a contract as `con ... noc` on lines of its own; prints nothing for `None`.
pub(super) fn print_contract(printer: &Printer<'_>, contract: Option<&Contract>) -> Doc {
    let Some(contract) = contract else {
        return empty();
    };
    let parts = contract_parts(printer, contract);
    concat([
        Doc::HardLine,
        word("con"),
        parts,
        Doc::HardLine,
        word("noc"),
    ])
}

/// Prints the body of a declaration with the keyword `contract`: `let ... tel`.
pub(super) fn contract_alone(printer: &Printer<'_>, contract: Option<&Contract>) -> Doc {
    let parts = contract.map_or_else(empty, |contract| contract_parts(printer, contract));
    concat([
        Doc::HardLine,
        word("let"),
        parts,
        Doc::HardLine,
        word("tel"),
    ])
}

/// Prints the clauses of a contract in the order of the source, so that comments stay with their clauses. For a tree
/// without source, prints the clauses by kind.
fn contract_parts(printer: &Printer<'_>, contract: &Contract) -> Doc {
    let mut parts: Vec<(Span, Doc)> = Vec::new();
    for locals in &contract.locals {
        contract_locals(printer, locals, &mut parts);
    }
    for together in &contract.ghost_tuples {
        parts.push((
            printer.with_keyword(together.span),
            print_together(printer, together),
        ));
    }
    for import in &contract.imports {
        parts.push((import.call.span, contract_import(printer, import)));
    }
    for claim in &contract.claims {
        let doc = concat([body::print_claim(printer, claim), word(";")]);
        parts.push((printer.with_keyword(claim_span(claim)), doc));
    }
    for mode in &contract.modes {
        parts.push((
            printer.with_keyword(mode.name.span),
            print_mode(printer, mode),
        ));
    }
    if parts.is_empty() {
        return empty();
    }
    parts.sort_by_key(|(span, _)| span.start);
    let lines = list::print_lines(
        printer,
        &parts,
        |(span, _)| *span,
        |_, _, (_, doc)| (doc.clone(), false),
    );
    indent(concat([Doc::HardLine, lines]))
}

/// Prints several ghost variables that share one value: `var x: int, y: bool = e;`.
fn print_together(printer: &Printer<'_>, together: &GhostTuple) -> Doc {
    let vars = together.vars.iter().enumerate().flat_map(|(i, var)| {
        let comma = word(if i == 0 { "" } else { ", " });
        [comma, ty::var_decl(printer, var)]
    });
    let vars = concat(vars.collect::<Vec<_>>());
    let value = expr::print_expr(printer, &together.equation.value);
    concat([word("var "), vars, word(" = "), value, word(";")])
}

fn contract_import(printer: &Printer<'_>, import: &ContractImport) -> Doc {
    let ExprKind::Call(call) = &import.call.kind else {
        return empty();
    };
    let (inputs, outputs) = call.args.split_at(import.input_count.min(call.args.len()));
    let callee = call::print_callee(printer, &call.callee);
    let inputs = call::print_args(printer, inputs);
    let outputs = call::print_args(printer, outputs);
    concat([
        word("import "),
        callee,
        inputs,
        word(" returns "),
        outputs,
        word(";"),
    ])
}

/// Adds the documents of local declarations of a contract to `parts`, with their source ranges. Each declaration has
/// its own keyword, as a contract has no sections.
fn contract_locals(printer: &Printer<'_>, locals: &Locals, parts: &mut Vec<(Span, Doc)>) {
    let line = |head, doc| concat([word(head), doc, word(";")]);
    match locals {
        Locals::Var(vars) => {
            parts.extend(vars.iter().map(|v| {
                (
                    printer.with_keyword(v.span),
                    line("var ", ty::var_decl(printer, v)),
                )
            }));
        }
        Locals::Const(defs) => {
            parts.extend(defs.iter().map(|d| {
                (
                    printer.with_keyword(d.span),
                    line("const ", ty::const_def(printer, d)),
                )
            }));
        }
    }
}

fn print_mode(printer: &Printer<'_>, mode: &ContractMode) -> Doc {
    let requires = mode.requires.iter().map(|claim| ("require ", claim));
    let ensures = mode.ensures.iter().map(|claim| ("ensure ", claim));
    let mut claims: Vec<(&'static str, &Claim)> = requires.chain(ensures).collect();
    claims.sort_by_key(|(_, claim)| claim_span(claim).start);
    let claim = |(head, claim): (&'static str, &Claim)| {
        concat([
            Doc::Line,
            word(head),
            body::print_condition(printer, claim),
            word(";"),
        ])
    };
    let parts: Vec<Doc> = claims.into_iter().map(claim).collect();
    let head = text(format!("mode {} (", mode.name.name));
    group(concat([head, indent(concat(parts)), Doc::Line, word(");")]))
}

fn claim_span(claim: &Claim) -> Span {
    let label = claim.label.as_ref().map_or(Span::NONE, |label| label.span);
    label.merge(claim.condition.span)
}
