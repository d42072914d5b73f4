//! Where a body inside another one should have ended that has no `tel`.
//!
//! Tokens alone can not tell: the next `tel`, which is that of the body around it, would close it as well. What tells is a
//! statement that can not stand inside (a result of a command), and the layout: what begins a line no further in than the
//! statement that has the body is not part of it.

use crate::explain::{Found, after};
use crate::lexer::Lexeme;
use crate::token::Token;
use rpi_diag::{Code, Finding, Fix};
use std::collections::BTreeMap;

/// A body that should have ended.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Unclosed {
    /// Its `let`.
    open: usize,
    /// The token before which it should have ended.
    pub(crate) before: usize,
}

/// The first body inside another that goes on where it can not.
pub(crate) fn unclosed(found: &Found<'_, '_>) -> Option<Unclosed> {
    // How far in the statements are that have a body.
    let mut indents = BTreeMap::new();
    (1..found.lexemes.len()).find_map(|before| {
        let open = inner_body(found, before)?;
        let token = found.lexemes[before].token;
        let ends_command = matches!(token, Token::Finish | Token::Yield | Token::Fail);
        let is_out = |here: usize| {
            let owner = indents
                .entry(open)
                .or_insert_with(|| indent_of(found, open));
            here < *owner || here == *owner && token != Token::Tel
        };
        let here = found.cx.indent(found.lexemes[before].start);
        (ends_command || here.is_some_and(is_out)).then_some(Unclosed { open, before })
    })
}

/// The `let` of the body inside another in which a further statement begins here, or that ends here.
fn inner_body(found: &Found<'_, '_>, at: usize) -> Option<usize> {
    let ends_statement = matches!(
        found.lexemes[at - 1].token,
        Token::Semi | Token::Tel | Token::End
    );
    let open = match found.lexemes[at].token {
        Token::Tel => found.structure.partner(at),
        _ if ends_statement => found.structure.parent(at),
        _ => None,
    }?;
    let is_inner = found.structure.parent(open).is_some();
    (is_inner && found.lexemes[open].token == Token::Let).then_some(open)
}

/// How far in the line begins in which the statement with this body does.
fn indent_of(found: &Found<'_, '_>, open: usize) -> usize {
    let first = found.lexemes[found.structure.phrase(open).start];
    found.cx.indent_of_line(first.start).len()
}

/// The finding about it.
pub(crate) fn finding(found: &Found<'_, '_>, unclosed: Unclosed) -> Finding {
    let Lexeme { start, end, .. } = found.lexemes[unclosed.open];
    let (last, next) = (
        found.lexemes[unclosed.before - 1],
        found.lexemes[unclosed.before],
    );
    let is_one_line = !found.cx.slice(start, last.end).contains('\n');
    let tel = match is_one_line {
        true => " tel".to_owned(),
        false => format!("\n{}tel", found.cx.indent_of_line(start)),
    };
    let behind = after(found.cx.span(last.start, last.end));
    Finding::new(Code::RPI0004, "this body has no end")
        .at(found.cx.span(start, end), "no `tel` for this `let`")
        .also(
            found.cx.span(next.start, next.end),
            "expected `tel` before this",
        )
        .fix(Fix::maybe("insert `tel`").insert_after(behind, tel))
}
