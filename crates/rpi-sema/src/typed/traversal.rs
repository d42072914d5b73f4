//! Traversal of an expression that visits each subexpression once. Names of pattern parts share subexpressions, so the
//! expanded tree can be exponentially larger than the source.

use crate::hash::FastSet;
use crate::typed::{Expr, TypedKind};
use crate::typed::{ExprId, Unit};

/// Traversal of expressions from some roots to their operands. An expression is returned before its operands. The
/// operands are visited only if [`enter`](Traversal::enter) is called for the expression.
pub(crate) struct Traversal<'u> {
    unit: &'u Unit,
    open: Vec<ExprId>,
    call_guard: FastSet<ExprId>,
}

impl Unit {
    /// Starts a traversal of the expressions of the unit at `root`.
    pub(crate) fn traverse(&self, root: ExprId) -> Traversal<'_> {
        Traversal {
            unit: self,
            open: vec![root],
            call_guard: FastSet::default(),
        }
    }
}

impl<'u> Traversal<'u> {
    /// Returns the next expression of the traversal; `None` at the end.
    pub(crate) fn next(&mut self) -> Option<(ExprId, &'u Expr)> {
        let id = self.open.pop()?;
        Some((id, self.unit.expr(id)))
    }

    /// Adds the operands of an expression to the traversal, unless they have been added before.
    pub(crate) fn enter(&mut self, id: ExprId) {
        let before = self.open.len();
        let kind: &TypedKind = &self.unit.expr(id).kind;
        kind.operands(&mut |operand| self.open.push(operand));
        // Expressions without operands are not recorded, which keeps the set small.
        if self.open.len() > before && !self.call_guard.insert(id) {
            self.open.truncate(before);
        }
    }

    /// Adds further expressions at which the traversal starts.
    pub(crate) fn add_roots(&mut self, roots: impl IntoIterator<Item = ExprId>) {
        self.open.extend(roots);
    }
}
