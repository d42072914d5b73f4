//! Operators on clocks: `when`, `merge`, `current`; and `last` in automata.

use crate::check::bodies::automaton;
use crate::check::bodies::body::Body;
use crate::check::bodies::locals;
use crate::check::bodies::locals::Local;
use crate::check::bodies::statement;
use crate::check::bodies::type_inference;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::ExpectationReason;
use crate::check::diagnostics::report::join_names;
use crate::check::diagnostics::report::undefined_name;
use crate::check::diagnostics::report::wrong_kind_of_name;
use crate::check::diagnostics::undefined_names::{declaration_help, report_undefined_flow};
use crate::check::exprs::access;
use crate::check::exprs::case;
use crate::check::exprs::expr;
use crate::check::exprs::names;
use crate::check::signatures::unit;
use crate::hash::{FastMap, FastSet};
use crate::ty::{EnumTy, Ty, join};
use crate::typed::{DeclaredClock, ExprId, FlowId};
use crate::typed::{ElementwiseOp, TypedKind};
use rpi_diag::{Code, Diagnostic, Quote, Span};
use rpi_syntax::ast::{self, Clock, ClockValue, Ident, Merge, WhenExpr};
use std::rc::Rc;

/// Checks `x when c` (a flow sampled at a clock) and returns its typed expression.
pub(crate) fn when_expr<'a>(cx: &mut Body<'_, 'a>, when: &'a WhenExpr, span: Span) -> ExprId {
    let value = expr::check_expr(cx, &when.value);
    let ty = cx.ty_of(value).clone();
    match resolve_clock(cx, &when.clock) {
        Some(clock) => cx.add(TypedKind::When { value, clock }, ty, span),
        None => cx.add(TypedKind::Error, ty, span),
    }
}

/// Returns the resolved form of a clock: the flow that is its condition, and the value of that flow for which the clock
/// ticks. Reports an unsuitable flow and returns `None`.
pub(crate) fn resolve_clock(cx: &mut Body<'_, '_>, clock: &Clock) -> Option<DeclaredClock> {
    cx.unit.has_clocks = true;
    let flow = resolve_clock_flow(cx, &clock.flow)?;
    let value = match &clock.value {
        ClockValue::True => 1,
        ClockValue::False => 0,
        ClockValue::Value(value) => return resolve_clock_value(cx, flow, value),
    };
    let ty = cx.unit.flow(flow).ty.clone();
    if !matches!(ty, Ty::Bool | Ty::Unknown) {
        if !cx
            .reported
            .invalid_clocks
            .record(&flow, cx.diagnostics.len())
        {
            return None;
        }
        let diagnostic = Diagnostic::new(Code::RPI2001, format!("expected `bool`, found `{ty}`"))
            .primary(
                clock.flow.span,
                "a clock must be a Boolean or one value of an enum",
            )
            .help(match ty {
                Ty::Enum(ref enum_ty) => format!(
                    "name the value of the enum for which the clock ticks: `when {}({})`",
                    enum_ty.values.first().map_or("...", |value| value.as_str()),
                    clock.flow.name
                ),
                _ => format!(
                    "define a Boolean flow, such as `is_on = {0} {1};`, and sample by it: `when is_on`",
                    clock.flow.name,
                    if ty == Ty::Int { "<> 0".to_owned() } else { format!("> {}", ty.zero_literal().unwrap_or("0".to_owned())) }
                ),
            });
        report::report_diagnostic(cx, diagnostic);
        return None;
    }
    Some(DeclaredClock { flow, value })
}

/// Returns the flow with the name that a clock has as its condition. Reports a name that is not a flow and returns
/// `None`.
fn resolve_clock_flow(cx: &mut Body<'_, '_>, name: &Ident) -> Option<FlowId> {
    match locals::find_local(cx, &name.name) {
        Some(Local::Flow(flow)) => {
            if cx.inference.is_running {
                type_inference::record_unknown_read(cx, flow, name.span);
            }
            Some(flow)
        }
        Some(_) => {
            let diagnostic =
                wrong_kind_of_name("a flow", &name.name, "a constant", name.span, name.span);
            report::report_diagnostic(cx, diagnostic);
            None
        }
        None => {
            if cx.record_undefined(&name.name) {
                let near = cx.checker.suggest(&name.name, locals::local_names(cx));
                let help = near.is_none().then(|| declaration_help(cx, &name.name));
                let mut diagnostic = undefined_name("flow", &name.name, name.span, near);
                diagnostic.help.extend(help);
                report_undefined_flow(cx, &name.name, diagnostic);
            }
            None
        }
    }
}

/// Returns the clock that ticks while `flow` has the given enum or Boolean value. Reports an unknown value and returns
/// `None`.
fn resolve_clock_value(
    cx: &mut Body<'_, '_>,
    flow: FlowId,
    value: &Ident,
) -> Option<DeclaredClock> {
    let ty = cx.unit.flow(flow).ty.clone();
    let value = value_number(cx, &ty, value)?;
    Some(DeclaredClock { flow, value })
}

/// Returns the number of a Boolean value (0 or 1) or of an enum value (its index). Reports an unknown value and returns
/// `None`.
fn value_number(cx: &mut Body<'_, '_>, ty: &Ty, value: &Ident) -> Option<u32> {
    let name = value.name.as_str();
    match ty {
        Ty::Bool if name == "true" => Some(1),
        Ty::Bool if name == "false" => Some(0),
        Ty::Enum(e) => enum_value_number(cx, e, value),
        Ty::Unknown => None,
        _ => {
            let diagnostic =
                Diagnostic::new(Code::RPI2006, format!("`{name}` is not a value of `{ty}`"))
                    .primary(
                        value.span,
                        "a clock must be a Boolean or one value of an enum",
                    );
            report::report_diagnostic(cx, diagnostic);
            None
        }
    }
}

fn enum_value_number(cx: &mut Body<'_, '_>, e: &Rc<EnumTy>, value: &Ident) -> Option<u32> {
    let last = value.name.rsplit("::").next().unwrap_or_default();
    let index = e.index_of(last);
    if index.is_none() {
        let near = rpi_diag::suggest(last, e.values.iter().map(|v| v.as_str()));
        let of = format!("the enum `{}`", e.name);
        let diagnostic = crate::check::diagnostics::report::no_member(&of, last, value.span, near);
        report::report_diagnostic(cx, diagnostic);
    }
    index
}

/// Checks `merge c (A -> x) (B -> y)`, which takes its value from the case for the current value of `c`, and returns
/// its typed expression.
pub(crate) fn merge_expr<'a>(cx: &mut Body<'_, 'a>, merge: &'a Merge, span: Span) -> ExprId {
    cx.unit.has_clocks = true;
    let on = expr::check_expr(cx, &merge.selector);
    let of = merge_condition_type(cx, on);
    let mut cases: Vec<(u32, ExprId)> = Vec::new();
    let mut first: FastMap<u32, Span> = FastMap::default();
    let (mut ty, mut known) = (Ty::Unknown, true);
    for case in &merge.cases {
        let mut then = expr::check_expr(cx, &case.then);
        ty = case_type(cx, ty, &cases, then);
        let value = value_number(cx, &of, &case.value);
        known &= value.is_some();
        if let Some(value) = value {
            then = case::sample_activated_case(cx, on, value, then);
            match first.get(&value) {
                Some(first) => report::report_diagnostic(cx, duplicate_case(&case.value, *first)),
                None => {
                    first.insert(value, cx.span_of(then));
                    cases.push((value, then));
                }
            }
        }
    }
    // Not reported beside an unknown case, which may be the missing one.
    if known {
        check_exhaustive_merge(cx, &of, &cases, span);
    }
    let cases = cases.into();
    cx.add(TypedKind::Merge { on, cases }, ty, span)
}

/// Returns the type of the condition of a `merge`. Reports a type that is neither Boolean nor an enum and returns
/// `Unknown`.
fn merge_condition_type(cx: &mut Body<'_, '_>, on: ExprId) -> Ty {
    let ty = cx.ty_of(on).clone();
    if matches!(ty, Ty::Bool | Ty::Enum(_) | Ty::Unknown) {
        return ty;
    }
    if let TypedKind::Flow(flow) = cx.unit.expr(on).kind {
        cx.reported
            .invalid_clocks
            .record(&flow, cx.diagnostics.len());
    }
    let message = format!("expected a Boolean or an enum in `merge`, found `{ty}`");
    let diagnostic =
        Diagnostic::new(Code::RPI2006, message).primary(cx.span_of(on), format!("this is `{ty}`"));
    report::report_diagnostic(
        cx,
        diagnostic.help(format!(
            "choose by a number with `if`: `if {} = 0 then ... else ...`",
            report::operand_name(cx, on)
        )),
    );
    Ty::Unknown
}

/// Returns the common type of the cases of a `merge` up to and including `then`. `cases` are the earlier cases, and
/// `so_far` is their common type.
fn case_type(cx: &mut Body<'_, '_>, so_far: Ty, cases: &[(u32, ExprId)], then: ExprId) -> Ty {
    let Some((_, first)) = cases.first() else {
        return cx.ty_of(then).clone();
    };
    let common = expr::common_type(cx, *first, then, "all cases must have the same type");
    join(&so_far, &common).unwrap_or(so_far)
}

/// Reports values of the condition for which a `merge` has no case. `of` is the type of the condition, and `cases` are
/// the numbers of the values with their expressions.
fn check_exhaustive_merge(cx: &mut Body<'_, '_>, of: &Ty, cases: &[(u32, ExprId)], span: Span) {
    let names: Vec<&str> = match of {
        Ty::Bool => vec!["false", "true"],
        Ty::Enum(e) => e.values.iter().map(|v| v.as_str()).collect(),
        _ => return,
    };
    let there: FastSet<usize> = cases.iter().map(|(value, _)| *value as usize).collect();
    let is_there = |k: usize| there.contains(&k);
    let missing: Vec<&str> = names
        .iter()
        .enumerate()
        .filter(|(k, _)| !is_there(*k))
        .map(|(_, n)| *n)
        .collect();
    if !missing.is_empty() {
        let help = format!("add a case: `({} -> ...)`", missing[0]);
        let diagnostic = Diagnostic::new(
            Code::RPI2011,
            format!(
                "non-exhaustive `merge`: {} not covered",
                join_names(missing)
            ),
        )
        .primary(span, "a `merge` needs a case for every value")
        .help(help);
        report::report_diagnostic(cx, diagnostic);
    }
}

/// Checks `current x` (the latest value of a sampled flow) and returns its typed expression.
pub(crate) fn current_expr<'a>(
    cx: &mut Body<'_, 'a>,
    operand: &'a ast::Expr,
    span: Span,
) -> ExprId {
    cx.record_state(span);
    cx.unit.has_clocks = true;
    let operand = expr::check_expr(cx, operand);
    let ty = cx.ty_of(operand).clone();
    if let (Ty::Tuple(_), true) = (&ty, unit::reads_rpi_syntax(cx)) {
        let diagnostic = Diagnostic::new(Code::RPI2006, format!("`current` cannot take `{ty}`"))
            .primary(cx.span_of(operand), "it takes one flow")
            .help(initialised_hold_help(cx, operand));
        return cx.report_error_expr(diagnostic, span);
    }
    cx.add(TypedKind::Current(operand), ty, span)
}

/// Returns the form with an initial value that `current(0, x)` or `current(x, 0)` probably means.
fn initialised_hold_help(cx: &Body<'_, '_>, operands: ExprId) -> String {
    let TypedKind::Build(parts) = &cx.unit.expr(operands).kind else {
        return "pass one flow".to_owned();
    };
    let [a, b] = parts[..] else {
        return "write `current` before each flow".to_owned();
    };
    let is_literal = |id: ExprId| matches!(cx.unit.expr(id).kind, TypedKind::Literal(_));
    let (value, first) = if is_literal(b) { (a, b) } else { (b, a) };
    let [value, first] = [value, first].map(|id| Quote::text(cx.span_of(id)));
    format!(
        "`hold({value}, {first})` is the latest value of its first argument, and `{first}` before the first one"
    )
}

/// Checks `last x` and returns its typed expression. For a flow that several states of an automaton define, this is the
/// value of the previous cycle, in whichever state that was.
pub(crate) fn last_expr<'a>(cx: &mut Body<'_, 'a>, operand: &'a ast::Expr, span: Span) -> ExprId {
    cx.record_state(span);
    if !is_name_or_field(operand) {
        let diagnostic = Diagnostic::new(Code::RPI2006, "`last` takes a flow or a field of one")
            .primary(operand.span, "not a flow")
            .help("write `last` before each flow of the expression");
        return cx.report_error_expr(diagnostic, span);
    }
    cx.bindings.pre_depth += 1;
    let operand = last_operand(cx, operand);
    cx.bindings.pre_depth -= 1;
    let ty = cx.ty_of(operand).clone();
    cx.add(
        TypedKind::Each(ElementwiseOp::Last, [operand].into()),
        ty,
        span,
    )
}

/// Checks the operand of `last` and returns its typed expression. A flow local to a state is replaced by the flow
/// outside of the automaton.
fn last_operand<'a>(cx: &mut Body<'_, 'a>, operand: &'a ast::Expr) -> ExprId {
    if let ast::ExprKind::Field(field) = &operand.unparen().kind {
        let base = last_operand(cx, &field.base);
        return access::member_access(cx, base, &field.field);
    }
    let id = expr::check_expr(cx, operand);
    if let TypedKind::Flow(flow) = cx.unit.expr(id).kind
        && let Some(outer) = outermost_total_flow(cx, flow)
    {
        return names::flow_expr(cx, outer, operand.span);
    }
    if !cx.ty_of(id).is_unknown() {
        statement::expect_type(cx, id, &Ty::Unknown, &ExpectationReason::Unexplained);
    }
    id
}

/// Returns the outermost flow that a flow local to a state defines through automata in which every state defines it; at
/// least the flow of the innermost automaton. `None` if the flow is not local to a state. A state of an outer automaton
/// that does not define the flow does not affect the states that define it.
fn outermost_total_flow(cx: &Body<'_, '_>, flow: FlowId) -> Option<FlowId> {
    let mut around = automaton::enclosing_shared_flows(cx, flow);
    let first = around.next()?;
    let whole = around.take_while(|outer| !is_partially_defined(cx, *outer));
    Some(whole.last().unwrap_or(first))
}

/// Whether an automaton defines this flow but has a state that does not, so that the flow can be absent.
fn is_partially_defined(cx: &Body<'_, '_>, flow: FlowId) -> bool {
    let block = cx.unit.block(cx.unit.flow(flow).block);
    let mut shared = block
        .automata
        .iter()
        .flat_map(|automaton| &automaton.shared);
    shared.any(|shared| shared.flow == flow && shared.is_partially_defined())
}

/// Whether an expression is the name of a flow or a path of fields of a flow.
fn is_name_or_field(operand: &ast::Expr) -> bool {
    match &operand.unparen().kind {
        ast::ExprKind::Field(field) => is_name_or_field(&field.base),
        ast::ExprKind::Index(index) => is_name_or_field(&index.base),
        ast::ExprKind::Name(_) => true,
        _ => false,
    }
}

/// Returns the diagnostic for a `merge` that has two cases for the value `name`. `first` is the location of the first
/// case.
pub(crate) fn duplicate_case(name: &Ident, first: rpi_diag::Span) -> Diagnostic {
    Diagnostic::new(
        Code::RPI2011,
        format!("the case `{}` is given twice", name.name),
    )
    .primary(name.span, "given again here")
    .secondary(first, "first given here")
    .help("delete one of the two cases")
}
