//! Assumptions of contracts. An assumption may not depend on the outputs that it constrains.

use crate::check::bodies::body::Body;
use crate::check::bodies::contract;
use crate::check::diagnostics::report;
use crate::check::signatures::imported;
use crate::typed::{BlockId, ClaimKind, Equation, ExprId, FlowId, FlowRole, TargetPlace};
use crate::typed::{ElementwiseOp, TypedKind};
use rpi_diag::{Code, Diagnostic, Span};
use rpi_syntax::ast::{Contract, Ident, VarDecl};
use std::collections::BTreeSet;

/// Checks the claims, modes and imports of a contract in the contract's own block of the body. Returns the expressions
/// that are assumed of the caller: the conditions of the `assume` clauses, the condition that some mode applies, and
/// the arguments of imported contracts.
pub(crate) fn check_contract_assumptions<'a>(
    cx: &mut Body<'_, 'a>,
    block: BlockId,
    contract: &'a Contract,
) -> Vec<ExprId> {
    let mut assumed = Vec::new();
    cx.in_block(block, |body| {
        assumed.extend(imported::check_imports(body, block));
        contract::check_contract(body, contract);
    });
    let claims = cx.unit.block(block).claims.iter();
    let about =
        claims.filter(|c| matches!(c.kind, ClaimKind::Assume | ClaimKind::ModeCompleteness));
    assumed.extend(about.map(|claim| claim.condition));
    assumed
}

/// Reports each assumption of a contract that depends on an output of the same cycle. `assumed` are the assumptions.
/// `allowed` are the outputs of a contract that is declared on its own, where they are in-ports of the contract; empty
/// for other contracts.
pub(crate) fn check_assumptions<'a>(
    cx: &mut Body<'_, 'a>,
    assumed: &[ExprId],
    allowed: &'a [VarDecl],
) {
    let names: Vec<&Ident> = allowed.iter().flat_map(|port| &port.names).collect();
    let reads = assumed.iter().filter_map(|id| {
        let (output, at) = find_output_read(cx, *id, &names)?;
        Some((output, at, cx.span_of(*id)))
    });
    let reads: Vec<(FlowId, Span, Span)> = reads.collect();
    for (output, at, assumption) in reads {
        let flow = cx.unit.flow(output);
        let message = format!(
            "an assumption depends on the output `{}` of the same cycle",
            flow.name
        );
        let help = "an assumption may read inputs, and outputs of earlier cycles through `pre`; state what the node ensures by `guarantee`";
        let diagnostic = Diagnostic::new(Code::RPI4003, message)
            .primary(at, format!("`{}` is read here", flow.name))
            .secondary(flow.span, "declared as an output here")
            .help(help);
        let diagnostic = match assumption.contains(at) {
            true => diagnostic,
            false => diagnostic.secondary(assumption, "this assumption depends on it"),
        };
        report::report_diagnostic(cx, diagnostic);
    }
}

/// Returns an output on which the value of an expression depends in the same cycle, and the location where it is read;
/// `None` if there is no such output. In-ports with a name in `allowed` count as outputs.
fn find_output_read(cx: &Body<'_, '_>, id: ExprId, allowed: &[&Ident]) -> Option<(FlowId, Span)> {
    let is_output = |id: FlowId| {
        let flow = cx.unit.flow(id);
        flow.role == FlowRole::Output || allowed.iter().any(|port| port.name == flow.name)
    };
    let (mut parts, mut seen) = (cx.unit.traverse(id), BTreeSet::new());
    while let Some((id, expr)) = parts.next() {
        match &expr.kind {
            TypedKind::Each(ElementwiseOp::Pre, _) => {}
            TypedKind::Flow(flow) if is_output(*flow) => return Some((*flow, expr.span)),
            TypedKind::Flow(flow) if seen.insert(*flow) => {
                parts.add_roots(defining_values(cx, *flow))
            }
            // Whether a mode of an imported contract applies depends on the arguments of that contract. Its
            // requirements are assumptions of the imported contract, so that they are checked there.
            kind => match imported::imported_mode_args(cx, kind) {
                Some(given) => parts.add_roots(given),
                None => parts.enter(id),
            },
        }
    }
    None
}

/// Returns the values of the equations of the body that define a flow.
fn defining_values<'s>(cx: &'s Body<'_, '_>, flow: FlowId) -> impl Iterator<Item = ExprId> + 's {
    let defines = move |equation: &&Equation| {
        let mut targets = equation.targets.iter();
        targets
            .any(|t| matches!(t.place, TargetPlace::Flow { flow: defined, .. } if defined == flow))
    };
    let equations = cx.unit.blocks.iter().flat_map(|block| &block.equations);
    equations.filter(defines).map(|equation| equation.value)
}
