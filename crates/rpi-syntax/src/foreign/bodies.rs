//! Bodies without their delimiters, or between those of other languages.

use super::{ForeignSyntax, Repair, foreign_syntax};
use crate::lexer::Lexeme;
use crate::syntax_errors::ErrorContext;
use crate::token::Token;
use rpi_diag::{Code, Diagnostic, Fix};

/// Recognises a body in braces: `node f (x: real) returns (y: real) { y = x; }`.
pub(super) fn body_in_braces(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    if found.token_at(at) != Some(Token::LBrace) || !found.expects(Token::Let) {
        return None;
    }
    let close = found.structure.partner(at)?;
    let fix = Fix::sure("write `let` and `tel`")
        .replace(found.token_span(at), "let")
        .replace(found.token_span(close), "tel");
    let diagnostic = foreign_syntax("a body is written between `let` and `tel`")
        .primary(
            found.token_span(at),
            "braces enclose the fields of a struct or the values of an enum",
        )
        .secondary(found.token_span(close), "the body ends here")
        .fix(fix);
    let repair = found.replace_brackets(at, close, [Token::Let, Token::Tel]);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Recognises a body without `let`: `node f (x: real) returns (y: real) y = x; tel`.
pub(super) fn body_without_let(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    let begins_equation =
        found.token_at(at) == Some(Token::Ident) && found.token_at(at + 1) == Some(Token::Eq);
    let has_tel = found.lexemes[at..]
        .iter()
        .any(|lexeme| lexeme.token == Token::Tel);
    if !found.expects(Token::Let) || !begins_equation || at == 0 {
        return None;
    }
    let before = found.token_span(at - 1);
    if !has_tel {
        return Some(body_without_let_and_tel(found, at));
    }
    let diagnostic = Diagnostic::new(Code::RPI0001, "this body has no `let`")
        .primary(
            found.token_span(at),
            "equations are written between `let` and `tel`",
        )
        .fix(Fix::sure("insert `let`").insert_after(before, "\nlet"));
    let repair = Repair::ReplaceTokens(vec![found.insertion(at, Token::Let)]);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Reports a body without `let` and `tel`: `node f (x: real) returns (y: real) y = x;`.
fn body_without_let_and_tel(found: &ErrorContext<'_, '_>, at: usize) -> ForeignSyntax {
    let (before, last) = (found.token_span(at - 1), found.lexemes.len());
    let diagnostic = foreign_syntax("a body is written between `let` and `tel`")
        .primary(found.token_span(at), "expected `let` before this")
        .fix(
            Fix::sure("insert `let` and `tel`")
                .insert_after(before, "\nlet")
                .insert_after(found.token_span(last - 1), "\ntel"),
        );
    let repair = Repair::ReplaceTokens(vec![
        found.insertion(at, Token::Let),
        found.insertion(last, Token::Tel),
    ]);
    ForeignSyntax { diagnostic, repair }
}

/// Recognises a body without `let` after local declarations: `var z: real; y = x; tel`.
pub(super) fn no_let_after_locals(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    use Token::{Colon, Eq, Ident, Semi, Tel, Var};
    let name = found.error.index.checked_sub(1)?;
    let shape = [found.token_at(name), found.token_at(name + 1)];
    let ends_locals = name > 0 && found.token_at(name - 1) == Some(Semi);
    let has = |token| move |lexeme: &Lexeme| lexeme.token == token;
    let (before, after) = found.lexemes.split_at(name);
    if shape != [Some(Ident), Some(Eq)]
        || !ends_locals
        || !found.expects(Colon)
        || !before.iter().any(has(Var))
        || !after.iter().any(has(Tel))
    {
        return None;
    }
    let diagnostic = Diagnostic::new(Code::RPI0001, "this body has no `let`")
        .primary(
            found.token_span(name),
            "the first equation; equations are written between `let` and `tel`",
        )
        .fix(Fix::sure("insert `let`").insert_after(found.token_span(name - 1), "\nlet"));
    let repair = Repair::ReplaceTokens(vec![found.insertion(name, Token::Let)]);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Recognises a body between keywords of other languages: `begin y = x; end`.
pub(super) fn begin_end(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let fault = found.error.index;
    // After local declarations, the grammar takes the word for the next name and rejects the token after it.
    let at = match found.expects(Token::Colon) {
        true => fault.checked_sub(1)?,
        false => fault,
    };
    let is_word = match at < fault {
        true => found.source_text(at) == "begin",
        false => matches!(
            found.source_text(at),
            "begin" | "where" | "is" | "do" | "as"
        ),
    };
    if !is_word || !(at < fault || found.expects(Token::Let)) {
        return None;
    }
    let end = block_end(found, at).filter(|end| found.token_at(*end) != Some(Token::Tel));
    let diagnostic = foreign_syntax("a body is written between `let` and `tel`").primary(
        found.token_span(at),
        format!("`{}` is not a keyword", found.source_text(at)),
    );
    let fix = Fix::sure("write `let` and `tel`").replace(found.token_span(at), "let");
    let mut tokens = vec![found.replacement(at, &[Token::Let])];
    let diagnostic = match end {
        Some(end) => {
            tokens.push(found.replacement(end, &[Token::Tel]));
            let fix = fix.replace(found.token_span(end), "tel");
            diagnostic
                .secondary(found.token_span(end), "the body ends here")
                .fix(fix)
        }
        None => diagnostic.fix(fix),
    };
    let repair = Repair::ReplaceTokens(tokens);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Returns the token index of the `end` or `tel` that closes the body opened at token `begin`, skipping nested blocks;
/// `None` if there is none.
fn block_end(found: &ErrorContext<'_, '_>, begin: usize) -> Option<usize> {
    let mut open = 0;
    (begin + 1..found.lexemes.len()).find(|at| {
        match (found.token_at(*at), found.source_text(*at)) {
            (Some(Token::Let | Token::Automaton), _) | (_, "begin") => open += 1,
            (Some(Token::Tel), _) | (_, "end") if open > 0 => open -= 1,
            (Some(Token::Tel), _) | (_, "end") => return true,
            _ => {}
        }
        false
    })
}
