//! Finds the end of a nested body without `tel`.
//!
//! The tokens alone are ambiguous, as the `tel` of the enclosing body would close the nested one. The evidence is a
//! statement that is not allowed inside (a result of a command), and the indentation: a line indented no deeper than
//! the statement that owns the body is not part of it.

use crate::lexer::Lexeme;
use crate::syntax_errors::{ErrorContext, end_of_span};
use crate::token::Token;
use rpi_diag::{Code, Diagnostic, Fix};
use std::collections::BTreeMap;

/// Body inside a declaration, such as that of a state, whose `tel` is missing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct UnclosedBody {
    /// Index of the `let` that opens the body, among the tokens of the declaration.
    let_index: usize,
    /// Index of the token before which the missing `tel` is expected.
    pub(crate) next_index: usize,
}

/// Returns the first inner body whose `tel` must be missing, because a statement with less indentation or a result of
/// the command follows in it; `None` if there is none.
pub(crate) fn find_unclosed_body(found: &ErrorContext<'_, '_>) -> Option<UnclosedBody> {
    // Indentation of the statements that own a body, by the index of its `let`.
    let mut indents = BTreeMap::new();
    (1..found.lexemes.len()).find_map(|before| {
        let open = nested_body_at(found, before)?;
        let token = found.lexemes[before].token;
        let ends_command = matches!(token, Token::Finish | Token::Yield | Token::Fail);
        let is_out = |here: usize| {
            let owner = indents
                .entry(open)
                .or_insert_with(|| owner_indent(found, open));
            here < *owner || here == *owner && token != Token::Tel
        };
        let here = found.cx.indent(found.lexemes[before].start);
        (ends_command || here.is_some_and(is_out)).then_some(UnclosedBody {
            let_index: open,
            next_index: before,
        })
    })
}

/// Returns the token index of the `let` of the inner body in which a statement begins at token `at`, or which token
/// `at` closes; `None` otherwise.
fn nested_body_at(found: &ErrorContext<'_, '_>, at: usize) -> Option<usize> {
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

/// Returns the indentation in bytes of the statement or declaration whose body begins at token `open`.
fn owner_indent(found: &ErrorContext<'_, '_>, open: usize) -> usize {
    let first = found.lexemes[found.structure.phrase(open).start];
    found.cx.indent_of_line(first.start).len()
}

/// Creates the diagnostic for an unclosed body (RPI0004), with a fix that inserts `tel`.
pub(crate) fn unclosed_body(found: &ErrorContext<'_, '_>, unclosed: UnclosedBody) -> Diagnostic {
    let Lexeme { start, end, .. } = found.lexemes[unclosed.let_index];
    let (last, next) = (
        found.lexemes[unclosed.next_index - 1],
        found.lexemes[unclosed.next_index],
    );
    let is_one_line = !found.cx.slice(start, last.end).contains('\n');
    let tel = match is_one_line {
        true => " tel".to_owned(),
        false => format!("\n{}tel", found.cx.indent_of_line(start)),
    };
    let behind = end_of_span(found.cx.span(last.start, last.end));
    Diagnostic::new(Code::RPI0004, "this body is not closed")
        .primary(
            found.cx.span(start, end),
            "this `let` has no matching `tel`",
        )
        .secondary(
            found.cx.span(next.start, next.end),
            "expected `tel` before this",
        )
        .fix(Fix::maybe("insert `tel`").insert_after(behind, tel))
}
