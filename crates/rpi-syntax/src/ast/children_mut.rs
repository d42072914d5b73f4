//! Mutable access to the subexpressions of an expression.

use super::{Access, Activation, Call, Expr, ExprKind, Slice};

impl Expr {
    /// Calls `change` with every subexpression and the expression itself, innermost first.
    pub(crate) fn each_mut(&mut self, change: &mut impl FnMut(&mut Expr)) {
        for part in self.children_mut() {
            part.each_mut(change);
        }
        change(self);
    }

    /// Returns the direct subexpressions.
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
                .chain(bounds(&mut of.slice))
                .collect(),
            ExprKind::Bits(of) => vec![&mut of.base, &mut of.high, &mut of.low],
            ExprKind::Unary(_, inner) | ExprKind::Paren(inner) => vec![inner],
            ExprKind::Binary(of) => vec![&mut of.lhs, &mut of.rhs],
            ExprKind::When(of) => vec![&mut of.value],
            ExprKind::If(of) => vec![&mut of.condition, &mut of.yes, &mut of.no],
            ExprKind::Call(call) => of_call(call),
            ExprKind::Among(_, all) | ExprKind::Tuple(all) | ExprKind::Array(all) => {
                all.iter_mut().collect()
            }
            ExprKind::Merge(merge) => {
                let cases = merge.cases.iter_mut().map(|case| &mut case.then);
                [&mut merge.on].into_iter().chain(cases).collect()
            }
            ExprKind::Struct(of) => {
                let fields = of.fields.iter_mut().map(|field| &mut field.value);
                of.base.iter_mut().chain(fields).collect()
            }
            ExprKind::Quantified(of) => vec![&mut of.condition],
            ExprKind::Ascribed(of) => vec![&mut of.value],
            ExprKind::IsA(of) => vec![&mut of.value],
            ExprKind::Match(of) => {
                let arms = of.arms.iter_mut().map(|arm| &mut arm.then);
                [&mut of.value].into_iter().chain(arms).collect()
            }
            ExprKind::Update(update) => {
                let changes = update.changes.iter_mut();
                let parts = changes.flat_map(|c| {
                    let path = c.path.iter_mut().flat_map(of_step);
                    path.chain([&mut c.value]).collect::<Vec<_>>()
                });
                [&mut update.base].into_iter().chain(parts).collect()
            }
        }
    }
}

fn bounds(slice: &mut Slice) -> impl Iterator<Item = &mut Expr> {
    [&mut slice.from, &mut slice.to]
        .into_iter()
        .chain(&mut slice.step)
}

fn of_step(step: &mut Access) -> Vec<&mut Expr> {
    match step {
        Access::Field(_) => Vec::new(),
        Access::Index(index) => vec![index],
        Access::Slice(slice) => bounds(slice).collect(),
    }
}

fn of_call(call: &mut Call) -> Vec<&mut Expr> {
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
