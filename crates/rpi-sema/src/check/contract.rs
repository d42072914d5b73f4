//! Contracts: assumptions that the caller must satisfy, guarantees that the body must satisfy, and modes.
//!
//! A contract is a block inside the body that it describes. Nothing outside of it reads its names, so that it can be
//! omitted as a whole. The `ensure` of a mode becomes a guarantee under the condition of the mode's `require`; in every
//! cycle at least one mode must apply.

use super::body::Body;
use super::bound::Unwatched;
use crate::ty::Ty;
use crate::typed::{BlockId, Claim, ClaimKind, ExprId, FlowRole, Kind, Leaf};
use rpi_diag::{Code, Finding, Span};
use rpi_syntax::Name;
use rpi_syntax::ast::{self, Contract, ContractMode, Locals};
use rpi_syntax::ops::BinaryOp;

impl<'a> Body<'_, 'a> {
    /// Declares the names of a contract of the current block and returns its block.
    pub(super) fn declare_contract(&mut self, contract: &'a Contract) -> BlockId {
        let block = self.add_block(&Name::from("contract"), contract.span);
        self.unit.blocks[block.0 as usize].is_contract = true;
        self.within(block, |body| {
            for section in &contract.locals {
                match section {
                    Locals::Var(vars) => vars.iter().for_each(|var| {
                        var.names.iter().for_each(|name| body.hides_no_port(name));
                        body.declare_var(var);
                    }),
                    Locals::Const(defs) => defs.iter().for_each(|def| body.declare_const(def)),
                }
            }
            for together in &contract.together {
                together.vars.iter().for_each(|var| body.declare_var(var));
                body.declare_equation(&together.equation, together.span);
            }
            body.name_modes(contract);
            body.declare_imports(contract);
        });
        block
    }

    /// Reports a local name of a contract that is also the name of a port: the port would be hidden from the claims.
    fn hides_no_port(&mut self, name: &ast::Ident) {
        let is_twice_here = self.find_in(self.block, &name.name).is_some();
        if let Some(port) = self.port_called(&name.name).filter(|_| !is_twice_here) {
            let finding = crate::program::twice(&name.name, name.span, port);
            self.report(finding);
        }
    }

    /// Returns the location of the flow around a contract that has this name. The in-ports of a declared contract do
    /// not count, as they belong to the importing node.
    fn port_called(&self, name: &Name) -> Option<Span> {
        let flow = self.local_flow(name).map(|flow| self.unit.flow(flow));
        let flow = flow.filter(|flow| !self.is_contract || flow.role != FlowRole::Input);
        flow.map(|flow| flow.span)
    }

    /// Records the modes of a contract; reports a mode with the name of another mode or of a flow.
    fn name_modes(&mut self, contract: &'a Contract) {
        for (k, mode) in contract.modes.iter().enumerate() {
            let name = &mode.name;
            let twin = contract.modes[..k]
                .iter()
                .find(|m| m.name.name == name.name);
            let flow = self.port_called(&name.name);
            if let Some(first) = twin.map(|twin| twin.name.span).or(flow) {
                let finding = crate::program::twice(&name.name, name.span, first);
                self.report(finding);
            }
        }
        self.modes = contract.modes.iter().collect();
    }

    /// Checks `::m`, whether a mode of the contract applies, or `::c::m` for a mode of an imported contract.
    pub(super) fn mode_applies(&mut self, name: &str, span: Span) -> ExprId {
        if let Some((contract, mode)) = name.split_once("::") {
            return self.imported_mode_applies(contract, mode, span);
        }
        let Some(mode) = self
            .modes
            .iter()
            .copied()
            .find(|mode| mode.name.name == *name)
        else {
            let near =
                rpi_diag::suggest(name, self.modes.iter().map(|mode| mode.name.name.as_str()));
            let finding = super::report::unknown("mode", name, span, near);
            return self.fault_with(finding, span);
        };
        if self.open_modes.contains(&mode.name.name) {
            if std::mem::replace(&mut self.ringed_modes, true) {
                return self.fault(span);
            }
            let message = format!("dependency cycle: the mode `{name}` depends on itself");
            let finding = Finding::new(Code::RPI1007, message)
                .at(span, format!("the condition of `{name}` reads it"))
                .also(mode.name.span, "declared here");
            return self.fault_with(finding, span);
        }
        self.open_modes.push(mode.name.name.clone());
        let applies = self.requirements(mode);
        self.open_modes.pop();
        applies
    }

    /// Returns the condition under which a mode applies: the conjunction of its requirements.
    fn requirements(&mut self, mode: &'a ContractMode) -> ExprId {
        let requires = mode.requires.iter();
        let requires = requires
            .map(|claim| self.condition(&claim.condition, "a claim"))
            .collect();
        self.all(BinaryOp::And, requires, mode.name.span)
    }

    /// Checks the claims and modes of a contract in its block.
    pub(super) fn check_contract(&mut self, contract: &'a Contract) {
        for claim in &contract.claims {
            self.check_claim(claim, claim.condition.span);
        }
        let modes = contract.modes.iter();
        let applies: Vec<ExprId> = modes.map(|mode| self.check_mode(mode)).collect();
        let (Some(first), Some(last)) = (contract.modes.first(), contract.modes.last()) else {
            return;
        };
        let span = Span {
            end: last.name.span.end,
            ..first.name.span
        };
        self.applies.clone_from(&applies);
        let condition = self.all(BinaryOp::Or, applies, span);
        self.current().claims.push(Claim {
            kind: ClaimKind::Modes,
            condition,
            mode: None,
            label: None,
            span,
        });
    }

    /// Checks a mode and returns the condition under which it applies.
    fn check_mode(&mut self, mode: &'a ContractMode) -> ExprId {
        self.open_modes.push(mode.name.name.clone());
        let applies = self.requirements(mode);
        self.open_modes.pop();
        for ensure in &mode.ensures {
            let (label, span) = (label_of(ensure), ensure.condition.span);
            let Some(holds) = self.watched(&ensure.condition) else {
                continue;
            };
            let condition = self.binary_prim(BinaryOp::Implies, applies, holds, span);
            self.current().claims.push(Claim {
                kind: ClaimKind::Guarantee,
                condition,
                mode: Some(mode.name.name.clone()),
                label,
                span,
            });
        }
        applies
    }

    /// Joins conditions by an operator; returns `true` if there are none.
    fn all(&mut self, by: BinaryOp, conditions: Vec<ExprId>, span: Span) -> ExprId {
        let joined = conditions
            .into_iter()
            .reduce(|all, next| self.binary_prim(by, all, next, span));
        joined.unwrap_or_else(|| self.add(Kind::Literal(Leaf::bool(true)), Ty::Bool, span))
    }

    /// Checks the condition of a claim; returns `None` if no run can evaluate it.
    fn watched(&mut self, condition: &'a ast::Expr) -> Option<ExprId> {
        let before = self.findings.len();
        self.claim = Some(Unwatched::default());
        let value = self.condition(condition, "a claim");
        let Unwatched(Some(span)) = self.claim.take().unwrap_or_default() else {
            return Some(value);
        };
        if !self.has_error_since(before) {
            self.report(
                Finding::new(Code::RPI1013, "this claim is not checked at run time")
                    .at(span, "it ranges over more values than can be tested"),
            );
        }
        None
    }

    /// Checks a claim in a body or contract.
    pub(super) fn check_claim(&mut self, claim: &'a ast::Claim, span: Span) {
        let Some(mut condition) = self.watched(&claim.condition) else {
            return;
        };
        if let Some(provided) = &claim.provided {
            let provided = self.condition(provided, "the expression after `provided`");
            condition = self.binary_prim(BinaryOp::Implies, provided, condition, span);
        }
        self.current().claims.push(Claim {
            kind: kind_of(claim.kind),
            condition,
            mode: None,
            label: label_of(claim),
            span,
        });
    }
}

fn kind_of(kind: ast::ClaimKind) -> ClaimKind {
    match kind {
        ast::ClaimKind::Assert => ClaimKind::Assert,
        ast::ClaimKind::Check | ast::ClaimKind::Property => ClaimKind::Check,
        ast::ClaimKind::Assume => ClaimKind::Assume,
        ast::ClaimKind::Guarantee => ClaimKind::Guarantee,
    }
}

fn label_of(claim: &ast::Claim) -> Option<Name> {
    claim.label.as_ref().map(|label| label.name.clone())
}
