//! Diagnostics for phrases that the grammar accepts and the language does not allow.

use crate::ast::Ident;
use rpi_diag::{Code, Diagnostic, Fix, Span};

/// Reports `a < b < c` (RPI0009). `signs` are the operators, `middle` is the place and text of `b`.
pub(crate) fn chained_comparison(signs: [Span; 2], middle: Option<(Span, &str)>) -> Diagnostic {
    let diagnostic = Diagnostic::new(Code::RPI0009, "comparisons cannot be chained")
        .primary(signs[1], "compares the result of a comparison")
        .secondary(signs[0], "previous comparison");
    let diagnostic = diagnostic.help("write `a < b and b < c`, or add parentheses");
    match middle {
        Some((span, text)) => {
            let fix = Fix::maybe("join them with `and`");
            diagnostic.fix(fix.insert_after(span, format!(" and {text}")))
        }
        None => diagnostic,
    }
}

/// Adds a further comparison to the diagnostic about a chain. `sign` is its operator.
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

/// Warns about `x when c` as an operand of an operator (RPI0015). `part` is the sampled expression.
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

/// Reports `when c then x else y`. `word` is the place of `when`.
pub(crate) fn when_as_if(word: Span) -> Diagnostic {
    Diagnostic::new(
        Code::RPI0016,
        "a conditional expression is written `if c then x else y`",
    )
    .primary(word, "`when` samples a flow or activates a fragment")
    .fix(Fix::sure("write `if`").replace(word, "if"))
}

/// Warns about `-x ** y` (RPI0018). `base` is `-x`, `power` is the exponent, `text` is the whole expression.
pub(crate) fn sign_before_power(base: Span, power: Span, text: &str) -> Diagnostic {
    let operand = text[1..(base.end - base.start) as usize].trim_start();
    let rest = text[(base.end - base.start) as usize..].trim_start();
    let negated = format!("-({operand} {rest})");
    let whole = base.merge(power);
    Diagnostic::new(
        Code::RPI0018,
        "the sign binds more strongly than the power: this is `(-x) ** y`",
    )
    .primary(base, "this is raised to the power")
    .help("in mathematics, Python and Fortran it is `-(x ** y)`")
    .fix(
        Fix::maybe(format!("write `(-{operand})`, which is the same"))
            .insert_before(base, "(")
            .insert_after(base, ")"),
    )
    .fix(Fix::maybe(format!("write `{negated}`")).replace(whole, negated))
}

/// Reports a number other than 1 as a unit: `1[3/s]`. `text` is the text of the file.
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

/// Reports the exponent of a unit that exceeds 99 (RPI0008).
pub(crate) fn exponent_too_large(span: Span) -> Diagnostic {
    Diagnostic::new(Code::RPI0008, "the exponent of a unit is too large")
        .primary(span, "the maximum is 99")
}

/// Reports a bit range `x[7:0]` outside of Lustre files.
pub(crate) fn unsupported_bit_range(span: Span) -> Diagnostic {
    Diagnostic::new(Code::RPI0001, "expected `]` or `..` after the index")
        .primary(span, "only machine integers of Kind 2 have bit ranges")
        .help("a slice of an array is written `a[1..3]`, both ends included")
}

/// Reports a port with a condition, `x: int | x > 0`, outside of Lustre files.
pub(crate) fn unsupported_condition(span: Span) -> Diagnostic {
    Diagnostic::new(Code::RPI0001, "the type of a port cannot have a condition")
        .primary(span, "condition of Kind 2")
        .help("state it as an assumption: `assume x > 0`")
}

/// Reports bounds `[from, to] of` after a word other than `subrange`.
pub(crate) fn bounds_without_subrange(word: &Ident) -> Diagnostic {
    Diagnostic::new(Code::RPI0001, format!("`{}` cannot have bounds", word.name))
        .primary(word.span, "only `subrange` has bounds")
}
