//! Contracts: what the caller sees to, what the body sees to, and what holds in which mode.
//!
//! A contract is a block of its own inside what it is about: its names are seen by nothing else, so that it can be left
//! out as a whole. A mode's `ensure` becomes a guarantee under the mode's `require`; and in every cycle some mode applies.

use super::body::Body;
use crate::ty::Ty;
use crate::typed::{BlockId, Claim, ClaimKind, ExprId, Kind, Leaf};
use rpi_diag::Span;
use rpi_syntax::Name;
use rpi_syntax::ast::{self, Contract, ContractMode, Locals};
use rpi_syntax::ops::BinaryOp;

impl<'a> Body<'_, 'a> {
    /// Declares the names of a contract of the current block.
    pub(super) fn declare_contract(&mut self, contract: &'a Contract) -> BlockId {
        let block = self.add_block(&Name::from("contract"), contract.span);
        self.unit.blocks[block.0 as usize].is_contract = true;
        self.within(block, |body| {
            for section in &contract.locals {
                match section {
                    Locals::Var(vars) => vars.iter().for_each(|var| body.declare_var(var)),
                    Locals::Const(defs) => defs.iter().for_each(|def| body.declare_const(def)),
                }
            }
        });
        block
    }

    /// Checks the claims of a contract, in its block.
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
        let condition = self.all(BinaryOp::Or, applies, span);
        self.current().claims.push(Claim {
            kind: ClaimKind::Modes,
            condition,
            mode: None,
            label: None,
            span,
        });
    }

    /// Checks a mode; gives the condition under which it applies.
    fn check_mode(&mut self, mode: &'a ContractMode) -> ExprId {
        let requires = mode.requires.iter();
        let requires = requires
            .map(|claim| self.condition(&claim.condition, "a claim"))
            .collect();
        let applies = self.all(BinaryOp::And, requires, mode.name.span);
        for ensure in &mode.ensures {
            let (label, span) = (label_of(ensure), ensure.condition.span);
            let holds = self.condition(&ensure.condition, "a claim");
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

    /// Conditions joined; true if there are none.
    fn all(&mut self, by: BinaryOp, conditions: Vec<ExprId>, span: Span) -> ExprId {
        let joined = conditions
            .into_iter()
            .reduce(|all, next| self.binary_prim(by, all, next, span));
        joined.unwrap_or_else(|| self.add(Kind::Literal(Leaf::bool(true)), Ty::Bool, span))
    }

    /// A claim in a body or contract.
    pub(super) fn check_claim(&mut self, claim: &'a ast::Claim, span: Span) {
        let condition = self.condition(&claim.condition, "a claim");
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
        ast::ClaimKind::Check => ClaimKind::Check,
        ast::ClaimKind::Assume => ClaimKind::Assume,
        ast::ClaimKind::Guarantee => ClaimKind::Guarantee,
    }
}

fn label_of(claim: &ast::Claim) -> Option<Name> {
    claim.label.as_ref().map(|label| label.name.clone())
}
