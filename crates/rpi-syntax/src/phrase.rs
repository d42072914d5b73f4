//! Findings about phrases that the grammar accepts and the language does not.

use crate::ast::Ident;
use rpi_diag::{Code, Finding, Fix, Span};

/// `a < b < c`; `middle` is the place and text of `b`.
pub(crate) fn comparisons_in_a_row(signs: [Span; 2], middle: Option<(Span, &str)>) -> Finding {
    let finding = Finding::new(Code::RPI0009, "comparisons do not follow one another")
        .at(signs[1], "compares the result of a comparison")
        .also(signs[0], "the comparison before it");
    let finding = finding.help("write `a < b and b < c`, or set parentheses");
    match middle {
        Some((span, text)) => {
            let fix = Fix::maybe("join them by `and`");
            finding.fix(fix.insert_after(span, format!(" and {text}")))
        }
        None => finding,
    }
}

/// One more comparison in the row, whose sign is the one that is told.
pub(crate) fn further_comparison(
    mut last: Finding,
    sign: Span,
    middle: Option<(Span, &str)>,
) -> Finding {
    let fix = last.fixes.pop().zip(middle);
    let told = fix.map(|(fix, (span, text))| fix.insert_after(span, format!(" and {text}")));
    last.fixes.extend(told);
    last.also(sign, "and one more")
}

pub(crate) fn when_binds_tightly(part: Span) -> Finding {
    let fix = Fix::maybe("set parentheses")
        .insert_before(part, "(")
        .insert_after(part, ")");
    Finding::new(
        Code::RPI0015,
        "`when` is read as in Lustre V6: it binds before other operators",
    )
    .at(
        part,
        "only this is sampled; other compilers may sample more",
    )
    .fix(fix)
}

/// `when c then x else y`; the place is that of its first word.
pub(crate) fn when_as_if(word: Span) -> Finding {
    Finding::new(Code::RPI0016, "a choice is written `if c then x else y`")
        .at(word, "`when` samples a flow, or activates a fragment")
        .fix(Fix::sure("write `if`").replace(word, "if"))
}

/// `-x ** y`; the sign with its operand, the operator with what follows, and the text of all.
pub(crate) fn sign_before_power(base: Span, power: Span, text: &str) -> Finding {
    let operand = text[1..(base.end - base.start) as usize].trim_start();
    let rest = text[(base.end - base.start) as usize..].trim_start();
    let negated = format!("-({operand} {rest})");
    let whole = base.merge(power);
    Finding::new(
        Code::RPI0018,
        "the sign goes before the power: this is `(-x) ** y`",
    )
    .at(base, "is raised to the power")
    .help("mathematics, Python and Fortran read it as `-(x ** y)`")
    .fix(
        Fix::maybe(format!("write `(-{operand})`, which is the same"))
            .insert_before(base, "(")
            .insert_after(base, ")"),
    )
    .fix(Fix::maybe(format!("write `{negated}`")).replace(whole, negated))
}

pub(crate) fn unit_head(span: Span, text: &str) -> Finding {
    let finding = Finding::new(Code::RPI0001, "a number is no unit")
        .at(span, "expected the name of a unit, or `1` as in `1/s`");
    let number = &text[span.start as usize..span.end as usize];
    let brackets = Span {
        start: span.start.saturating_sub(1),
        end: span.end + 1,
        ..span
    };
    match text.get(brackets.start as usize..brackets.end as usize) {
        Some(whole) if whole == format!("[{number}]") => finding
            .help(format!(
                "the size of an array stands behind `^`: `real^{number}`"
            ))
            .fix(Fix::maybe(format!("write `^{number}`")).replace(brackets, format!("^{number}"))),
        _ => finding,
    }
}

pub(crate) fn unit_power(span: Span) -> Finding {
    Finding::new(Code::RPI0008, "this power is too large for a unit").at(span, "more than 99")
}

pub(crate) fn no_bits(span: Span) -> Finding {
    Finding::new(Code::RPI0001, "expected `]` or `..` after the index")
        .at(
            span,
            "only machine integers of Kind 2 are taken apart like this",
        )
        .help("elements that follow one another: `a[1..3]`, the last one with them")
}

/// `x: int | x > 0` outside of Lustre.
pub(crate) fn no_condition(span: Span) -> Finding {
    Finding::new(Code::RPI0001, "a port's type has no condition")
        .at(span, "a condition of Kind 2")
        .help("claim it: `assume x > 0`")
}

pub(crate) fn no_subrange(word: &Ident) -> Finding {
    Finding::new(Code::RPI0001, format!("`{}` takes no bounds", word.name))
        .at(word.span, "only `subrange` does")
}
