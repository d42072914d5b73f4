//! Operators of other languages and incomplete expressions.

use super::conditional_extent::{has_own_operator, with_extent_fix};
use super::{ForeignSyntax, Repair, foreign_syntax};
use crate::syntax_errors::ErrorContext;
use crate::token::Token;
use rpi_diag::{Code, Diagnostic, Fix, Span};

/// Recognises a product without `*` after a percentage: `50% x`.
///
/// The `%` must follow its number directly, and a space or parenthesis must separate it from the factor. Otherwise it
/// may be the remainder operator of C.
pub(super) fn percent_product(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    use Token::{Ident, Int, LParen, Percent, Real};
    let at = found.error.index;
    let number = at.checked_sub(2)?;
    let shape = [number, at - 1, at].map(|at| found.token_at(at));
    if !matches!(
        shape,
        [
            Some(Int | Real),
            Some(Percent),
            Some(Ident | Int | LParen | Real)
        ]
    ) {
        return None;
    }
    let [number, percent, factor] = [number, at - 1, at].map(|at| found.lexemes[at]);
    let is_apart = percent.end < factor.start || factor.token == LParen;
    if number.end != percent.start || !is_apart || !found.expects(Token::Star) {
        return None;
    }
    let gap = found.cx.span(percent.end, factor.start);
    let diagnostic = foreign_syntax("a product is written with `*`")
        .primary(found.token_span(at), "expected `*` before this")
        .help("`%` after a number means per cent, `60%` is 0.6; a remainder is written `mod`")
        .fix(Fix::maybe("insert `*`").replace(gap, " * "));
    let repair = Repair::ReplaceTokens(vec![found.insertion(at, Token::Star)]);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Recognises a remainder: `x % 2`.
pub(super) fn remainder(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = match (found.token_before(), found.token_at(found.error.index)) {
        (_, Some(Token::Percent)) => found.error.index,
        (Some(Token::Percent), _) => found.error.index - 1,
        _ => return None,
    };
    let title = "write `mod`";
    // After a number, `%` is the per cent unit, and the error may be a missing operator.
    let fix = match at == found.error.index {
        true => Fix::sure(title),
        false => Fix::maybe(title),
    };
    let diagnostic = foreign_syntax("the remainder is written `mod`")
        .primary(
            found.token_span(at),
            "`%` after a number means per cent: `60%` is 0.6",
        )
        .fix(fix.replace(found.token_span(at), spaced_word(found, at, "mod")));
    let repair = Repair::ReplaceTokens(vec![found.replacement(at, &[Token::Mod])]);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Recognises `elif` and similar keywords: `if a then x elif b then y else z`.
pub(super) fn else_if(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    let word = found.source_text(at);
    let is_word = matches!(word, "elif" | "elsif" | "elseif");
    if !is_word || !found.expects(Token::Else) {
        return None;
    }
    let diagnostic = foreign_syntax("a second condition follows `else if`")
        .primary(
            found.token_span(at),
            format!("`{word}` is from another language"),
        )
        .fix(Fix::sure("write `else if`").replace(found.token_span(at), "else if"));
    let repair = Repair::ReplaceTokens(vec![found.replacement(at, &[Token::Else, Token::If])]);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Recognises a conditional expression without `else`: `y = if c then x;`.
pub(super) fn missing_else(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    use Token::{Comma, RBrace, RBracket, RParen, Semi, Tel};
    let here = found.token_at(found.error.index);
    let ends = matches!(
        here,
        None | Some(Semi | Tel | Comma | RParen | RBracket | RBrace)
    );
    if !found.expects(Token::Else) || !ends {
        return None;
    }
    let own = innermost_if(found)?;
    let end = found.token_span(found.error.index - 1);
    let diagnostic = Diagnostic::new(Code::RPI0001, "this `if` has no `else`")
        .primary(found.token_span(own), "a flow needs a value in every cycle")
        .secondary(super::imperative::end_of_span(end), "expected `else` here")
        .help("add `else` and the value for the other cycles");
    let diagnostic = match previous_value_fix(found, own) {
        Some(fix) => diagnostic.fix(fix),
        None => diagnostic,
    };
    Some(ForeignSyntax {
        diagnostic,
        repair: Repair::RemoveErrorPhrase,
    })
}

/// Returns the fix for an equation `y = if c then a` that keeps the value of the previous cycle while `c` is false:
/// `y = a -> if c then a else pre y`.
fn previous_value_fix(found: &ErrorContext<'_, '_>, own: usize) -> Option<Fix> {
    let end = found.error.index;
    let (sign, name) = (own.checked_sub(1)?, own.checked_sub(2)?);
    let shape = [found.token_at(name), found.token_at(sign)];
    let is_equation = shape == [Some(Token::Ident), Some(Token::Eq)];
    if !is_equation || found.structure.phrase(own).start != name {
        return None;
    }
    let then = (own..end).find(|at| found.token_at(*at) == Some(Token::Then))?;
    let (name, value) = (found.source_text(name), found.range_text(then + 1..end));
    let is_simple = (then + 1..end).all(|at| {
        matches!(
            found.token_at(at),
            Some(Token::Dot | Token::Ident | Token::Int | Token::Real)
        )
    });
    let title = format!("keep the previous value of `{name}` in the other cycles");
    is_simple.then(|| {
        Fix::maybe(title)
            .insert_before(found.token_span(own), format!("{value} -> "))
            .insert_after(found.token_span(end - 1), format!(" else pre {name}"))
    })
}

/// Returns the token index of the innermost `if` before the rejected token that has no `else` yet; `None` if there is
/// none.
pub(super) fn innermost_if(found: &ErrorContext<'_, '_>) -> Option<usize> {
    let mut open = 0;
    let is_own = |at: &usize| match found.token_at(*at) {
        Some(Token::Else) => {
            open += 1;
            false
        }
        Some(Token::If) if open == 0 => true,
        Some(Token::If) => {
            open -= 1;
            false
        }
        _ => false,
    };
    (0..found.error.index).rev().find(is_own)
}

/// Recognises a conditional expression with a closing keyword: `y = if c then x else z end;`.
pub(super) fn closing_keyword(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    let is_word = matches!(found.source_text(at), "end" | "endif" | "fi");
    let phrase = found.structure.phrase(at);
    let has_if = phrase
        .clone()
        .any(|at| found.token_at(at) == Some(Token::If));
    let is_last = found.token_at(at + 1) == Some(Token::Semi);
    if !is_word || !has_if || !is_last || !found.expects(Token::Semi) {
        return None;
    }
    let diagnostic = foreign_syntax("an `if` ends with its `else` value")
        .primary(
            found.token_span(at),
            "a conditional expression has no closing keyword",
        )
        .fix(
            fix_unless_declared(found, at, format!("delete `{}`", found.source_text(at)))
                .replace(found.token_span(at), ""),
        );
    let repair = Repair::ReplaceTokens(vec![(at..at + 1, Vec::new())]);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Creates a fix with a title. The fix is sure unless token `at` is a declared name, before which an operator could be
/// missing.
fn fix_unless_declared(found: &ErrorContext<'_, '_>, at: usize, title: String) -> Fix {
    match found.cx.guessed_names.declares(found.source_text(at)) {
        true => Fix::maybe(title),
        false => Fix::sure(title),
    }
}

/// Recognises the conditional operator of C: `c ? x : y`.
pub(super) fn c_conditional(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    if found.token_at(at) != Some(Token::Question) || !found.expects(Token::Plus) {
        return None;
    }
    let (start, end) = operand_range(found, at);
    let level = found.structure.parent(at);
    let here = |i: &usize| found.structure.parent(*i) == level;
    // Within a branch of an outer conditional, the condition begins after `then` or `else`.
    let begins = |i: &usize| matches!(found.token_at(*i), Some(Token::Then | Token::Else));
    let branch = (start..at).rev().filter(here).find(begins);
    let start = branch.map_or(start, |branch| branch + 1);
    let mut inner = 0;
    let colon = (at + 1..end)
        .filter(here)
        .find(|i| match found.token_at(*i) {
            Some(Token::Question) => {
                inner += 1;
                false
            }
            Some(Token::Colon) if inner > 0 => {
                inner -= 1;
                false
            }
            token => token == Some(Token::Colon),
        })?;
    let diagnostic = foreign_syntax("a conditional expression is written `if c then x else y`")
        .primary(found.token_span(at), "`? :` is from another language");
    if has_own_operator(found, start..end) {
        let value = found.range_text(at + 1..colon);
        return Some(ForeignSyntax {
            diagnostic: with_extent_fix(
                found,
                diagnostic,
                [start..at, colon + 1..end],
                |c, other| format!("if {c} then {value} else {other}"),
            ),
            repair: Repair::RemoveErrorPhrase,
        });
    }
    let fix = Fix::sure("write `if ... then ... else ...`")
        .insert_before(found.token_span(start), "if ")
        .replace(found.token_span(at), spaced_word(found, at, "then"))
        .replace(found.token_span(colon), spaced_word(found, colon, "else"));
    let diagnostic = diagnostic.fix(fix);
    let repair = Repair::ReplaceTokens(vec![
        found.insertion(start, Token::If),
        found.replacement(at, &[Token::Then]),
        found.replacement(colon, &[Token::Else]),
    ]);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Returns `word` with the spaces that it needs in the source text in place of token `at`.
fn spaced_word(found: &ErrorContext<'_, '_>, at: usize, word: &str) -> String {
    super::foreign_operators::with_spaces(found.token_span(at), found.cx.text, word)
}

/// Returns the start and end of the token range of the list element, or of the right side of the equation, that
/// contains token `at`.
pub(super) fn operand_range(found: &ErrorContext<'_, '_>, at: usize) -> (usize, usize) {
    let level = found.structure.parent(at);
    let phrase = found.structure.phrase(at);
    let same = |i: &usize| found.structure.parent(*i) == level;
    let token = |i: usize| found.token_at(i);
    let first = level.map_or(phrase.start, |open| phrase.start.max(open + 1));
    let ends = |i: &usize| same(i) && matches!(token(*i), Some(Token::Comma | Token::Semi));
    let comma = (first..at)
        .rev()
        .find(ends)
        .map_or(first, |comma| comma + 1);
    let is_eq = |i: &usize| same(i) && token(*i) == Some(Token::Eq);
    let start = match phrase.start == comma {
        true => (comma..at).find(is_eq).map_or(comma, |eq| eq + 1),
        false => comma,
    };
    let closes = |i: &usize| ends(i) || level.is_some() && found.structure.partner(*i) == level;
    let end = (at..phrase.end).find(closes).unwrap_or(phrase.end);
    (start, end)
}

/// Recognises a unit without brackets: `3 mm`.
pub(super) fn bare_unit(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    let is_number = matches!(found.token_before(), Some(Token::Int | Token::Real));
    if !is_number || found.token_at(at) != Some(Token::Ident) || !found.expects(Token::Plus) {
        return None;
    }
    let number = found.lexemes[at - 1];
    let gap = found.cx.slice(number.end, found.lexemes[at].start);
    let apart = !gap.is_empty() && gap.chars().all(|c| matches!(c, ' ' | '\t'));
    if !apart {
        return None;
    }
    let start = found.lexemes[at].start as usize;
    let word = found.lexemes[at].end as usize;
    let end = word + crate::unit_suffix::unit_rest_len(&found.cx.text[word..]);
    let after = found.lexemes[at..]
        .iter()
        .take_while(|lexeme| (lexeme.end as usize) <= end);
    let last = at + after.count();
    let unit = &found.cx.text[start..end];
    let place = found.cx.span(number.end, end as u32);
    let diagnostic = Diagnostic::new(
        Code::RPI0007,
        format!("a unit is written in brackets: `[{unit}]`"),
    )
    .primary(found.token_span(at), "a unit needs brackets")
    .fix(Fix::maybe(format!("write `[{unit}]`")).replace(place, format!("[{unit}]")));
    let repair = Repair::ReplaceTokens(vec![
        found.insertion(at, Token::LBracket),
        found.insertion(last, Token::RBracket),
    ]);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Recognises a product without `*`: `3(x + 1)`, `(a + b)(c + d)`, `2 x`.
pub(super) fn missing_star(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    use Token::{Ident, Int, LParen, RParen, Real};
    let at = found.error.index;
    let before = found.token_before()?;
    let is_number = matches!(before, Int | Real);
    let is_factor = match found.token_at(at)? {
        LParen => is_number || before == RParen && !ends_arguments(found, at - 1),
        Ident => is_number && found.cx.guessed_names.declares(found.source_text(at)),
        _ => false,
    };
    let gap = found
        .cx
        .span(found.lexemes[at - 1].end, found.lexemes[at].start);
    let same_line = !found.cx.slice(gap.start, gap.end).contains('\n');
    if !is_factor || !same_line || !found.expects(Token::Star) {
        return None;
    }
    if let Some(unit) = unit_in_parentheses(found, at, is_number) {
        return Some(unit);
    }
    let diagnostic = foreign_syntax("a product is written with `*`")
        .primary(found.token_span(at), "expected `*` before this")
        .fix(Fix::maybe("insert `*`").replace(gap, " * "));
    let repair = Repair::ReplaceTokens(vec![found.insertion(at, Token::Star)]);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Recognises a unit in parentheses, `250(mm)`, whose opening parenthesis is at token `at`. `is_number` is true if a
/// number precedes it.
fn unit_in_parentheses(
    found: &ErrorContext<'_, '_>,
    at: usize,
    is_number: bool,
) -> Option<ForeignSyntax> {
    let close = found.structure.partner(at).filter(|_| is_number)?;
    let is_part = |at: usize| {
        let is_sign = matches!(
            found.token_at(at),
            Some(Token::Slash | Token::Star | Token::Hat | Token::Int)
        );
        let name = found.source_text(at);
        let is_name = found.token_at(at) == Some(Token::Ident) && name.len() <= 4;
        is_sign || is_name && !found.cx.guessed_names.declares(name)
    };
    if found.token_at(at + 1) != Some(Token::Ident) || !(at + 1..close).all(is_part) {
        return None;
    }
    let unit = found.range_text(at + 1..close);
    let place = found.range_span(at..close + 1);
    let message = format!("a unit is written in brackets: `[{unit}]`");
    let diagnostic = Diagnostic::new(Code::RPI0007, message)
        .primary(place, "parentheses after a value do not form a unit")
        .fix(Fix::maybe(format!("write `[{unit}]`")).replace(place, format!("[{unit}]")));
    let repair = found.replace_brackets(at, close, [Token::LBracket, Token::RBracket]);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Returns whether the parenthesis at token `close` ends the argument list of a call, and not an expression in
/// parentheses.
fn ends_arguments(found: &ErrorContext<'_, '_>, close: usize) -> bool {
    let open = found.structure.partner(close);
    let before = open
        .and_then(|open| open.checked_sub(1))
        .and_then(|at| found.token_at(at));
    matches!(before, Some(Token::Ident | Token::Path | Token::RStatic))
}

/// Recognises a struct value with `:` after its fields: `P { x: 1.0 }`.
pub(super) fn field_by_colon(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    let inside = found
        .structure
        .parent(at)
        .and_then(|open| found.token_at(open));
    let is_field = found.token_before() == Some(Token::Ident) && found.expects(Token::Eq);
    if found.token_at(at) != Some(Token::Colon) || inside != Some(Token::LBrace) || !is_field {
        return None;
    }
    let diagnostic = foreign_syntax("the fields of a struct value are set with `=`")
        .primary(found.token_span(at), "`:` follows argument names in calls")
        .fix(Fix::sure("write `=`").replace(found.token_span(at), " ="));
    let repair = Repair::ReplaceTokens(vec![found.replacement(at, &[Token::Eq])]);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Recognises a struct value without its type: `limits: Limits = { speed = 1.0 }`.
pub(super) fn struct_without_type(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    use Token::{Colon, Eq, Ident, LBrace, RBrace};
    let at = found.error.index;
    let begins = found.token_before() == Some(LBrace) && found.token_at(at) == Some(Ident);
    let is_field = matches!(found.token_at(at + 1), Some(Eq | Colon));
    if !begins || !is_field || !found.expects(RBrace) {
        return None;
    }
    let brace = found.token_span(at - 1);
    let before = |back: usize| at.checked_sub(back).and_then(|at| found.token_at(at));
    let diagnostic = foreign_syntax("a struct value begins with its type");
    let diagnostic = match [before(4), before(3), before(2)] {
        [Some(Colon), Some(Ident), Some(Eq)] => {
            let ty = found.source_text(at - 3);
            let place = Span {
                end: brace.start,
                ..brace
            };
            let fix = Fix::sure(format!("write `{ty} {{`")).replace(place, format!("{ty} "));
            diagnostic
                .primary(brace, format!("expected `{ty}` before this"))
                .fix(fix)
        }
        _ => diagnostic
            .primary(brace, "expected the name of a struct type before this")
            .help("for example `Point {x = 1.0; y = 2.0}`"),
    };
    Some(ForeignSyntax {
        diagnostic,
        repair: Repair::RemoveErrorPhrase,
    })
}

/// Recognises a closing bracket without its opening one: `(x + 1))`.
pub(super) fn unmatched_bracket(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    use Token::{RBrace, RBracket, RParen, RStatic};
    let at = found.error.index;
    let closes = matches!(
        found.token_at(at),
        Some(RParen | RBracket | RBrace | RStatic)
    );
    if !closes
        || found.structure.partner(at).is_some()
        || found.structure.unclosed_bracket(at).is_some()
    {
        return None;
    }
    let written = found.source_text(at);
    let diagnostic = Diagnostic::new(Code::RPI0001, format!("unmatched `{written}`"))
        .primary(found.token_span(at), "no bracket is open here")
        .fix(Fix::maybe(format!("delete `{written}`")).replace(found.token_span(at), ""));
    let repair = Repair::ReplaceTokens(vec![(at..at + 1, Vec::new())]);
    Some(ForeignSyntax { diagnostic, repair })
}
