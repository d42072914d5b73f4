//! Findings about phrases that the grammar accepts and the language does not.

use crate::ast::Ident;
use rpi_diag::{Code, Finding, Fix, Span};

pub(crate) fn comparisons_in_a_row(first: Span, second: Span) -> Finding {
    Finding::new(Code::RPI0009, "comparisons do not follow one another")
        .at(second, "compares the result of a comparison")
        .also(first, "the comparison before it")
        .help("write `a < b and b < c`, or set parentheses")
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

pub(crate) fn unit_head(span: Span) -> Finding {
    Finding::new(Code::RPI0001, "only `1` may stand for no unit")
        .at(span, "expected `1`, as in `1/s`, or the name of a unit")
}

pub(crate) fn unit_power(span: Span) -> Finding {
    Finding::new(Code::RPI0008, "this power is too large for a unit").at(span, "more than 99")
}

pub(crate) fn no_subrange(word: &Ident) -> Finding {
    Finding::new(Code::RPI0001, format!("`{}` takes no bounds", word.name))
        .at(word.span, "only `subrange` does")
}
