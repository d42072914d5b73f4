//! Expressions: dispatch on their kind, literals, and simple forms.

use crate::check::bodies::body::Body;
use crate::check::bodies::elements;
use crate::check::bodies::statement;
use crate::check::calls::call;
use crate::check::diagnostics::number_fixes;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::ExpectationReason;
use crate::check::exprs::access;
use crate::check::exprs::bindings;
use crate::check::exprs::clocked;
use crate::check::exprs::compose;
use crate::check::exprs::indexing;
use crate::check::exprs::match_expr;
use crate::check::exprs::names;
use crate::check::exprs::ops;
use crate::check::exprs::proof_only;
use crate::check::exprs::update;
use crate::check::signatures::unit;
use crate::check::types;
use crate::check::types::consts;
use crate::check::types::data;
use crate::check::types::exact_time;
use crate::check::types::machine_int;
use crate::check::types::quantity::angle_without_unit;
use crate::ty::{Ty, join};
use crate::typed::{ElementwiseOp, TypedKind};
use crate::typed::{ExprId, Leaf};
use crate::units::BaseDim;
use rpi_diag::{Applicability, Code, Diagnostic, Span};
use rpi_net::prim;
use rpi_syntax::ast::{self, BoolListOp, ExprKind, Number, Quantity};

/// Checks an expression and returns its entry in the table of typed expressions.
pub(crate) fn check_expr<'a>(cx: &mut Body<'_, 'a>, expr: &'a ast::Expr) -> ExprId {
    cx.checker.limits.nesting += 1;
    let id = check_expr_kind(cx, expr);
    cx.checker.limits.nesting -= 1;
    id
}

fn check_expr_kind<'a>(cx: &mut Body<'_, 'a>, expr: &'a ast::Expr) -> ExprId {
    let span = expr.span;
    match &expr.kind {
        ExprKind::Bool(value) => cx.add(TypedKind::Literal(Leaf::bool(*value)), Ty::Bool, span),
        ExprKind::Number(number) => {
            cx.inference.number_literals.insert(span);
            number_literal(cx, number, false, span)
        }
        ExprKind::Quantity(quantity) => quantity_literal(cx, quantity, span),
        ExprKind::Str(text) => cx.add(
            TypedKind::Literal(Leaf::Str(text.to_string())),
            Ty::Text,
            span,
        ),
        ExprKind::Name(name) => names::resolve_name(cx, name, span),
        ExprKind::Field(field) => access::field_access(cx, field, span),
        ExprKind::Index(index) => indexing::index_access(cx, index, span),
        ExprKind::Slice(slice) => indexing::slice_access(cx, slice, span),
        ExprKind::BitRange(of) => machine_int::bit_slice(cx, of, span),
        ExprKind::Unary(op, operand) => ops::unary(cx, *op, operand, span),
        ExprKind::Binary(binary) => ops::check_binary(cx, binary, span),
        ExprKind::When(when) => clocked::when_expr(cx, when, span),
        ExprKind::If(choice) => if_expr(cx, choice, span),
        ExprKind::Call(call) => call::check_call(cx, call, span),
        ExprKind::BoolList(among, operands) => at_most_one_or_nor(cx, *among, operands, span),
        ExprKind::Merge(merge) => clocked::merge_expr(cx, merge, span),
        ExprKind::Paren(inner) => check_expr(cx, inner),
        ExprKind::Tuple(elements) => tuple_expr(cx, elements, span),
        ExprKind::Array(elements) => compose::array_literal(cx, elements, span),
        ExprKind::Struct(value) => compose::struct_literal(cx, value, span),
        ExprKind::Update(update) => update::check_update(cx, update, span),
        ExprKind::Quantified(of) => proof_only::check_quantifier(cx, of, span),
        ExprKind::Ascription(of) => proof_only::ascription(cx, of),
        ExprKind::ConstructorTest(of) => data::constructor_test(cx, of, span),
        ExprKind::Match(of) => match_expr::match_expr(cx, of, span),
        ExprKind::EmptySet(types) => proof_only::empty_set(cx, types, span),
    }
}

/// Checks a number literal and returns its typed expression. `negative` is true after a minus sign, which makes -2^63 a
/// valid integer.
pub(crate) fn number_literal(
    cx: &mut Body<'_, '_>,
    number: &Number,
    negative: bool,
    span: Span,
) -> ExprId {
    if !number.is_int() {
        let value = if negative {
            -number.real_value()
        } else {
            number.real_value()
        };
        return cx.add(TypedKind::Literal(Leaf::real(value)), Ty::REAL, span);
    }
    let Some(value) = number.int_value() else {
        // The parser has reported it, except after a sign that may be the end of `uint@<64>`.
        if number.u64_value().is_some() && !unit::reads_rpi_syntax(cx) {
            return cx.report_error_expr(integer_too_large(span), span);
        }
        return cx.error_expr(span);
    };
    match signed_literal(value, negative) {
        Some(value) => cx.add(TypedKind::Literal(Leaf::int(value)), Ty::Int, span),
        None => cx.report_error_expr(integer_too_large(span), span),
    }
}

/// Checks a number with a unit and returns its typed expression.
fn quantity_literal(cx: &mut Body<'_, '_>, quantity: &Quantity, span: Span) -> ExprId {
    match types::resolve_unit(cx, &quantity.unit) {
        Ok(None) => cx.error_expr(span),
        Ok(Some(measure)) => {
            let value = measure.factor.apply(quantity.number.real_value());
            cx.add(
                TypedKind::Literal(Leaf::real(value)),
                Ty::Real(measure.dim),
                span,
            )
        }
        Err(diagnostic) => cx.report_error_expr(*diagnostic, span),
    }
}

/// Reports a number without a unit where an angle is expected, and returns whether there is no such error. A check of
/// units alone would accept the number, because SI treats the radian as dimensionless.
pub(crate) fn check_angle_unit(cx: &mut Body<'_, '_>, id: ExprId, expected: &Ty) -> bool {
    let expr = cx.unit.expr(id);
    let (TypedKind::Literal(value), Ty::Real(found), Ty::Real(wanted)) =
        (&expr.kind, &expr.ty, expected)
    else {
        return true;
    };
    let angle =
        !wanted.exponent(BaseDim::Angle).is_zero() && found.exponent(BaseDim::Angle).is_zero();
    if !angle || value.as_real() == Some(0.0) {
        return true;
    }
    let diagnostic = angle_without_unit(*wanted, report::measured_value(cx, id));
    report::report_diagnostic(cx, diagnostic);
    false
}

/// Checks `if c then x else y` and returns its typed expression.
fn if_expr<'a>(cx: &mut Body<'_, 'a>, choice: &'a ast::IfExpr, span: Span) -> ExprId {
    if choice.is_static {
        return static_if_expr(cx, choice, span);
    }
    let before = cx.static_read_count;
    let condition = statement::check_condition(cx, &choice.condition, "the expression after `if`");
    if cx.static_read_count > before {
        cx.unit.static_conditions.push(condition);
    }
    if let Some(taken) = elements::const_condition(cx, &choice.condition, condition) {
        return check_expr(
            cx,
            if taken {
                &choice.then_value
            } else {
                &choice.else_value
            },
        );
    }
    let guarded = cx.bindings.in_guarded_branch;
    cx.bindings.in_guarded_branch |= bindings::reads_binding(cx, &choice.condition);
    let yes = check_branch(cx, condition, true, &choice.then_value);
    let no = check_branch(cx, condition, false, &choice.else_value);
    cx.bindings.in_guarded_branch = guarded;
    let ty = common_type(
        cx,
        yes,
        no,
        "both branches of an `if` must have the same type",
    );
    cx.add(
        TypedKind::Each(ElementwiseOp::If, [condition, yes, no].into()),
        ty,
        span,
    )
}

/// Checks a branch of `if c then x else y` and returns its typed expression. `taken_if` is the value of the condition
/// for which the branch is taken.
fn check_branch<'a>(
    cx: &mut Body<'_, 'a>,
    condition: ExprId,
    taken_if: bool,
    branch: &'a ast::Expr,
) -> ExprId {
    cx.bindings.branches.push((condition, taken_if));
    let id = check_expr(cx, branch);
    cx.bindings.branches.pop();
    id
}

/// Whether the current expression is in a branch of an `if` that a constant condition never takes, such as the division
/// in `if n = 0 then 0 else x div n` for a constant `n` of 0.
pub(crate) fn is_in_untaken_branch(cx: &mut Body<'_, '_>) -> bool {
    let branches = cx.bindings.branches.clone();
    branches.into_iter().any(|(condition, taken_if)| {
        let leaves = consts::fold_silently(cx, condition);
        let value = leaves.and_then(|leaves| leaves.first().and_then(Leaf::as_bool));
        value.is_some_and(|value| value != taken_if)
    })
}

/// Checks `with c then x else y`, whose condition is constant. Only the branch that is taken is checked and returned.
fn static_if_expr<'a>(cx: &mut Body<'_, 'a>, choice: &'a ast::IfExpr, span: Span) -> ExprId {
    let Some(taken) = consts::const_value(cx, &choice.condition, &Ty::Bool) else {
        return cx.error_expr(span);
    };
    match taken.first().and_then(Leaf::as_bool) {
        Some(true) => check_expr(cx, &choice.then_value),
        _ => check_expr(cx, &choice.else_value),
    }
}

/// Returns the common type of two expressions. Reports a mismatch at the second one, or at a number literal. `why`
/// explains in the message why the types must be equal.
pub(crate) fn common_type(cx: &mut Body<'_, '_>, a: ExprId, b: ExprId, why: &str) -> Ty {
    exact_time::unify_times(cx, a, b);
    match join(cx.ty_of(a), cx.ty_of(b)) {
        Ok(ty) => ty,
        Err(misfit) => {
            // A number literal is the easiest to change, and often only lacks its unit or decimal point.
            let points = (cx.ty_of(a) == &Ty::Int, cx.ty_of(b) == &Ty::Int);
            let lacks_point = report::is_number_literal(cx, b) && points == (true, false);
            let (model, odd, misfit) = match report::is_number_literal(cx, a)
                && (!report::is_number_literal(cx, b) || lacks_point)
            {
                true => (b, a, misfit.swapped()),
                false => (a, b, misfit),
            };
            let expected = cx.ty_of(model).clone();
            let wanted = ExpectationReason::Because(
                cx.span_of(model),
                format!("this is `{expected}`; {why}"),
            );
            let before = cx.diagnostics.len();
            report::type_mismatch(cx, odd, &expected, &misfit, &wanted);
            hint_common_type(cx, before, &expected, odd);
            let both = report::is_number_literal(cx, a) && report::is_number_literal(cx, b);
            if both && let (Ty::Real(_), Ty::Int) = (&expected, cx.ty_of(odd)) {
                soften_number_fix(cx, model);
                return Ty::Unknown;
            }
            // Two arrays of different size: either size may be the intended one.
            match (&expected, cx.ty_of(odd)) {
                (Ty::Array(..), Ty::Array(..)) => Ty::Unknown,
                _ => expected,
            }
        }
    }
}

/// Replaces the help of a mismatch of a Boolean and a number, of which either may be the wrong one.
fn hint_common_type(cx: &mut Body<'_, '_>, before: usize, expected: &Ty, odd: ExprId) {
    let found = cx.ty_of(odd).clone();
    let is_mixed = (*expected == Ty::Bool) != (found == Ty::Bool);
    let numbers = [expected, &found];
    let is_number = |ty: &&&Ty| matches!(ty, Ty::Int | Ty::Real(_));
    if is_mixed
        && numbers.iter().any(|ty| is_number(&ty))
        && let Some(diagnostic) = cx.diagnostics.get_mut(before)
    {
        diagnostic.help = vec![format!("make both values `{expected}`, or both `{found}`")];
        diagnostic.fixes.clear();
    }
}

/// Adds to the last diagnostic that either `1` or `1.0` may be the wrong literal; `real` is the literal of a real.
fn soften_number_fix(cx: &mut Body<'_, '_>, real: ExprId) {
    let integer = number_fixes::integer_literal_fix(cx, real);
    let index = cx.diagnostics.len().checked_sub(1);
    cx.inference.integer_fix = index.zip(integer);
    if let Some(diagnostic) = cx.diagnostics.last_mut() {
        for fix in &mut diagnostic.fixes {
            fix.applicability = Applicability::Maybe;
        }
        let other = "to use integers, write the other number without a decimal point";
        diagnostic.help.push(other.to_owned());
    }
}

/// Checks `#(a, b, c)`, which is true if at most one operand is true, or `nor(a, b, c)`, which is true if none is true.
/// Returns the typed expression.
fn at_most_one_or_nor<'a>(
    cx: &mut Body<'_, 'a>,
    among: BoolListOp,
    operands: &'a [ast::Expr],
    span: Span,
) -> ExprId {
    let operands: Vec<ExprId> = operands
        .iter()
        .flat_map(|operand| boolean_operands(cx, operand))
        .collect();
    match among {
        BoolListOp::Nor => none_of(cx, &operands, span),
        BoolListOp::AtMostOne => at_most_one(cx, &operands, span),
    }
}

/// Checks an operand that must be a Boolean or an array of Booleans, and returns an expression for each Boolean.
pub(crate) fn boolean_operands<'a>(cx: &mut Body<'_, 'a>, operand: &'a ast::Expr) -> Vec<ExprId> {
    let id = check_expr(cx, operand);
    if let Ty::Array(element, n) = cx.ty_of(id).clone() {
        let parts = (0..n).map(|k| {
            cx.add(
                TypedKind::Part { base: id, at: k },
                (*element).clone(),
                operand.span,
            )
        });
        let parts: Vec<ExprId> = parts.collect();
        for part in &parts {
            statement::expect_type(cx, *part, &Ty::Bool, &ExpectationReason::Unexplained);
        }
        return parts;
    }
    statement::expect_type(cx, id, &Ty::Bool, &ExpectationReason::Unexplained);
    vec![id]
}

/// Adds an expression that is true if no operand is true, and returns it.
fn none_of(cx: &mut Body<'_, '_>, operands: &[ExprId], span: Span) -> ExprId {
    let any = any_of(cx, operands, span);
    ops::logical_prim(cx, prim!("Core::BooleanNot"), &[any], span)
}

/// Adds the disjunction of the operands (true if at least one is true) and returns it.
fn any_of(cx: &mut Body<'_, '_>, operands: &[ExprId], span: Span) -> ExprId {
    let first = cx.add(TypedKind::Literal(Leaf::bool(false)), Ty::Bool, span);
    let or = |any: ExprId, next: &ExprId| {
        ops::logical_prim(cx, prim!("Core::BooleanOr"), &[any, *next], span)
    };
    operands.iter().fold(first, or)
}

/// Adds an expression that is true if at most one operand is true, and returns it. Its size is linear in the number of
/// operands.
pub(crate) fn at_most_one(cx: &mut Body<'_, '_>, operands: &[ExprId], span: Span) -> ExprId {
    let [first, rest @ ..] = operands else {
        return cx.add(TypedKind::Literal(Leaf::bool(true)), Ty::Bool, span);
    };
    let (mut any, mut two) = (*first, None);
    for next in rest {
        let both = ops::logical_prim(cx, prim!("Core::BooleanAnd"), &[any, *next], span);
        two = Some(match two {
            Some(two) => ops::logical_prim(cx, prim!("Core::BooleanOr"), &[two, both], span),
            None => both,
        });
        any = ops::logical_prim(cx, prim!("Core::BooleanOr"), &[any, *next], span);
    }
    match two {
        Some(two) => ops::logical_prim(cx, prim!("Core::BooleanNot"), &[two], span),
        None => cx.add(TypedKind::Literal(Leaf::bool(true)), Ty::Bool, span),
    }
}

/// Checks a tuple `(x, y)` and returns its typed expression.
fn tuple_expr<'a>(cx: &mut Body<'_, 'a>, elements: &'a [ast::Expr], span: Span) -> ExprId {
    let elements: Vec<ExprId> = elements.iter().map(|e| check_expr(cx, e)).collect();
    let ty = Ty::tuple(elements.iter().map(|id| cx.ty_of(*id).clone()));
    cx.add(TypedKind::Build(elements.into()), ty, span)
}

/// Returns the diagnostic for an integer literal that does not fit into 64 bits.
fn integer_too_large(span: Span) -> Diagnostic {
    Diagnostic::new(Code::RPI2010, "the integer does not fit in 64 bits")
        .primary(span, "the range is -2^63 to 2^63 - 1")
}

/// Returns the value of an integer literal with its sign; `None` if it does not fit into 64 bits.
fn signed_literal(value: u64, negative: bool) -> Option<i64> {
    match negative {
        true => 0i64.checked_sub_unsigned(value),
        false => i64::try_from(value).ok(),
    }
}
