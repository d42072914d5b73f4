//! Mutable access to the subexpressions of an expression.

use super::{Access, Activation, Call, Expr, ExprKind, SliceBounds};

impl Expr {
    /// Calls `change` with every nested subexpression and with the expression itself, innermost first.
    pub(crate) fn for_each_mut(&mut self, change: &mut impl FnMut(&mut Expr)) {
        for part in self.children_mut() {
            part.for_each_mut(change);
        }
        change(self);
    }

    /// Returns the direct subexpressions for modification.
    pub(crate) fn children_mut(&mut self) -> Vec<&mut Expr> {
        match &mut self.kind {
            ExprKind::Bool(_)
            | ExprKind::Number(_)
            | ExprKind::Quantity(_)
            | ExprKind::Str(_)
            | ExprKind::EmptySet(_)
            | ExprKind::Name(_) => Vec::new(),
            ExprKind::Field(field) => vec![&mut field.base],
            ExprKind::Index(of) => vec![&mut of.base, &mut of.index],
            ExprKind::Slice(of) => [&mut of.base]
                .into_iter()
                .chain(bound_exprs(&mut of.slice))
                .collect(),
            ExprKind::BitRange(of) => vec![&mut of.base, &mut of.high, &mut of.low],
            ExprKind::Unary(_, inner) | ExprKind::Paren(inner) => vec![inner],
            ExprKind::Binary(of) => vec![&mut of.lhs, &mut of.rhs],
            ExprKind::When(of) => vec![&mut of.value],
            ExprKind::If(of) => vec![&mut of.condition, &mut of.then_value, &mut of.else_value],
            ExprKind::Call(call) => call_exprs(call),
            ExprKind::BoolList(_, all) | ExprKind::Tuple(all) | ExprKind::Array(all) => {
                all.iter_mut().collect()
            }
            ExprKind::Merge(merge) => {
                let cases = merge.cases.iter_mut().map(|case| &mut case.then);
                [&mut merge.selector].into_iter().chain(cases).collect()
            }
            ExprKind::Struct(of) => {
                let fields = of.fields.iter_mut().map(|field| &mut field.value);
                of.base.iter_mut().chain(fields).collect()
            }
            ExprKind::Quantified(of) => vec![&mut of.condition],
            ExprKind::Ascription(of) => vec![&mut of.value],
            ExprKind::ConstructorTest(of) => vec![&mut of.value],
            ExprKind::Match(of) => {
                let arms = of.arms.iter_mut().map(|arm| &mut arm.then);
                [&mut of.value].into_iter().chain(arms).collect()
            }
            ExprKind::Update(update) => {
                let changes = update.changes.iter_mut();
                let parts = changes.flat_map(|c| {
                    let path = c.path.iter_mut().flat_map(step_exprs);
                    path.chain([&mut c.value]).collect::<Vec<_>>()
                });
                [&mut update.base].into_iter().chain(parts).collect()
            }
        }
    }
}

fn bound_exprs(slice: &mut SliceBounds) -> impl Iterator<Item = &mut Expr> {
    [&mut slice.from, &mut slice.to]
        .into_iter()
        .chain(&mut slice.step)
}

fn step_exprs(step: &mut Access) -> Vec<&mut Expr> {
    match step {
        Access::Field(_) => Vec::new(),
        Access::Index(index) => vec![index],
        Access::Slice(slice) => bound_exprs(slice).collect(),
    }
}

fn call_exprs(call: &mut Call) -> Vec<&mut Expr> {
    let conditions: Vec<&mut Expr> = match &mut call.activation {
        Activation::Always => Vec::new(),
        Activation::Restart { every } => vec![every],
        Activation::Activate {
            every,
            restart,
            default,
        } => [every].into_iter().chain(restart).chain(default).collect(),
    };
    let args = call.args.iter_mut().map(|arg| &mut arg.value);
    conditions.into_iter().chain(args).collect()
}
