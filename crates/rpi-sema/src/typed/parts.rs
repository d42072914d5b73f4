//! Walks over what an expression is made of, each part once: names for parts of patterns stand for shared expressions, so
//! that a short text may mean a tree without end.

use super::{Expr, ExprId, Kind, Unit};
use crate::hash::Set;

/// A walk on its way: each part is given before its operands, and these only if the walk is told to enter it.
pub(crate) struct Parts<'u> {
    unit: &'u Unit,
    open: Vec<ExprId>,
    entered: Set<ExprId>,
}

impl Unit {
    /// A walk that begins at an expression.
    pub(crate) fn parts(&self, root: ExprId) -> Parts<'_> {
        Parts {
            unit: self,
            open: vec![root],
            entered: Set::default(),
        }
    }
}

impl<'u> Parts<'u> {
    /// The next part.
    pub(crate) fn next(&mut self) -> Option<(ExprId, &'u Expr)> {
        let id = self.open.pop()?;
        Some((id, self.unit.expr(id)))
    }

    /// Goes on to the operands of a part, unless it has been there.
    pub(crate) fn enter(&mut self, id: ExprId) {
        let before = self.open.len();
        let kind: &Kind = &self.unit.expr(id).kind;
        kind.operands(&mut |operand| self.open.push(operand));
        if self.open.len() > before && !self.entered.insert(id) {
            self.open.truncate(before);
        }
    }

    /// Goes on to something else.
    pub(crate) fn also(&mut self, roots: impl IntoIterator<Item = ExprId>) {
        self.open.extend(roots);
    }
}
