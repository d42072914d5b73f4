//! Names that expressions bring in: variables of quantifiers and of conditions of types, parts of alternatives, indices.

use super::body::Body;
use crate::ty::Ty;
use crate::typed::{ExprId, Kind};
use rpi_diag::{Code, Finding, Span};
use rpi_syntax::Name;
use rpi_syntax::ast::{Expr, ExprKind, Ident};

/// A name that an expression brings in.
#[derive(Clone, Debug)]
pub(super) struct Bound {
    pub(super) name: Name,
    pub(super) means: Means,
    /// How many `pre` stood around where it was brought in.
    past: u32,
    span: Span,
}

/// What a bound name means.
#[derive(Clone, Debug)]
pub(super) enum Means {
    /// Any value of a type, of which a quantifier speaks.
    Any(Ty),
    /// A value of a type, for which a condition of the type is to hold.
    Value(Ty),
    /// What an expression gives.
    Expr(ExprId),
    /// An index of the array that an equation defines element by element.
    Index(i64),
}

/// Something that a claim speaks of and no run can show.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Unwatched(pub(super) Option<Span>);

impl<'a> Body<'_, 'a> {
    /// Checks something with one more name.
    pub(super) fn with_bound<T>(
        &mut self,
        name: &Ident,
        means: Means,
        work: impl FnOnce(&mut Self) -> T,
    ) -> T {
        self.bind_name(name, means);
        let result = work(self);
        self.bound.pop();
        result
    }

    pub(super) fn bind_name(&mut self, name: &Ident, means: Means) {
        self.bound.push(Bound {
            name: name.name.clone(),
            means,
            past: self.past,
            span: name.span,
        });
    }

    /// A bound name, read.
    pub(super) fn bound_name(&mut self, name: &Name, span: Span) -> Option<ExprId> {
        let at = self.bound.iter().rposition(|bound| bound.name == *name)?;
        let bound = self.bound[at].clone();
        Some(match &bound.means {
            Means::Index(value) => self.add(
                Kind::Literal(crate::typed::Leaf::int(*value)),
                Ty::Int,
                span,
            ),
            Means::Expr(value) => self.copy_of(*value, span),
            Means::Value(ty) => self.add(Kind::Outside, ty.clone(), span),
            Means::Any(_) if self.fixed_before.is_some_and(|before| at < before) => {
                self.not_fixed(&bound, span)
            }
            Means::Any(_) if self.past > bound.past => self.has_no_past(&bound, span),
            Means::Any(ty) => self.add(Kind::Outside, ty.clone(), span),
        })
    }

    fn copy_of(&mut self, value: ExprId, span: Span) -> ExprId {
        let expr = self.unit.expr(value);
        let (kind, ty) = (expr.kind.clone(), expr.ty.clone());
        self.add(kind, ty, span)
    }

    fn has_no_past(&mut self, bound: &Bound, span: Span) -> ExprId {
        let message = format!("`{}` has no earlier cycle", bound.name);
        let finding = Finding::new(Code::RPI2014, message)
            .at(span, "read after `pre`")
            .also(bound.span, "a quantifier speaks of all its values here")
            .help("write the `pre` around what is a flow");
        self.fault_with(finding, span)
    }

    fn not_fixed(&mut self, bound: &Bound, span: Span) -> ExprId {
        let finding = Finding::new(Code::RPI2008, "a constant is needed here")
            .at(span, "a variable of the same quantifier")
            .also(bound.span, "brought in here")
            .help("say it in the condition of the quantifier");
        self.fault_with(finding, span)
    }

    /// Whether an expression reads a name that a quantifier or an index brings in.
    pub(super) fn reads_bound(&self, expr: &Expr) -> bool {
        let mut open = vec![expr];
        while let Some(expr) = open.pop() {
            if let ExprKind::Name(name) = &expr.kind
                && self
                    .bound
                    .iter()
                    .any(|bound| bound.name == *name && bound.varies())
            {
                return true;
            }
            open.extend(expr.children());
        }
        false
    }
}

impl Bound {
    /// Whether it stands for several values in one cycle.
    pub(super) fn varies(&self) -> bool {
        matches!(self.means, Means::Any(_) | Means::Index(_))
    }

    pub(super) fn is_quantified(&self) -> bool {
        matches!(self.means, Means::Any(_))
    }
}
