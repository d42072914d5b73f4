//! Names bound by expressions: variables of quantifiers and of refinement types, parts of alternatives in a `match`,
//! and array indices.

use crate::check::bodies::body::Body;
use crate::ty::Ty;
use crate::typed::ExprId;
use crate::typed::TypedKind;
use rpi_diag::{Code, Diagnostic, Span};
use rpi_syntax::Name;
use rpi_syntax::ast::{Expr, ExprKind, Ident};

/// Name that an expression gives to a value: the variable of a quantifier, the value in a refinement type, the part of
/// a value in a pattern, or an array index.
#[derive(Clone, Debug)]
pub(crate) struct Binding {
    pub(crate) name: Name,
    /// Value for which the name stands.
    pub(crate) value: BindingValue,
    /// Number of delay operators such as `pre` around the place where the name is bound. A quantified variable must not
    /// be read under more of them.
    pre_depth: u32,
    /// Location at which the name is bound.
    span: Span,
}

/// Value or type for which a bound name stands.
#[derive(Clone, Debug)]
pub(crate) enum BindingValue {
    /// Variable of a quantifier: stands for all values of the type.
    Quantified(Ty),
    /// Value whose type is a refinement type, in the condition of that type, as `x` in `subtype { x: int | x > 0 }`.
    Refined(Ty),
    /// Expression to which a pattern or a mode of a contract gives the name.
    Expr(ExprId),
    /// Array index with this value, in the equation of one array element.
    Index(i64),
}

/// Location of the first part of a claim that cannot be evaluated at run time, such as a quantifier; `None` if all of
/// it can be evaluated.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct NotEvaluable(pub(crate) Option<Span>);

/// Runs `work` while `name` stands for the value `means`, and returns the result of `work`.
pub(crate) fn with_binding<'c, 'a, T>(
    cx: &mut Body<'c, 'a>,
    name: &Ident,
    means: BindingValue,
    work: impl FnOnce(&mut Body<'c, 'a>) -> T,
) -> T {
    bind_name(cx, name, means);
    let result = work(cx);
    cx.bindings.bound_names.pop();
    result
}

/// Makes `name` stand for the value `means`. The caller must later remove the name from the list of bound names.
pub(crate) fn bind_name(cx: &mut Body<'_, '_>, name: &Ident, means: BindingValue) {
    cx.bindings.bound_names.push(Binding {
        name: name.name.clone(),
        value: means,
        pre_depth: cx.bindings.pre_depth,
        span: name.span,
    });
}

/// Returns an expression for a name that an expression around it binds; `None` if the name is not bound. Reports a
/// quantified variable where it is not allowed.
pub(crate) fn read_binding(cx: &mut Body<'_, '_>, name: &Name, span: Span) -> Option<ExprId> {
    let at = cx
        .bindings
        .bound_names
        .iter()
        .rposition(|bound| bound.name == *name)?;
    let bound = cx.bindings.bound_names[at].clone();
    Some(match &bound.value {
        BindingValue::Index(value) => cx.add(
            TypedKind::Literal(crate::typed::Leaf::int(*value)),
            Ty::Int,
            span,
        ),
        BindingValue::Expr(value) => copy_of(cx, *value, span),
        BindingValue::Refined(ty) => cx.add(TypedKind::Arbitrary, ty.clone(), span),
        BindingValue::Quantified(_) if cx.bindings.forbidden.is_some_and(|before| at < before) => {
            report_not_constant(cx, &bound, span)
        }
        BindingValue::Quantified(_) if cx.bindings.pre_depth > bound.pre_depth => {
            report_pre_of_quantified(cx, &bound, span)
        }
        BindingValue::Quantified(ty) => cx.add(TypedKind::Arbitrary, ty.clone(), span),
    })
}

fn copy_of(cx: &mut Body<'_, '_>, value: ExprId, span: Span) -> ExprId {
    let expr = cx.unit.expr(value);
    let (kind, ty) = (expr.kind.clone(), expr.ty.clone());
    cx.add(kind, ty, span)
}

fn report_pre_of_quantified(cx: &mut Body<'_, '_>, bound: &Binding, span: Span) -> ExprId {
    let message = format!(
        "the quantified variable `{}` has no earlier cycles",
        bound.name
    );
    let diagnostic = Diagnostic::new(Code::RPI2014, message)
        .primary(span, "read inside `pre`")
        .secondary(bound.span, "quantified here")
        .help("apply `pre` to flows only");
    cx.report_error_expr(diagnostic, span)
}

fn report_not_constant(cx: &mut Body<'_, '_>, bound: &Binding, span: Span) -> ExprId {
    let diagnostic = Diagnostic::new(Code::RPI2008, "a constant is needed here")
        .primary(span, "variable of the same quantifier")
        .secondary(bound.span, "bound here")
        .help("move this restriction to the condition of the quantifier");
    cx.report_error_expr(diagnostic, span)
}

/// Whether an expression reads the variable of a quantifier or an array index.
pub(crate) fn reads_binding(cx: &Body<'_, '_>, expr: &Expr) -> bool {
    let mut open = vec![expr];
    while let Some(expr) = open.pop() {
        if let ExprKind::Name(name) = &expr.kind
            && cx
                .bindings
                .bound_names
                .iter()
                .any(|bound| bound.name == *name && bound.has_many_values())
        {
            return true;
        }
        open.extend(expr.children());
    }
    false
}

impl Binding {
    /// Whether the name stands for several values in one cycle, as the variable of a quantifier or an array index does.
    pub(crate) fn has_many_values(&self) -> bool {
        matches!(
            self.value,
            BindingValue::Quantified(_) | BindingValue::Index(_)
        )
    }

    /// Returns whether the name is the variable of a quantifier.
    pub(crate) fn is_quantified(&self) -> bool {
        matches!(self.value, BindingValue::Quantified(_))
    }
}
