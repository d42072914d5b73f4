//! Contracts.

use super::Printer;
use super::layout::{Doc, concat, group, indent, nothing, text, word};
use crate::ast::*;
use rpi_diag::Span;

impl Printer<'_> {
    /// `con ... noc` on lines of its own, if there is one.
    pub(super) fn contract(&mut self, contract: Option<&Contract>) -> Doc {
        let Some(contract) = contract else {
            return nothing();
        };
        let parts = self.contract_parts(contract);
        concat([Doc::Hard, word("con"), parts, Doc::Hard, word("noc")])
    }

    /// A contract by itself, `let ... tel`.
    pub(super) fn contract_alone(&mut self, contract: Option<&Contract>) -> Doc {
        let parts = contract.map_or_else(nothing, |contract| self.contract_parts(contract));
        concat([Doc::Hard, word("let"), parts, Doc::Hard, word("tel")])
    }

    fn contract_parts(&mut self, contract: &Contract) -> Doc {
        let locals = contract
            .locals
            .iter()
            .flat_map(|l| self.contract_locals(l))
            .collect::<Vec<_>>();
        let together = contract
            .together
            .iter()
            .flat_map(|together| [Doc::Hard, self.together(together)])
            .collect::<Vec<_>>();
        let claims = self.claims(&contract.claims);
        let modes = contract
            .modes
            .iter()
            .flat_map(|m| [Doc::Hard, self.mode(m)])
            .collect::<Vec<_>>();
        let imports = contract
            .imports
            .iter()
            .flat_map(|import| [Doc::Hard, self.contract_import(import)])
            .collect::<Vec<_>>();
        indent(concat([
            concat(locals),
            concat(together),
            concat(imports),
            claims,
            concat(modes),
        ]))
    }

    /// `var x: int, y: bool = e;`
    fn together(&mut self, together: &Together) -> Doc {
        let vars = together.vars.iter().enumerate().flat_map(|(i, var)| {
            let comma = word(if i == 0 { "" } else { ", " });
            [comma, self.var_decl(var)]
        });
        let vars = concat(vars.collect::<Vec<_>>());
        let value = self.expr(&together.equation.value);
        concat([word("var "), vars, word(" = "), value, word(";")])
    }

    fn contract_import(&mut self, import: &ContractImport) -> Doc {
        let ExprKind::Call(call) = &import.call.kind else {
            return nothing();
        };
        let (inputs, outputs) = call.args.split_at(import.inputs.min(call.args.len()));
        let callee = self.callee(&call.callee);
        let inputs = self.args(inputs);
        let outputs = self.args(outputs);
        concat([
            word("import "),
            callee,
            inputs,
            word(" returns "),
            outputs,
            word(";"),
        ])
    }

    /// Each with its word before it: in a contract, a section has one declaration.
    fn contract_locals(&mut self, locals: &Locals) -> Vec<Doc> {
        let line = |head, doc| [Doc::Hard, word(head), doc, word(";")];
        match locals {
            Locals::Var(vars) => vars
                .iter()
                .flat_map(|v| line("var ", self.var_decl(v)))
                .collect(),
            Locals::Const(defs) => defs
                .iter()
                .flat_map(|d| line("const ", self.const_def(d)))
                .collect(),
        }
    }

    fn claims(&mut self, claims: &[Claim]) -> Doc {
        if claims.is_empty() {
            return nothing();
        }
        let lines = self.lines(claims, claim_span, |p, _, claim| {
            (concat([p.claim(claim), word(";")]), false)
        });
        concat([Doc::Hard, lines])
    }

    fn mode(&mut self, mode: &ContractMode) -> Doc {
        let require = |p: &mut Self, claim: &Claim, head: &'static str| {
            concat([Doc::Line, word(head), p.condition(claim), word(";")])
        };
        let mut parts: Vec<Doc> = mode
            .requires
            .iter()
            .map(|c| require(self, c, "require "))
            .collect();
        parts.extend(mode.ensures.iter().map(|c| require(self, c, "ensure ")));
        let head = text(format!("mode {} (", mode.name.name));
        group(concat([head, indent(concat(parts)), Doc::Line, word(");")]))
    }
}

fn claim_span(claim: &Claim) -> Span {
    let label = claim.label.as_ref().map_or(Span::NONE, |label| label.span);
    label.merge(claim.condition.span)
}
