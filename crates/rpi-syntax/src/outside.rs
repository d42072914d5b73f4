//! Findings about what stands outside of any declaration.

use crate::context::Context;
use crate::lexer::Lexeme;
use crate::token::Token;
use rpi_diag::{Code, Finding, Fix};

/// A name that resembles the word of a declaration, where such a word is expected.
pub(crate) fn misspelt(cx: &Context<'_>, name: Lexeme, word: Token) -> Finding {
    let meant = word.spelling().unwrap_or_default();
    let written = cx.slice(name.start, name.end);
    let span = cx.span(name.start, name.end);
    Finding::new(
        Code::RPI0010,
        format!("no declaration begins with `{written}`"),
    )
    .at(span, format!("did you mean `{meant}`?"))
    .fix(Fix::maybe(format!("write `{meant}`")).replace(span, meant))
}

/// Anything else outside of declarations.
pub(crate) fn stray(cx: &Context<'_>, lexemes: &[Lexeme]) -> Finding {
    let first = lexemes[0];
    let written = cx.slice(first.start, first.end);
    let finding = Finding::new(
        Code::RPI0010,
        format!("`{written}` stands outside of any declaration"),
    );
    let span = cx.span(first.start, first.end);
    match first.token {
        Token::Tel => finding.at(span, "closes a body that is not open"),
        _ => finding
            .at(span, "no declaration begins like this")
            .help("equations stand between `let` and `tel`, in a node, fragment, command or test"),
    }
}
