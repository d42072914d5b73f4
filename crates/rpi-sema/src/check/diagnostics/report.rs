//! Diagnostics that several checks share.

use crate::check::bodies::body::Body;
use crate::check::diagnostics::number_fixes;
use crate::check::exprs::apart;
use crate::check::types::frames;
use crate::check::types::quantity;
use crate::check::types::quantity::MeasuredValue;
use crate::ty::{Ty, TypeMismatchError};
use crate::typed::ExprId;
use crate::typed::TypedKind;
use crate::units::Dimension;
use rpi_diag::with_noun;
use rpi_diag::{Code, Diagnostic, Fix, Quote, Severity, Span};
use rpi_image::Scalar;

/// Adds a diagnostic about this body. An undefined name inside of a call of a function of another language is left out,
/// because the call has been reported.
pub(crate) fn report_diagnostic(cx: &mut Body<'_, '_>, diagnostic: Diagnostic) {
    let is_foreign =
        |call: Span| diagnostic.code == Code::RPI1001 && call.contains(diagnostic.span());
    if !cx.bindings.foreign_call.is_some_and(is_foreign) {
        cx.diagnostics.push(diagnostic);
    }
}

/// Whether an error has been added after the first `before` diagnostics. Notes and warnings do not count.
pub(crate) fn has_error_since(cx: &Body<'_, '_>, before: usize) -> bool {
    let mut new = cx.diagnostics.iter().skip(before);
    new.any(|diagnostic| diagnostic.severity() == Severity::Error)
}

/// Reports that an expression does not have the expected type. `wanted_by` is the reason for the expectation.
pub(crate) fn type_mismatch(
    cx: &mut Body<'_, '_>,
    expr: ExprId,
    expected: &Ty,
    misfit: &TypeMismatchError,
    wanted_by: &ExpectationReason,
) {
    let diagnostic = match misfit {
        TypeMismatchError::Dimension { expected, found } => {
            let found = MeasuredValue {
                dim: *found,
                ..measured_value(cx, expr)
            };
            let mut diagnostic = quantity::dimension_mismatch(*expected, found);
            if let Some(help) = apart::quotient_help(cx, expr, *expected) {
                diagnostic.help = vec![help];
            }
            diagnostic
        }
        TypeMismatchError::Frame {
            expected: wanted,
            found,
        } => frames::frame_mismatch(cx, expected, expr, (wanted, found)),
        TypeMismatchError::Size { expected, found } => size_mismatch(cx, expr, *expected, *found),
        TypeMismatchError::Kind => kind_mismatch(cx, expr, expected),
    };
    report_diagnostic(cx, wanted_by.annotate(diagnostic));
}

/// Returns the dimension and location of a value, for a diagnostic about physical units.
pub(crate) fn measured_value(cx: &Body<'_, '_>, id: ExprId) -> MeasuredValue {
    let dim = match cx.ty_of(id) {
        Ty::Real(dim) => *dim,
        _ => Dimension::ONE,
    };
    let span = cx.span_of(id);
    MeasuredValue {
        dim,
        span,
        is_number: is_number_literal(cx, id)
            || dim != Dimension::ONE && matches!(cx.unit.expr(id).kind, TypedKind::Literal(_)),
    }
}

/// Whether an expression is a number literal. Named constants do not count.
pub(crate) fn is_number_literal(cx: &Body<'_, '_>, id: ExprId) -> bool {
    cx.inference.number_literals.contains(&cx.span_of(id))
}

/// Whether an expression is the element that an iterator such as `map` takes from an array. Such an element has the
/// location of the array, because it has no source text of its own.
fn is_iterator_element(cx: &Body<'_, '_>, id: ExprId) -> bool {
    match cx.unit.expr(id).kind {
        TypedKind::Part { base, .. } => {
            cx.span_of(base) == cx.span_of(id) && matches!(cx.ty_of(base), Ty::Array(..))
        }
        _ => false,
    }
}

/// Returns the diagnostic for a value whose type is of another kind than the expected type, such as an integer where a
/// Boolean is expected.
fn kind_mismatch(cx: &Body<'_, '_>, id: ExprId, expected: &Ty) -> Diagnostic {
    let (found, span) = (cx.ty_of(id), cx.span_of(id));
    let message = format!(
        "expected {}, found {}",
        type_text(expected),
        type_text(found)
    );
    let diagnostic = Diagnostic::new(Code::RPI2001, message).primary(span, found_label(cx, id));
    match (expected, found) {
        (Ty::Real(dim), Ty::Int) if is_number_literal(cx, id) && *dim != Dimension::ONE => {
            quantity::with_unit_fixes(diagnostic, *dim, span)
        }
        (Ty::Duration, Ty::Int | Ty::Real(Dimension::ONE)) if is_number_literal(cx, id) => {
            quantity::with_unit_fixes(diagnostic, Dimension::TIME, span)
        }
        (Ty::Duration, Ty::Real(Dimension::TIME)) => diagnostic
            .help(format!(
                "`time({0})` is `{0}` in whole ticks, rounded up",
                Quote::text(span)
            ))
            .fix(
                Fix::maybe("convert with `time`")
                    .insert_before(span, "time(")
                    .insert_after(span, ")"),
            ),
        (Ty::Int, Ty::Duration) => with_integer_help(cx, diagnostic, id),
        (Ty::Real(_), Ty::Int) if is_iterator_element(cx, id) => {
            diagnostic.help(elements_to_real_help(cx, id))
        }
        (Ty::Real(_) | Ty::Int, _) if is_iterator_element(cx, id) => diagnostic.help(format!(
            "an iterator passes the elements one by one: each must be `{expected}`"
        )),
        (Ty::Real(_), Ty::Int) => diagnostic.fix(number_fixes::to_real_fix(cx, id)),
        (Ty::Int, Ty::Real(_)) => with_integer_help(cx, diagnostic, id),
        (expected, Ty::Tuple(_)) => with_output_fixes(cx, diagnostic, id, expected),
        (Ty::Bool, Ty::Int | Ty::Real(_) | Ty::Duration) => {
            let diagnostic = with_boolean_outputs(cx, diagnostic, id);
            with_condition_help(diagnostic, [(span, found)])
        }
        (Ty::Real(_), Ty::Array(element, n)) if matches!(**element, Ty::Real(_)) => {
            diagnostic.help(element_help(cx, id, *n))
        }
        (_, Ty::Array(element, n)) if **element == *expected => {
            diagnostic.help(element_help(cx, id, *n))
        }
        (Ty::Int | Ty::Real(_), Ty::Bool)
            if matches!(cx.unit.expr(id).kind, TypedKind::Literal(_)) =>
        {
            diagnostic.help("write a number, or give the flow the type `bool`")
        }
        _ => with_general_help(diagnostic, expected, found, cx.span_of(id)),
    }
}

/// Adds help on how the duration or real number `id` is converted to an integer.
fn with_integer_help(cx: &Body<'_, '_>, diagnostic: Diagnostic, id: ExprId) -> Diagnostic {
    let operand = operand_name(cx, id);
    match cx.ty_of(id) {
        Ty::Duration => diagnostic.help(format!(
            "divide by a time to get an integer: `{operand} div 1[ms]`"
        )),
        Ty::Real(Dimension::ONE) if is_number_literal(cx, id) => {
            diagnostic.help("write an integer without a decimal point")
        }
        Ty::Real(dim) if !dim.is_dimensionless() => diagnostic.help(format!(
            "divide it by a quantity of its unit, then convert it: `int ({operand} / 1[{dim}])`"
        )),
        _ => diagnostic
            .help(format!(
                "`int {operand}` cuts off the fraction; `int round({operand})` takes the nearest"
            ))
            .fix(number_fixes::conversion_fix(cx, id, "int")),
    }
}

/// Adds help on how a value of the expected type is obtained, for pairs of types without a conversion. `found` is the
/// type of the value and `value` is its location.
fn with_general_help(diagnostic: Diagnostic, expected: &Ty, found: &Ty, value: Span) -> Diagnostic {
    let name = Quote::operand(value);
    let help = match (expected, found) {
        (Ty::Unknown, _) | (_, Ty::Unknown) => return diagnostic,
        (Ty::Spatial(Scalar::Vector, _), Ty::Real(_)) => {
            let zero = found.zero_literal().unwrap_or_default();
            format!(
                "a vector has three components, such as `vector({}, {zero}, {zero})`",
                Quote::text(value)
            )
        }
        (Ty::Spatial(Scalar::Vector, _), Ty::Spatial(Scalar::Pose, _)) => {
            format!("the position of a pose is `{name}.position`")
        }
        (Ty::Spatial(Scalar::Rotation, _), Ty::Spatial(Scalar::Pose, _)) => {
            format!("the orientation of a pose is `{name}.rotation`")
        }
        (Ty::Machine(to), Ty::Machine(_) | Ty::Int) => {
            format!("convert it: `({} {name})`", to.conversion_name())
        }
        (Ty::Int, Ty::Machine(_)) => format!("convert it: `(int {name})`"),
        (Ty::Int | Ty::Real(_), Ty::Bool) => bool_to_number_help(value, expected),
        (_, Ty::Text) => "a text is a value of parameters only: a number is written without quotes".to_owned(),
        (Ty::Spatial(Scalar::Pose, _), Ty::Device(_)) => {
            format!("a sensor of the device gives the value: `{name}.pose`")
        }
        (Ty::Spatial(Scalar::Pose, _), _) => {
            "a pose is written with three coordinates and three angles: `pose(1[m], 0[m], 0[m], 0[deg], 0[deg], 90[deg])`".to_owned()
        }
        (Ty::Device(device), _) => {
            format!(
                "pass a device: a parameter that is declared with the type `{}`",
                device.name
            )
        }
        _ => format!("write a value of the type `{expected}` here, or change the declared type"),
    };
    diagnostic.help(help)
}

/// Adds a fix for each output of the call `id` that has the expected type.
fn with_output_fixes(
    cx: &Body<'_, '_>,
    diagnostic: Diagnostic,
    id: ExprId,
    expected: &Ty,
) -> Diagnostic {
    let (span, members) = (cx.span_of(id), cx.ty_of(id).members());
    let fits = members.iter().filter(|m| m.ty == *expected);
    let mut diagnostic = diagnostic;
    for name in fits.filter_map(|member| member.name.as_ref()) {
        let title = format!("use its output `{name}`");
        diagnostic
            .fixes
            .push(Fix::maybe(title).insert_after(span, format!(".{name}")));
    }
    let is_named = members.iter().any(|member| member.name.is_some());
    match is_named {
        true => diagnostic,
        false => diagnostic.help(
            "several values in parentheses form a tuple; the initial value is written before `->`: `0 -> pre x`",
        ),
    }
}

/// Returns the source text of an operand for an example in a help text, in parentheses if necessary.
pub(crate) fn operand_name(cx: &Body<'_, '_>, operand: ExprId) -> String {
    Quote::operand(cx.span_of(operand)).to_string()
}

/// Returns the help for integers whose elements an iterator passes to a node of reals.
fn elements_to_real_help(cx: &Body<'_, '_>, element: ExprId) -> String {
    let n = match cx.unit.expr(element).kind {
        TypedKind::Part { base, .. } => match cx.ty_of(base) {
            Ty::Array(_, n) => n.to_string(),
            _ => "...".to_owned(),
        },
        _ => "...".to_owned(),
    };
    let array = Quote::text(cx.span_of(element));
    format!("convert the elements first: `map<<int2real, {n}>>({array})` in place of `{array}`")
}

/// Adds help with comparisons that turn numbers into conditions: `n <> 0`, and `way > 0[m]` for a quantity.
pub(crate) fn with_condition_help<'t>(
    diagnostic: Diagnostic,
    numbers: impl IntoIterator<Item = (Span, &'t Ty)>,
) -> Diagnostic {
    let comparisons: Vec<String> = numbers
        .into_iter()
        .filter(|(_, ty)| !matches!(ty, Ty::Bool))
        .map(|(span, ty)| {
            let (name, zero) = (Quote::operand(span), ty.zero_literal());
            let sign = if *ty == Ty::Int { "<>" } else { ">" };
            format!("`{name} {sign} {}`", zero.unwrap_or("0".to_owned()))
        })
        .collect();
    diagnostic.help(format!(
        "a condition is a comparison, such as {}",
        comparisons.join(" and ")
    ))
}

/// Adds the Boolean outputs of the call of which `id` is another output.
fn with_boolean_outputs(cx: &Body<'_, '_>, diagnostic: Diagnostic, id: ExprId) -> Diagnostic {
    let TypedKind::Part { base, .. } = cx.unit.expr(id).kind else {
        return diagnostic;
    };
    let booleans = cx.ty_of(base).members().iter();
    let booleans = booleans.filter(|member| member.ty == Ty::Bool);
    let names: Vec<&str> = booleans.filter_map(|m| m.name.as_deref()).collect();
    match names.is_empty() {
        true => diagnostic,
        false => diagnostic.help(members_help("Boolean output", names)),
    }
}

/// Returns the help text for a Boolean where a number is expected: `if c then 1 else 0`. `condition` is the location of
/// the Boolean, and `number` is the expected type.
pub(crate) fn bool_to_number_help(condition: Span, number: &Ty) -> String {
    let condition = Quote::text(condition);
    let (one, zero) = match number {
        Ty::Real(dim) if !dim.is_dimensionless() => (format!("1[{dim}]"), format!("0[{dim}]")),
        Ty::Real(_) => ("1.0".to_owned(), "0.0".to_owned()),
        _ => ("1".to_owned(), "0".to_owned()),
    };
    format!("a Boolean becomes a number by `if {condition} then {one} else {zero}`")
}

/// Returns the help text for an array of `n` elements where one is expected. For `x^2`, which makes an array, it
/// explains how a power is written.
fn element_help(cx: &Body<'_, '_>, id: ExprId, n: u32) -> String {
    match cx.unit.expr(id).kind {
        TypedKind::Repeat(element) => {
            let base = operand_name(cx, element);
            format!(
                "`^` makes an array of {n} equal elements; a power is written `{base} ** {n}.0`"
            )
        }
        _ => format!(
            "an element is read by its index: `{}[0]`",
            operand_name(cx, id)
        ),
    }
}

/// Reason why a type is expected, for diagnostics about type mismatches.
pub(crate) enum ExpectationReason {
    /// The type is expected for a reason that needs no explanation.
    Unexplained,
    /// The type is expected because of this text at this location; without a location the text becomes a note.
    Because(Span, String),
}

impl ExpectationReason {
    fn annotate(&self, diagnostic: Diagnostic) -> Diagnostic {
        match self {
            ExpectationReason::Unexplained => diagnostic,
            ExpectationReason::Because(span, text) if span.is_none() => {
                diagnostic.note(text.clone())
            }
            ExpectationReason::Because(span, text) => diagnostic.secondary(*span, text.clone()),
        }
    }
}

/// Returns the label for a value whose type is not the expected one.
fn found_label(cx: &Body<'_, '_>, id: ExprId) -> String {
    match cx.ty_of(id) {
        ty if is_iterator_element(cx, id) => format!("an element of this array is `{ty}`"),
        Ty::Tuple(members) if members.iter().any(|m| m.name.is_some()) => {
            format!("the call returns {}", with_noun(members.len(), "value"))
        }
        ty => format!("this is `{ty}`"),
    }
}

/// Returns the description of a type; the result of a call is described by its outputs with their types.
fn type_text(ty: &Ty) -> String {
    match ty {
        Ty::Tuple(members) if members.iter().any(|m| m.name.is_some()) => {
            let outputs: Vec<String> = members
                .iter()
                .filter_map(|m| Some(format!("{}: {}", m.name.as_deref()?, m.ty)))
                .collect();
            let outputs = join_names(outputs.iter().map(String::as_str));
            format!("several outputs, {outputs}")
        }
        ty => format!("`{ty}`"),
    }
}

/// Returns the diagnostic for an array with `found` elements where `expected` elements are expected.
fn size_mismatch(cx: &Body<'_, '_>, id: ExprId, expected: u32, found: u32) -> Diagnostic {
    let (span, array) = (cx.span_of(id), operand_name(cx, id));
    let help = match (found > expected, cx.ty_of(id)) {
        (true, _) => format!(
            "take a part of the array: `{array}[0..{}]`, or declare a larger size",
            expected.saturating_sub(1)
        ),
        (false, Ty::Array(element, _)) => format!(
            "add elements: `{array} | {}^{}`, or declare a smaller size",
            element.zero_or_dots(),
            expected - found
        ),
        (false, _) => "add elements, or declare a smaller size".to_owned(),
    };
    Diagnostic::new(
        Code::RPI2009,
        format!(
            "expected {}, found {found}",
            with_noun(expected as usize, "element")
        ),
    )
    .primary(
        span,
        format!("this has {}", with_noun(found as usize, "element")),
    )
    .help(help)
}

/// Returns the diagnostic for an undefined name. `what` is the kind of name, such as "flow", and `near` is a similar
/// name to suggest.
pub(crate) fn undefined_name(
    what: &str,
    name: &str,
    span: Span,
    near: Option<String>,
) -> Diagnostic {
    let diagnostic = Diagnostic::new(Code::RPI1001, format!("undefined {what} `{name}`"))
        .primary(span, "not declared");
    diagnostic.did_you_mean(span, near)
}

/// Returns the diagnostic for a field or output that the value `of` lacks. `near` is a similar name to suggest.
pub(crate) fn no_member(of: &str, name: &str, span: Span, near: Option<String>) -> Diagnostic {
    let diagnostic =
        Diagnostic::new(Code::RPI1004, format!("{of} has no `{name}`")).primary(span, "not found");
    diagnostic.did_you_mean(span, near)
}

/// Returns the diagnostic for a name of the kind `is`, such as "a type", where the kind `wanted` is expected.
pub(crate) fn wrong_kind_of_name(
    wanted: &str,
    name: &str,
    is: &str,
    span: Span,
    declared: Span,
) -> Diagnostic {
    Diagnostic::new(Code::RPI1003, format!("`{name}` is {is}, not {wanted}"))
        .primary(span, format!("{wanted} is expected here"))
        .secondary(declared, "declared here")
}

/// Returns a sentence that lists the parts of a value or block, such as "its fields are ...". `noun` is the kind of
/// part in the singular.
pub(crate) fn members_help<'n>(noun: &str, names: impl IntoIterator<Item = &'n str>) -> String {
    let names: Vec<&str> = names.into_iter().collect();
    let plural = match noun {
        "port or parameter" => "ports and parameters".to_owned(),
        noun => format!("{noun}s"),
    };
    match names.len() {
        0 => format!("it has no {plural}"),
        1 => format!("its only {noun} is {}", join_names(names)),
        _ => format!("its {plural} are {}", join_names(names)),
    }
}

/// Joins names for a sentence: `a`, `b` and `c`.
pub(crate) fn join_names<'n>(names: impl IntoIterator<Item = &'n str>) -> String {
    let quoted: Vec<String> = names.into_iter().map(|name| format!("`{name}`")).collect();
    match &quoted[..] {
        [] => "nothing".to_owned(),
        [one] => one.clone(),
        [most @ .., last] => format!("{} and {last}", most.join(", ")),
    }
}
