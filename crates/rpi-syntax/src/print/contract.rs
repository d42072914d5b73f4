//! Printing of contracts.

use super::Printer;
use super::layout::{Doc, concat, group, indent, nothing, text, word};
use crate::ast::*;
use rpi_diag::Span;

impl Printer<'_> {
    /// Prints a contract as `con ... noc` on lines of its own, or nothing.
    pub(super) fn contract(&mut self, contract: Option<&Contract>) -> Doc {
        let Some(contract) = contract else {
            return nothing();
        };
        let parts = self.contract_parts(contract);
        concat([Doc::Hard, word("con"), parts, Doc::Hard, word("noc")])
    }

    /// Prints the body of a `contract` declaration: `let ... tel`.
    pub(super) fn contract_alone(&mut self, contract: Option<&Contract>) -> Doc {
        let parts = contract.map_or_else(nothing, |contract| self.contract_parts(contract));
        concat([Doc::Hard, word("let"), parts, Doc::Hard, word("tel")])
    }

    /// Prints the parts of a contract in source order, so that comments stay with them; without a source, by kind.
    fn contract_parts(&mut self, contract: &Contract) -> Doc {
        let mut parts: Vec<(Span, Doc)> = Vec::new();
        for locals in &contract.locals {
            self.contract_locals(locals, &mut parts);
        }
        for together in &contract.together {
            parts.push((self.with_word(together.span), self.together(together)));
        }
        for import in &contract.imports {
            parts.push((import.call.span, self.contract_import(import)));
        }
        for claim in &contract.claims {
            let doc = concat([self.claim(claim), word(";")]);
            parts.push((self.with_word(claim_span(claim)), doc));
        }
        for mode in &contract.modes {
            parts.push((self.with_word(mode.name.span), self.mode(mode)));
        }
        if parts.is_empty() {
            return nothing();
        }
        parts.sort_by_key(|(span, _)| span.start);
        let lines = self.lines(
            &parts,
            |(span, _)| *span,
            |_, _, (_, doc)| (doc.clone(), false),
        );
        indent(concat([Doc::Hard, lines]))
    }

    /// Prints several ghost variables with one value: `var x: int, y: bool = e;`.
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

    /// Prints local declarations of a contract, each with its keyword: in a contract, a section has one declaration.
    fn contract_locals(&mut self, locals: &Locals, parts: &mut Vec<(Span, Doc)>) {
        let line = |head, doc| concat([word(head), doc, word(";")]);
        match locals {
            Locals::Var(vars) => {
                parts.extend(
                    vars.iter()
                        .map(|v| (self.with_word(v.span), line("var ", self.var_decl(v)))),
                );
            }
            Locals::Const(defs) => {
                parts.extend(
                    defs.iter()
                        .map(|d| (self.with_word(d.span), line("const ", self.const_def(d)))),
                );
            }
        }
    }

    fn mode(&mut self, mode: &ContractMode) -> Doc {
        let requires = mode.requires.iter().map(|claim| ("require ", claim));
        let ensures = mode.ensures.iter().map(|claim| ("ensure ", claim));
        let mut claims: Vec<(&'static str, &Claim)> = requires.chain(ensures).collect();
        claims.sort_by_key(|(_, claim)| claim_span(claim).start);
        let claim = |(head, claim): (&'static str, &Claim)| {
            concat([Doc::Line, word(head), self.condition(claim), word(";")])
        };
        let parts: Vec<Doc> = claims.into_iter().map(claim).collect();
        let head = text(format!("mode {} (", mode.name.name));
        group(concat([head, indent(concat(parts)), Doc::Line, word(");")]))
    }
}

fn claim_span(claim: &Claim) -> Span {
    let label = claim.label.as_ref().map_or(Span::NONE, |label| label.span);
    label.merge(claim.condition.span)
}
