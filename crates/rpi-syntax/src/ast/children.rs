//! Direct subexpressions of an expression, for generic traversals.

use super::{Access, Activation, Call, Expr, ExprKind, SliceBounds};

impl Expr {
    /// Returns the direct subexpressions in text order, except that the activation conditions of a call come before its
    /// arguments. Static arguments are left out, as they are not flows.
    pub fn children(&self) -> Vec<&Expr> {
        match &self.kind {
            ExprKind::Bool(_)
            | ExprKind::Number(_)
            | ExprKind::Quantity(_)
            | ExprKind::Str(_)
            | ExprKind::Name(_) => Vec::new(),
            ExprKind::Field(field) => vec![&field.base],
            ExprKind::Index(of) => vec![&of.base, &of.index],
            ExprKind::Slice(of) => [vec![&of.base], bound_exprs(&of.slice)].concat(),
            ExprKind::BitRange(of) => vec![&of.base, &of.high, &of.low],
            ExprKind::Unary(_, inner) | ExprKind::Paren(inner) => vec![inner],
            ExprKind::Binary(of) => vec![&of.lhs, &of.rhs],
            ExprKind::When(of) => vec![&of.value],
            ExprKind::If(of) => vec![&of.condition, &of.then_value, &of.else_value],
            ExprKind::Call(call) => call_exprs(call),
            ExprKind::BoolList(_, all) | ExprKind::Tuple(all) | ExprKind::Array(all) => {
                all.iter().collect()
            }
            ExprKind::Merge(merge) => {
                let cases = merge.cases.iter().map(|case| &case.then);
                [&merge.selector].into_iter().chain(cases).collect()
            }
            ExprKind::Struct(of) => {
                let fields = of.fields.iter().map(|field| &field.value);
                of.base.iter().chain(fields).collect()
            }
            ExprKind::Quantified(of) => vec![&of.condition],
            ExprKind::Ascription(of) => vec![&of.value],
            ExprKind::ConstructorTest(of) => vec![&of.value],
            ExprKind::EmptySet(_) => Vec::new(),
            ExprKind::Match(of) => {
                let arms = of.arms.iter().map(|arm| &arm.then);
                [&of.value].into_iter().chain(arms).collect()
            }
            ExprKind::Update(update) => {
                let changes = update.changes.iter();
                let parts = changes.flat_map(|c| [path_exprs(&c.path), vec![&c.value]].concat());
                [&update.base].into_iter().chain(parts).collect()
            }
        }
    }
}

fn bound_exprs(slice: &SliceBounds) -> Vec<&Expr> {
    [&slice.from, &slice.to]
        .into_iter()
        .chain(&slice.step)
        .collect()
}

/// Returns the index expressions and slice bounds in a path such as `.f[i][1..3]`, in text order.
pub(super) fn path_exprs(path: &[Access]) -> Vec<&Expr> {
    let step = |access| match access {
        &Access::Field(_) => Vec::new(),
        Access::Index(index) => vec![index],
        Access::Slice(slice) => bound_exprs(slice),
    };
    path.iter().flat_map(step).collect()
}

fn call_exprs(call: &Call) -> Vec<&Expr> {
    let conditions: Vec<&Expr> = match &call.activation {
        Activation::Always => Vec::new(),
        Activation::Restart { every } => vec![every],
        Activation::Activate {
            every,
            restart,
            default,
        } => [every].into_iter().chain(restart).chain(default).collect(),
    };
    let args = call.args.iter().map(|arg| &arg.value);
    conditions.into_iter().chain(args).collect()
}
