//! Constructs of Kind 2 that are for provers only (quantifiers, conditions of types, sets), and type ascriptions.

use crate::check::bodies::body::Body;
use crate::check::bodies::statement;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::ExpectationReason;
use crate::check::exprs::bindings;
use crate::check::exprs::bindings::BindingValue;
use crate::check::exprs::expr;
use crate::check::signatures::static_args;
use crate::check::types;
use crate::check::types::is_kind2_type;
use crate::program::{DeclKind, Lookup, NameSpace};
use crate::ty::{StructTy, Ty};
use crate::typed::TypedKind;
use crate::typed::{ExprId, UnitKind};
use rpi_diag::{Code, Diagnostic, Quote, Span, Subject};
use rpi_syntax::ast::{
    self, Ascription, Call, Expr, ExprKind, NodeDef, NodeKind, Quantified, RefinementType,
    StaticArg, TypeKind,
};
use std::rc::Rc;

/// Checks a quantifier such as `forall (x: int) c` and returns its typed expression. Its value is never computed; only
/// a model checker uses it.
pub(crate) fn check_quantifier<'a>(
    cx: &mut Body<'_, 'a>,
    of: &'a Quantified,
    span: Span,
) -> ExprId {
    let before = cx.bindings.bound_names.len();
    for var in &of.vars {
        let fixed = cx.bindings.forbidden.replace(cx.bindings.bound_names.len());
        let ty = types::resolve_type(cx, &var.ty);
        cx.bindings.forbidden = fixed;
        check_quantifiable(cx, &ty, &var.ty);
        for name in &var.names {
            bindings::bind_name(cx, name, BindingValue::Quantified(ty.clone()));
        }
    }
    let condition = expr::check_expr(cx, &of.condition);
    statement::expect_type(cx, condition, &Ty::Bool, &ExpectationReason::Unexplained);
    cx.bindings.bound_names.truncate(before);
    match &mut cx.contract.claim_check {
        Some(claim) => claim.0 = claim.0.or(Some(span)),
        None => not_executable(
            cx,
            "a quantifier",
            "a cycle cannot try all values of its variables",
            span,
        ),
    }
    cx.add(TypedKind::Arbitrary, Ty::Bool, span)
}

/// Reports a quantifier over arrays, sets or maps. `ty` is the type of the quantified variable.
fn check_quantifiable(cx: &mut Body<'_, '_>, ty: &Ty, written: &ast::Type) {
    let has_elements = matches!(ty, Ty::Array(..)) || is_kind2_type(ty, &["set<", "map<"]);
    if has_elements {
        let message = format!("cannot quantify over `{ty}`");
        let diagnostic = Diagnostic::new(Code::RPI2014, message)
            .primary(written.span, "not a quantifiable type")
            .help("quantify over numbers instead, such as the index of an array of the node: `forall (i: int) 0 <= i and i < 3 => ...`");
        report::report_diagnostic(cx, diagnostic);
    }
}

/// Reports a construct of Kind 2 that is checked but cannot be executed. `what` names the construct, and `why` is the
/// reason.
pub(crate) fn not_executable(cx: &mut Body<'_, '_>, what: &str, why: &str, span: Span) {
    let message = format!("{what} cannot be executed");
    let diagnostic = Diagnostic::new(Code::RPI0017, message)
        .primary(span, why)
        .help(replacement_help(what))
        .about(Subject::Construct(what.to_owned()));
    report::report_diagnostic(cx, diagnostic);
}

/// Returns what a program that runs can use in place of a construct that is for provers only.
fn replacement_help(construct: &str) -> &'static str {
    match construct {
        "a quantifier" => {
            "state it as `check ...;`, which a model checker such as Kind 2 proves, or compute it over the elements of an array with `red`"
        }
        "a set" | "a map" => {
            "store the elements in an array of a fixed size, such as `int^8`, with the number of used elements; or leave the node to a model checker such as Kind 2"
        }
        "a history" => {
            "read the values of earlier cycles with `pre`, or leave the node to a model checker such as Kind 2"
        }
        "a machine integer of more than 64 bits" => {
            "use at most 64 bits, or several machine integers; or leave the node to a model checker such as Kind 2"
        }
        _ => "leave it to a model checker such as Kind 2, or write it without this construct",
    }
}

/// Checks `subtype { x: T | c }` and returns the type `T`. The condition `c` is not enforced at run time; only provers
/// use it.
pub(crate) fn refinement_type<'a>(cx: &mut Body<'_, 'a>, refined: &'a RefinementType) -> Ty {
    let base = types::resolve_type(cx, &refined.base);
    let in_quantifier = cx.bindings.forbidden.is_some() || check_in_quantifier(cx);
    let means = match in_quantifier {
        true => BindingValue::Quantified(base.clone()),
        false => BindingValue::Refined(base.clone()),
    };
    bindings::with_binding(cx, &refined.name, means, |body| {
        let condition = expr::check_expr(body, &refined.condition);
        statement::expect_type(body, condition, &Ty::Bool, &ExpectationReason::Unexplained);
    });
    base
}

/// Returns whether the current expression is inside of a quantifier.
pub(crate) fn check_in_quantifier(cx: &Body<'_, '_>) -> bool {
    cx.bindings
        .bound_names
        .iter()
        .any(crate::check::exprs::bindings::Binding::is_quantified)
}

/// Checks a type ascription `(x: T)`, which states the type of a value, and returns the typed expression of `x`.
pub(crate) fn ascription<'a>(cx: &mut Body<'_, 'a>, of: &'a Ascription) -> ExprId {
    let value = expr::check_expr(cx, &of.value);
    let ty = types::resolve_type(cx, &of.ty);
    let before = cx.diagnostics.len();
    statement::expect_type(
        cx,
        value,
        &ty,
        &ExpectationReason::Because(of.ty.span, "expected because of this type".into()),
    );
    let help = format!(
        "write the type of the value, `({}: {})`, or leave it out",
        Quote::text(cx.span_of(value)),
        cx.ty_of(value)
    );
    if let Some(diagnostic) = cx.diagnostics.get_mut(before) {
        diagnostic.help = vec![help];
    }
    if is_temporal_type(cx, &of.ty) && bindings::reads_binding(cx, &of.value) {
        let diagnostic =
            Diagnostic::new(Code::RPI2014, "a quantified variable has no earlier cycles")
                .primary(of.value.span, "this depends on a quantified variable")
                .secondary(
                    of.ty.span,
                    "the condition of the type refers to earlier cycles",
                );
        report::report_diagnostic(cx, diagnostic);
    }
    value
}

/// Whether a type is declared with a condition that refers to earlier cycles, as by `pre`.
fn is_temporal_type(cx: &Body<'_, '_>, ty: &ast::Type) -> bool {
    match &ty.kind {
        TypeKind::Named(named) => {
            let found = cx
                .checker
                .program
                .lookup_in(NameSpace::Type, cx.module, &named.name.name);
            matches!(found, Lookup::Found(id) if cx.checker.temporal_types.contains(&id))
        }
        TypeKind::Array(array) => is_temporal_type(cx, &array.element),
        _ => false,
    }
}

/// Reports a call inside of a quantifier that depends on the quantified variable, if the callee has state or no known
/// body.
pub(crate) fn check_call_in_quantifier<'a>(
    cx: &mut Body<'_, 'a>,
    call: &'a Call,
    id: crate::program::DeclId,
    span: Span,
) {
    if !check_in_quantifier(cx) {
        return;
    }
    let DeclKind::Node(node) = cx.checker.program.decl(id).kind else {
        return;
    };
    let opaque = node.kind == NodeKind::Node || matches!(node.definition, NodeDef::Extern);
    let reads = call
        .args
        .iter()
        .any(|arg| bindings::reads_binding(cx, &arg.value));
    if opaque && (reads || cx.bindings.in_guarded_branch) {
        let message = format!(
            "cannot call `{}` for a quantified variable",
            call.callee.name.name
        );
        let diagnostic = Diagnostic::new(Code::RPI2014, message)
            .primary(span, "the call depends on a quantified variable")
            .help("only functions with a known body can be called here");
        report::report_diagnostic(cx, diagnostic);
    }
}

/// Checks the empty set `{}@<T>` of Kind 2 and returns its typed expression.
pub(crate) fn empty_set<'a>(cx: &mut Body<'_, 'a>, types: &'a [StaticArg], span: Span) -> ExprId {
    let known: Vec<Ty> = types
        .iter()
        .filter_map(|ty| static_args::static_type(cx, ty))
        .collect();
    let ty = match &known[..] {
        [one] => set_type(one),
        _ => Ty::Unknown,
    };
    not_executable(cx, "a set", WHY_NO_SETS, span);
    cx.add(TypedKind::Arbitrary, ty, span)
}

/// Checks the membership test `x in s` of Kind 2 and returns its typed expression.
pub(crate) fn membership<'a>(
    cx: &mut Body<'_, 'a>,
    lhs: &'a Expr,
    rhs: &'a Expr,
    span: Span,
) -> ExprId {
    let (value, set) = (expr::check_expr(cx, lhs), expr::check_expr(cx, rhs));
    let (found, of) = (cx.ty_of(value).clone(), cx.ty_of(set).clone());
    if !of.is_unknown() && !is_kind2_type(&of, &["set<", "map<"]) {
        let diagnostic = Diagnostic::new(
            Code::RPI2006,
            format!("`in` cannot take `{found}` and `{of}`"),
        )
        .primary(rhs.span, format!("this is `{of}`"))
        .help(comparison_help(lhs, rhs));
        report::report_diagnostic(cx, diagnostic);
    }
    cx.add(TypedKind::Arbitrary, Ty::Bool, span)
}

/// Returns the comparisons for `x in [1, 2]`: with each value, and with the first and the last one as bounds.
fn comparison_help(lhs: &Expr, rhs: &Expr) -> String {
    let value = Quote::operand(lhs.span);
    let elements = match &rhs.unparen().kind {
        ExprKind::Array(elements) => &elements[..],
        _ => &[],
    };
    match elements {
        [first, .., last] => {
            let [first, last] = [first, last].map(|bound| Quote::operand(bound.span));
            format!(
                "for two values write `{value} = {first} or {value} = {last}`; for a range, `{value} >= {first} and {value} <= {last}`"
            )
        }
        _ => format!("compare with each value: `{value} = ... or {value} = ...`"),
    }
}

/// Reports a nondeterministic value in the definition of a constant.
pub(crate) fn nondeterminism_in_constant(cx: &mut Body<'_, '_>, span: Span) {
    if cx.unit.kind == UnitKind::Constant {
        let diagnostic = Diagnostic::new(Code::RPI2008, "a constant is needed here")
            .primary(span, "this may change from cycle to cycle")
            .help("write a number or another constant in its place");
        report::report_diagnostic(cx, diagnostic);
    }
}

/// Reason, for messages, why sets and maps of Kind 2 are not executed.
pub(crate) const WHY_NO_SETS: &str =
    "its size is unbounded, and a control core does not allocate memory at run time";

/// Returns the type `set<T>` of Kind 2 for an element type `T`. Values of this type cannot be computed.
pub(crate) fn set_type(element: &Ty) -> Ty {
    opaque_type(format!("set<{element}>"))
}

/// Returns a type of Kind 2 of which the compiler knows only the name.
pub(crate) fn opaque_type(name: String) -> Ty {
    Ty::Struct(Rc::new(StructTy {
        name: name.into(),
        fields: Vec::new(),
        defaults: Vec::new(),
    }))
}
