//! Sampled flows.

use super::families::Family;
use super::scope::Scope;
use super::signal::{Signal, Wire};
use super::{At, Elab};
use crate::typed::ExprId;
use rpi_diag::Span;

impl<'u> Elab<'u> {
    /// Where an expression is evaluated: in the fragment of its clock.
    pub(super) fn placed(&mut self, _scope: &mut Scope<'u>, _id: ExprId, at: At) -> At {
        at
    }

    /// `merge c (...)`: exactly one case is there.
    pub(super) fn merge(
        &mut self,
        scope: &mut Scope<'u>,
        _on: ExprId,
        cases: &'u [(u32, ExprId)],
        id: ExprId,
        at: At,
    ) -> Wire {
        let span = scope.unit.expr(id).span;
        let scalars = super::expr::leaf_scalars(&scope.unit.expr(id).ty);
        let wires: Vec<Wire> = cases
            .iter()
            .map(|(_, id)| self.expr(scope, *id, at))
            .collect();
        let mut leaves = Vec::with_capacity(scalars.len());
        for (k, scalar) in scalars.into_iter().enumerate() {
            let mut cases = wires.iter().filter_map(|wire| wire.get(k)).cloned();
            let first = cases.next().unwrap_or(Signal::Absent);
            let merge = |all, next| self.family(Family::Coalesce, scalar, &[all, next], at, span);
            leaves.push(cases.fold(first, merge));
        }
        leaves.into()
    }

    /// `current x`: the latest value.
    pub(super) fn current(
        &mut self,
        scope: &mut Scope<'u>,
        operand: ExprId,
        at: At,
        _span: Span,
    ) -> Wire {
        self.expr(scope, operand, at)
    }
}
