//! Brackets and ranges of other languages: `{1, 2}`, `[y, z] = f(x)`, `f<<x>>`, `0..3`; string literals as comments.

use super::word_operators::is_operand_position;
use super::{ForeignSyntax, Repair, foreign_syntax};
use crate::Dialect;
use crate::syntax_errors::ErrorContext;
use crate::token::Token;
use rpi_diag::Fix;

/// Recognises an array literal in braces: `a = {1, 2, 3};`.
pub(super) fn array_in_braces(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    use Token::{False, Ident, Int, LBrace, LBracket, Minus, RBracket, Real, True};
    let at = found.error.index;
    let open = at.checked_sub(1)?;
    let is_element = matches!(
        found.token_at(at),
        Some(False | Ident | Int | Minus | Real | True)
    );
    let is_value = found.token_at(open) == Some(LBrace) && is_operand_position(found, open);
    let close = found.structure.partner(open)?;
    if !is_element
        || !is_value
        || found.cx.dialect == Dialect::Lustre
        || !is_list(found, open, close)
    {
        return None;
    }
    let fix = Fix::sure("write `[ ]`")
        .replace(found.token_span(open), "[")
        .replace(found.token_span(close), "]");
    let diagnostic = foreign_syntax("the elements of an array are written in brackets")
        .primary(
            found.token_span(open),
            "braces enclose the fields of a struct",
        )
        .secondary(found.token_span(close), "the array ends here")
        .fix(fix);
    let repair = found.replace_brackets(open, close, [LBracket, RBracket]);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Returns whether the braces between the tokens `open` and `close` contain only values and no `name = value`.
fn is_list(found: &ErrorContext<'_, '_>, open: usize, close: usize) -> bool {
    let is_field = |at: usize| {
        matches!(
            found.token_at(at),
            Some(Token::Eq | Token::Semi | Token::Colon)
        ) && found.structure.parent(at) == Some(open)
    };
    !(open + 1..close).any(is_field)
}

/// Recognises left sides in brackets: `[y, z] = f(x);`.
pub(super) fn targets_in_brackets(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    use Token::{Eq, LBracket, LParen, RParen};
    let at = found.error.index;
    let close = found.structure.partner(at)?;
    let is_target = found.token_at(at) == Some(LBracket) && found.expects_equation();
    if !is_target || found.token_at(close + 1) != Some(Eq) {
        return None;
    }
    let diagnostic =
        foreign_syntax("several flows on the left of an equation are written in parentheses")
            .primary(
                found.range_span(at..close + 1),
                "brackets enclose the elements of an array",
            )
            .fix(
                Fix::sure("write `( )`")
                    .replace(found.token_span(at), "(")
                    .replace(found.token_span(close), ")"),
            );
    let repair = found.replace_brackets(at, close, [LParen, RParen]);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Recognises a call with its arguments in `<< >>`: `f<<x, c>>;`.
pub(super) fn arguments_in_static_brackets(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    let close = at
        .checked_sub(1)
        .filter(|at| found.token_at(*at) == Some(Token::RStatic))?;
    let open = found.structure.partner(close)?;
    let callee = open
        .checked_sub(1)
        .filter(|at| found.token_at(*at) == Some(Token::Ident))?;
    // With a gap before `<<`, or across two statements, `<<` and `>>` are shift operators.
    let is_apart = found.lexemes[callee].end != found.lexemes[open].start;
    let is_broken = (open..close).any(|at| found.token_at(at) == Some(Token::Semi));
    if !found.expects(Token::LParen)
        || found.expects(Token::Plus)
        || is_apart
        || is_broken
        || !is_operand_position(found, callee)
    {
        return None;
    }
    let name = found.source_text(callee);
    let meant = format!("{name}({})", found.range_text(open + 1..close));
    let diagnostic = foreign_syntax("the arguments of a call are written in `( )`")
        .primary(
            found.range_span(open..close + 1),
            "`<< >>` encloses static arguments, which are fixed at load time",
        )
        .help(format!(
            "`{name}(...)`, or `{name}<<...>>(...)` if it has static parameters"
        ))
        .fix(Fix::maybe(format!("write `{meant}`")).replace(found.range_span(callee..at), meant));
    let repair = found.replace_brackets(open, close, [Token::LParen, Token::RParen]);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Recognises a range test within an expression, which RPI writes as two comparisons: `x in 0..3`.
pub(super) fn range_test(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    if found.token_at(at) != Some(Token::DotDot) {
        return None;
    }
    let phrase = found.structure.phrase(at);
    let word = (phrase.start..at)
        .rev()
        .find(|at| found.source_text(*at) == "in")?;
    let value = word.checked_sub(1).map_or("x", |at| found.source_text(at));
    let diagnostic = foreign_syntax("a range is written as two comparisons")
        .primary(
            found.range_span(word..at + 1),
            "keyword of another language",
        )
        .help(format!("`0 <= {value} and {value} < 3`"));
    Some(ForeignSyntax {
        diagnostic,
        repair: Repair::RemoveErrorPhrase,
    })
}

/// Recognises a list comprehension: `[f(a) for a in xs]`.
pub(super) fn comprehension(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    if found.source_text(at) != "for" || !found.expects(Token::Plus) {
        return None;
    }
    let diagnostic = foreign_syntax("an array is computed element by element with `map`")
        .primary(found.token_span(at), "there are no loops")
        .help(
            "`map<<f, 3>>(a)` applies `f` to each of 3 elements; `red<<+, 3>>(0, a)` is their sum",
        );
    Some(ForeignSyntax {
        diagnostic,
        repair: Repair::RemoveErrorPhrase,
    })
}

/// Recognises string literals as comments among equations: `"""what this does"""`.
pub(super) fn string_as_comment(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    let is_text = |at: usize| found.token_at(at) == Some(Token::Str);
    if !is_text(at) || !found.expects_equation() {
        return None;
    }
    let end = (at..).find(|at| !is_text(*at)).unwrap_or(at + 1);
    let diagnostic = foreign_syntax("comments begin with `--`")
        .primary(
            found.range_span(at..end),
            "a string literal is not an equation",
        )
        .help("write the documentation of a declaration before it, after `--|`");
    let semi = usize::from(found.token_at(end) == Some(Token::Semi));
    let repair = Repair::ReplaceTokens(vec![(at..end + semi, Vec::new())]);
    Some(ForeignSyntax { diagnostic, repair })
}
