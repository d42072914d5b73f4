//! What contracts assume.

use super::body::Body;
use crate::typed::{BlockId, ClaimKind, Each, Equation, ExprId, FlowId, FlowRole, Kind, Place};
use rpi_diag::{Code, Finding, Span};
use rpi_syntax::ast::{Contract, Ident, VarDecl};
use std::collections::BTreeSet;

impl<'a> Body<'_, 'a> {
    /// Checks a contract in its block. Gives what it assumes, and what goes into the contracts that it takes up.
    pub(super) fn assumed_by(&mut self, block: BlockId, contract: &'a Contract) -> Vec<ExprId> {
        let mut assumed = Vec::new();
        self.within(block, |body| {
            assumed.extend(body.check_imports(block));
            body.check_contract(contract);
        });
        let claims = self.unit.block(block).claims.iter();
        let about = claims.filter(|c| matches!(c.kind, ClaimKind::Assume | ClaimKind::Modes));
        assumed.extend(about.map(|claim| claim.condition));
        assumed
    }

    /// What is assumed must be known before the outputs of the same cycle are: it allows them. In a contract by itself
    /// these are in-ports.
    pub(super) fn check_assumptions(&mut self, assumed: &[ExprId], allowed: &'a [VarDecl]) {
        let names: Vec<&Ident> = allowed.iter().flat_map(|port| &port.names).collect();
        let reads = assumed
            .iter()
            .filter_map(|id| self.output_read_by(*id, &names));
        let reads: Vec<(FlowId, Span)> = reads.collect();
        for (output, at) in reads {
            let flow = self.unit.flow(output);
            let message = format!("an assumption depends on `{}`, which it allows", flow.name);
            let help =
                "assume something about what comes in, or about outputs of earlier cycles: `pre`";
            let finding = Finding::new(Code::RPI4003, message)
                .at(at, "the output of this cycle is read here")
                .also(flow.span, "declared as an output here")
                .help(help);
            self.report(finding);
        }
    }

    /// An output that the value depends on in the same cycle, and where it is read.
    fn output_read_by(&self, id: ExprId, allowed: &[&Ident]) -> Option<(FlowId, Span)> {
        let is_output = |id: FlowId| {
            let flow = self.unit.flow(id);
            flow.role == FlowRole::Output || allowed.iter().any(|port| port.name == flow.name)
        };
        let (mut parts, mut seen) = (self.unit.parts(id), BTreeSet::new());
        while let Some((id, expr)) = parts.next() {
            match &expr.kind {
                Kind::Each(Each::Pre, _) => {}
                Kind::Flow(flow) if is_output(*flow) => return Some((*flow, expr.span)),
                Kind::Flow(flow) if seen.insert(*flow) => parts.also(self.values_of(*flow)),
                // What a mode requires is an assumption of its own contract: it reads no output of the cycle.
                kind => match self.mode_of(kind) {
                    Some(given) => parts.also(given),
                    None => parts.enter(id),
                },
            }
        }
        None
    }

    fn values_of(&self, flow: FlowId) -> impl Iterator<Item = ExprId> + '_ {
        let defines = move |equation: &&Equation| {
            let mut targets = equation.targets.iter();
            targets.any(|t| matches!(t.place, Place::Flow { flow: defined, .. } if defined == flow))
        };
        let equations = self.unit.blocks.iter().flat_map(|block| &block.equations);
        equations.filter(defines).map(|equation| equation.value)
    }
}
