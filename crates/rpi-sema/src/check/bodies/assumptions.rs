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

/// Checks a contract in its block. Returns the conditions that it assumes and the arguments of the contracts that
/// it imports.
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

/// Reports assumptions of a contract that read an output of the same cycle. In a declared contract the outputs
/// (`allowed`) are in-ports.
pub(crate) fn check_assumptions<'a>(
    cx: &mut Body<'_, 'a>,
    assumed: &[ExprId],
    allowed: &'a [VarDecl],
) {
    let names: Vec<&Ident> = allowed.iter().flat_map(|port| &port.names).collect();
    let reads = assumed
        .iter()
        .filter_map(|id| find_output_read(cx, *id, &names));
    let reads: Vec<(FlowId, Span)> = reads.collect();
    for (output, at) in reads {
        let flow = cx.unit.flow(output);
        let message = format!(
            "an assumption depends on the output `{}` of the same cycle",
            flow.name
        );
        let help = "an assumption may read inputs, and outputs of earlier cycles through `pre`";
        let diagnostic = Diagnostic::new(Code::RPI4003, message)
            .primary(at, "read here")
            .secondary(flow.span, "declared as an output here")
            .help(help);
        report::report_diagnostic(cx, diagnostic);
    }
}

/// Returns an output on which the value of an expression depends in the same cycle, and the location where it is read.
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

/// Returns the values of the equations that define a flow.
fn defining_values<'s>(cx: &'s Body<'_, '_>, flow: FlowId) -> impl Iterator<Item = ExprId> + 's {
    let defines = move |equation: &&Equation| {
        let mut targets = equation.targets.iter();
        targets
            .any(|t| matches!(t.place, TargetPlace::Flow { flow: defined, .. } if defined == flow))
    };
    let equations = cx.unit.blocks.iter().flat_map(|block| &block.equations);
    equations.filter(defines).map(|equation| equation.value)
}
