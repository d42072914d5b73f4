//! Diagnostics that several checks share.

use crate::check::bodies::body::Body;
use crate::check::types::frames;
use crate::check::types::quantity;
use crate::check::types::quantity::MeasuredValue;
use crate::ty::{Ty, TypeMismatchError};
use crate::typed::ExprId;
use crate::typed::TypedKind;
use crate::units::Dimension;
use rpi_diag::with_noun;
use rpi_diag::{Code, Diagnostic, Fix, Severity, Span};
use rpi_image::Scalar;

/// Adds a diagnostic about this body, unless it follows from a reported call of another language.
pub(crate) fn report_diagnostic(cx: &mut Body<'_, '_>, diagnostic: Diagnostic) {
    let is_foreign =
        |call: Span| diagnostic.code == Code::RPI1001 && call.contains(diagnostic.span());
    if !cx.bindings.foreign_call.is_some_and(is_foreign) {
        cx.diagnostics.push(diagnostic);
    }
}

/// Whether an error has been added since there were `before` diagnostics. Notes and warnings do not invalidate a
/// value.
pub(crate) fn has_error_since(cx: &Body<'_, '_>, before: usize) -> bool {
    let mut new = cx.diagnostics.iter().skip(before);
    new.any(|diagnostic| diagnostic.severity() == Severity::Error)
}

/// Reports that an expression does not have the expected type.
pub(crate) fn type_mismatch(
    cx: &mut Body<'_, '_>,
    expr: ExprId,
    expected: &Ty,
    misfit: &TypeMismatchError,
    wanted_by: &ExpectationReason,
) {
    let span = cx.unit.expr(expr).span;
    let diagnostic = match misfit {
        TypeMismatchError::Dimension { expected, found } => {
            let found = MeasuredValue {
                dim: *found,
                ..measured_value(cx, expr)
            };
            quantity::dimension_mismatch(*expected, found)
        }
        TypeMismatchError::Frame {
            expected: wanted,
            found,
        } => frames::frame_mismatch(expected, cx.ty_of(expr), (wanted, found), span),
        TypeMismatchError::Size { expected, found } => const_size(*expected, *found, span),
        TypeMismatchError::Kind => kind_mismatch(cx, expr, expected),
    };
    report_diagnostic(cx, wanted_by.annotate(diagnostic));
}

/// Returns the description of a value for a diagnostic about quantities.
pub(crate) fn measured_value(cx: &Body<'_, '_>, id: ExprId) -> MeasuredValue {
    let dim = match cx.ty_of(id) {
        Ty::Real(dim) => *dim,
        _ => Dimension::ONE,
    };
    let span = cx.span_of(id);
    MeasuredValue {
        dim,
        span,
        is_number: is_number_literal(cx, id),
    }
}

/// Whether an expression is a number literal, not a named number.
pub(crate) fn is_number_literal(cx: &Body<'_, '_>, id: ExprId) -> bool {
    cx.inference.number_literals.contains(&cx.span_of(id))
}

/// Whether an expression is the element that an iterator takes from an array. Only the array has source text.
fn is_iterator_element(cx: &Body<'_, '_>, id: ExprId) -> bool {
    matches!(cx.unit.expr(id).kind, TypedKind::Part { base, .. } if cx.span_of(base) == cx.span_of(id))
}

/// Returns the diagnostic for a value whose type is of another kind than the expected type.
fn kind_mismatch(cx: &Body<'_, '_>, id: ExprId, expected: &Ty) -> Diagnostic {
    let (found, span) = (cx.ty_of(id), cx.span_of(id));
    let message = format!(
        "expected {}, found {}",
        type_text(expected),
        type_text(found)
    );
    let diagnostic = Diagnostic::new(Code::RPI2001, message).primary(span, found_label(found));
    match (expected, found) {
        (Ty::Real(dim), Ty::Int) if is_number_literal(cx, id) && *dim != Dimension::ONE => {
            quantity::with_unit_fixes(diagnostic, *dim, span)
        }
        (Ty::Duration, Ty::Int | Ty::Real(Dimension::ONE)) if is_number_literal(cx, id) => {
            quantity::with_unit_fixes(diagnostic, Dimension::TIME, span)
        }
        (Ty::Duration, Ty::Real(Dimension::TIME)) => diagnostic
            .help("`time(x)` is `x` in whole ticks, rounded up")
            .fix(
                Fix::maybe("convert with `time`")
                    .insert_before(span, "time(")
                    .insert_after(span, ")"),
            ),
        (Ty::Int, Ty::Duration) => diagnostic.help(format!(
            "divide by a time to get an integer: `{} div 1[ms]`",
            operand_name(cx, id)
        )),
        (Ty::Real(_) | Ty::Int, _) if is_iterator_element(cx, id) => diagnostic,
        (Ty::Real(_), Ty::Int) => diagnostic.fix(to_real_fix(cx, id)),
        (Ty::Int, Ty::Real(Dimension::ONE)) if is_number_literal(cx, id) => {
            diagnostic.help("write an integer without a decimal point")
        }
        (Ty::Int, Ty::Real(_)) => diagnostic
            .help(format!(
                "`int {0}` cuts off the fraction; `int round({0})` takes the nearest",
                operand_name(cx, id)
            ))
            .fix(conversion_fix(cx, id, "int")),
        (expected, Ty::Tuple(_)) => with_output_fixes(cx, diagnostic, id, expected),
        (Ty::Bool, Ty::Int | Ty::Real(_)) => {
            diagnostic.help("a condition is a comparison: `x <> 0`, `x > 0.0`")
        }
        (Ty::Real(_), Ty::Array(element, _)) if matches!(**element, Ty::Real(_)) => diagnostic
            .help("an element is read by its index: `x[0]`; a power is written `x ** 2.0`"),
        (_, Ty::Array(element, _)) if **element == *expected => diagnostic
            .help("an element is read by its index: `x[0]`; a power is written `x ** 2.0`"),
        _ => with_general_help(diagnostic, expected, found, &operand_name(cx, id)),
    }
}

/// Adds to a diagnostic how a value of the expected type is obtained, for the pairs of types without a conversion.
fn with_general_help(diagnostic: Diagnostic, expected: &Ty, found: &Ty, name: &str) -> Diagnostic {
    let help = match (expected, found) {
        (Ty::Unknown, _) | (_, Ty::Unknown) => return diagnostic,
        (Ty::Spatial(Scalar::Vector, _), Ty::Real(_)) => {
            format!("a vector has three components: `vector({name}, y, z)`")
        }
        (Ty::Spatial(Scalar::Vector, _), Ty::Spatial(Scalar::Pose, _)) => {
            "the position of a pose is `p.position`".to_owned()
        }
        (Ty::Spatial(Scalar::Rotation, _), Ty::Spatial(Scalar::Pose, _)) => {
            "the orientation of a pose is `p.rotation`".to_owned()
        }
        (Ty::Machine(to), Ty::Machine(_) | Ty::Int) => {
            format!("convert it: `({} {name})`", to.conversion_name())
        }
        (Ty::Int, Ty::Machine(_)) => format!("convert it: `(int {name})`"),
        (Ty::Int | Ty::Real(_), Ty::Bool) => {
            "a number for a condition is `if c then 1 else 0`".to_owned()
        }
        (Ty::Spatial(Scalar::Pose, _), Ty::Device(_)) => {
            "a sensor of the device gives the value: `arm.pose`".to_owned()
        }
        (Ty::Device(device), _) => {
            format!(
                "pass a device: declare it as a parameter `d: {}`",
                device.name
            )
        }
        _ => format!("write a value of the type `{expected}` here, or change the declared type"),
    };
    diagnostic.help(help)
}

/// Adds a fix for each output of a call that has the expected type.
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

/// Returns the fix that writes an integer literal as a real: `3.0` for `3`, and the decimal number for `0x1F`.
fn real_literal_fix(cx: &Body<'_, '_>, id: ExprId) -> Fix {
    let (span, fix) = (cx.span_of(id), Fix::sure("write a real"));
    let value = match &cx.unit.expr(id).kind {
        TypedKind::Literal(leaf) => leaf.as_int(),
        _ => None,
    };
    let text = value.map(|value| value.to_string());
    match text.filter(|text| text.len() as u32 != span.end - span.start) {
        Some(text) => fix.replace(span, format!("{text}.0")),
        None => fix.insert_after(span, ".0"),
    }
}

/// Returns the fix that turns an integer into a real: another literal, or a conversion.
pub(crate) fn to_real_fix(cx: &Body<'_, '_>, id: ExprId) -> Fix {
    match is_number_literal(cx, id) {
        true => real_literal_fix(cx, id),
        false => conversion_fix(cx, id, "real"),
    }
}

/// Returns the fix that converts a value with the keyword of a type.
fn conversion_fix(cx: &Body<'_, '_>, id: ExprId, word: &str) -> Fix {
    let (span, title) = (cx.span_of(id), format!("convert with `{word}`"));
    match &cx.unit.expr(id).kind {
        TypedKind::Flow(_)
        | TypedKind::Literal(_)
        | TypedKind::Const(_)
        | TypedKind::Call(_)
        | TypedKind::Part { .. } => Fix::maybe(title).insert_before(span, format!("{word} ")),
        _ => Fix::maybe(title)
            .insert_before(span, format!("{word} ("))
            .insert_after(span, ")"),
    }
}

/// Returns the name of an operand for an example in a help text: of the flow that it reads, else `x`.
pub(crate) fn operand_name(cx: &Body<'_, '_>, operand: ExprId) -> String {
    match &cx.unit.expr(operand).kind {
        TypedKind::Flow(flow) => cx.unit.flow(*flow).name.to_string(),
        _ => "x".to_owned(),
    }
}

/// Reason why a type is expected.
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

/// Returns the label of a value of a type that is not the expected one.
fn found_label(ty: &Ty) -> String {
    match ty {
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

/// Returns the diagnostic for an array whose size differs from the expected one.
fn const_size(expected: u32, found: u32, span: Span) -> Diagnostic {
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
    .help(match found > expected {
        true => "take a part of the array: `x[0..2]`, or declare a larger size",
        false => "add elements: `x | y`, or declare a smaller size",
    })
}

/// Returns the diagnostic for an undefined name.
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

/// Returns the diagnostic for a field or output that a value does not have.
pub(crate) fn no_member(of: &str, name: &str, span: Span, near: Option<String>) -> Diagnostic {
    let diagnostic =
        Diagnostic::new(Code::RPI1004, format!("{of} has no `{name}`")).primary(span, "not found");
    diagnostic.did_you_mean(span, near)
}

/// Returns the diagnostic for a name of another kind than expected.
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

/// Returns the sentence that lists what a value or block consists of; `noun` in the singular: "its fields are ...".
pub(crate) fn members_help<'n>(noun: &str, names: impl IntoIterator<Item = &'n str>) -> String {
    let names: Vec<&str> = names.into_iter().collect();
    match names.len() {
        0 => format!("it has no {noun}s"),
        1 => format!("its only {noun} is {}", join_names(names)),
        _ => format!("its {noun}s are {}", join_names(names)),
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
