//! Diagnostics for phrases that the grammar accepts and the language does not allow.

use crate::ast::Ident;
use rpi_diag::{Code, Diagnostic, Fix, Quote, Span};

/// Returns the diagnostic for chained comparisons, `a < b < c` (RPI0009). `signs` are the places of the operators.
/// `middle` is the place and text of `b` if both comparisons may be meant.
pub(crate) fn chained_comparison(signs: [Span; 2], middle: Option<(Span, &str)>) -> Diagnostic {
    let diagnostic = Diagnostic::new(Code::RPI0009, "comparisons cannot be chained")
        .primary(signs[1], "compares the result of a comparison")
        .secondary(signs[0], "previous comparison");
    let diagnostic = diagnostic.help("join two comparisons with `and`, or add parentheses");
    match middle {
        Some((span, text)) => {
            let fix = Fix::maybe("join them with `and`");
            diagnostic.fix(fix.insert_after(span, format!(" and {text}")))
        }
        None => diagnostic,
    }
}

/// Adds one more comparison to the diagnostic `last` about a chain. `sign` is the place of its operator; `middle` is
/// the place and text of its left operand.
pub(crate) fn extend_chained_comparison(
    mut last: Diagnostic,
    sign: Span,
    middle: Option<(Span, &str)>,
) -> Diagnostic {
    let fix = last.fixes.pop().zip(middle);
    let fix = fix.map(|(fix, (span, text))| fix.insert_after(span, format!(" and {text}")));
    last.fixes.extend(fix);
    last.secondary(sign, "another comparison")
}

/// Returns the warning about `x when c` as an operand of an operator (RPI0015). `part` is the place of the sampled
/// expression.
pub(crate) fn when_precedence(part: Span) -> Diagnostic {
    let fix = Fix::maybe("add parentheses")
        .insert_before(part, "(")
        .insert_after(part, ")");
    Diagnostic::new(
        Code::RPI0015,
        "`when` is parsed as in Lustre V6: it binds more strongly than other operators",
    )
    .primary(
        part,
        "only this is sampled; other compilers may sample more",
    )
    .fix(fix)
}

/// Returns the diagnostic for `when c then x else y`, which RPI writes with `if`. `word` is the place of `when`.
pub(crate) fn when_as_if(word: Span) -> Diagnostic {
    Diagnostic::new(
        Code::RPI0016,
        "a conditional expression is written `if c then x else y`",
    )
    .primary(word, "`when` samples a flow or activates a fragment")
    .fix(Fix::sure("write `if`").replace(word, "if"))
}

/// Returns the warning about `-x ** y` (RPI0018). `base` is the place of `-x`, `power` that of the exponent, `text` the
/// whole expression.
pub(crate) fn sign_before_power(base: Span, power: Span, text: &str) -> Diagnostic {
    let operand = text[1..(base.end - base.start) as usize].trim_start();
    let rest = text[(base.end - base.start) as usize..].trim_start();
    let negated = format!("-({operand} {rest})");
    let whole = base.merge(power);
    Diagnostic::new(
        Code::RPI0018,
        format!("the sign binds more strongly than the power: this is `(-{operand}) {rest}`"),
    )
    .primary(base, "this is raised to the power")
    .help(format!(
        "in mathematics, Python and Fortran it is `{negated}`"
    ))
    .fix(
        Fix::maybe(format!("write `(-{operand})`, which is the same"))
            .insert_before(base, "(")
            .insert_after(base, ")"),
    )
    .fix(Fix::maybe(format!("write `{negated}`")).replace(whole, negated))
}

/// Returns the diagnostic for a number other than 1 in a unit, as in `1[3/s]`. `span` is the place of the number,
/// `text` the text of the file.
pub(crate) fn number_as_unit(span: Span, text: &str) -> Diagnostic {
    let diagnostic = Diagnostic::new(Code::RPI0001, "a number is not a unit")
        .primary(span, "expected the name of a unit, or `1` as in `1/s`");
    let number = &text[span.start as usize..span.end as usize];
    let brackets = Span {
        start: span.start.saturating_sub(1),
        end: span.end + 1,
        ..span
    };
    match text.get(brackets.start as usize..brackets.end as usize) {
        Some(whole) if whole == format!("[{number}]") => diagnostic
            .help(format!("the size of an array follows `^`: `real^{number}`"))
            .fix(Fix::maybe(format!("write `^{number}`")).replace(brackets, format!("^{number}"))),
        _ => diagnostic,
    }
}

/// Returns the diagnostic for an exponent of a unit above 99 (RPI0008).
pub(crate) fn exponent_too_large(span: Span) -> Diagnostic {
    Diagnostic::new(Code::RPI0008, "the exponent of a unit is too large")
        .primary(span, "the maximum is 99")
}

/// Reports a range `x[7:0]` outside of Lustre files, where it selects bits.
pub(crate) fn unsupported_bit_range(first: Span, last: Span) -> Diagnostic {
    Diagnostic::new(Code::RPI0001, "expected `]` or `..` after the index")
        .primary(first.merge(last), "a range of indices has no `:`")
        .help(format!(
            "a slice of an array is written `[{}..{}]`, both ends included",
            Quote::text(first),
            Quote::text(last)
        ))
}

/// Returns the diagnostic for a port with a condition, such as `x: int | x > 0`, outside of Lustre files.
pub(crate) fn unsupported_condition(span: Span) -> Diagnostic {
    Diagnostic::new(Code::RPI0001, "the type of a port cannot have a condition")
        .primary(span, "condition of Kind 2")
        .help(format!(
            "state it in a contract before `let`: `con assume {0}; noc` for an in-port, `con guarantee {0}; noc` for an out-port",
            Quote::text(span)
        ))
}

/// Returns the diagnostic for bounds `[from, to] of` after a word other than `subrange`.
pub(crate) fn bounds_without_subrange(word: &Ident) -> Diagnostic {
    Diagnostic::new(Code::RPI0001, format!("`{}` cannot have bounds", word.name))
        .primary(word.span, "only `subrange` has bounds")
}
