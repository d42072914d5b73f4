//! Operators of other languages and incomplete expressions.

use super::{Habit, Mend, habit};
use crate::explain::Found;
use crate::token::Token;
use rpi_diag::{Code, Finding, Fix, Span};

/// Recognises a remainder: `x % 2`.
pub(super) fn remainder(found: &Found<'_, '_>) -> Option<Habit> {
    let at = match (found.token_before(), found.token(found.fault.at)) {
        (_, Some(Token::Percent)) => found.fault.at,
        (Some(Token::Percent), _) => found.fault.at - 1,
        _ => return None,
    };
    let title = "write `mod`";
    // After a number, `%` is the per cent unit, and the error may be a missing operator.
    let fix = match at == found.fault.at {
        true => Fix::sure(title),
        false => Fix::maybe(title),
    };
    let finding = habit("the remainder is written `mod`")
        .at(
            found.span_at(at),
            "`%` after a number means per cent: `60%` is 0.6",
        )
        .fix(fix.replace(found.span_at(at), word(found, at, "mod")));
    let mend = Mend::Tokens(vec![found.instead(at, &[Token::Mod])]);
    Some(Habit { finding, mend })
}

/// Recognises `elif` and similar keywords: `if a then x elif b then y else z`.
pub(super) fn else_if(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    let word = found.written(at);
    let is_word = matches!(word, "elif" | "elsif" | "elseif");
    if !is_word || !found.expects(Token::Else) {
        return None;
    }
    let finding = habit("a second condition follows `else if`")
        .at(
            found.span_at(at),
            format!("`{word}` is from another language"),
        )
        .fix(Fix::sure("write `else if`").replace(found.span_at(at), "else if"));
    let mend = Mend::Tokens(vec![found.instead(at, &[Token::Else, Token::If])]);
    Some(Habit { finding, mend })
}

/// Recognises a conditional expression without `else`: `y = if c then x;`.
pub(super) fn no_else(found: &Found<'_, '_>) -> Option<Habit> {
    use Token::{Comma, RBrace, RBracket, RParen, Semi, Tel};
    let here = found.token(found.fault.at);
    let ends = matches!(
        here,
        None | Some(Semi | Tel | Comma | RParen | RBracket | RBrace)
    );
    if !found.expects(Token::Else) || !ends {
        return None;
    }
    let own = own_if(found)?;
    let end = found.span_at(found.fault.at - 1);
    let finding = Finding::new(Code::RPI0001, "this `if` has no `else`")
        .at(found.span_at(own), "a flow needs a value in every cycle")
        .also(super::bodies::behind(end), "expected `else` here")
        .help("add the other value: `if c then x else y`; to keep the value of the previous cycle: `else pre y`");
    Some(Habit {
        finding,
        mend: Mend::Usual,
    })
}

/// Returns the innermost `if` before the rejected token that has no `else` yet.
pub(super) fn own_if(found: &Found<'_, '_>) -> Option<usize> {
    let mut open = 0;
    let is_own = |at: &usize| match found.token(*at) {
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
    (0..found.fault.at).rev().find(is_own)
}

/// Recognises a conditional expression with a closing keyword: `y = if c then x else z end;`.
pub(super) fn end_if(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    let is_word = matches!(found.written(at), "end" | "endif" | "fi");
    let phrase = found.structure.phrase(at);
    let has_if = phrase.clone().any(|at| found.token(at) == Some(Token::If));
    let is_last = found.token(at + 1) == Some(Token::Semi);
    if !is_word || !has_if || !is_last || !found.expects(Token::Semi) {
        return None;
    }
    let finding = habit("an `if` ends with its `else` value")
        .at(
            found.span_at(at),
            "a conditional expression has no closing keyword",
        )
        .fix(
            named_unlike(found, at, format!("delete `{}`", found.written(at)))
                .replace(found.span_at(at), ""),
        );
    let mend = Mend::Tokens(vec![(at..at + 1, Vec::new())]);
    Some(Habit { finding, mend })
}

/// Creates a fix that is sure unless token `at` is a declared name, before which an operator could be missing.
fn named_unlike(found: &Found<'_, '_>, at: usize, title: String) -> Fix {
    match found.cx.seeming.declares(found.written(at)) {
        true => Fix::maybe(title),
        false => Fix::sure(title),
    }
}

/// Creates a fix of a foreign conditional expression.
///
/// The fix is not sure if an operator is involved that only RPI has: its precedence relative to the foreign conditional
/// is undefined.
pub(super) fn choice_fix(
    found: &Found<'_, '_>,
    range: std::ops::Range<usize>,
    title: String,
) -> Fix {
    use Token::{Arrow, Bar, Coalesce, Fby, Implies, When, With};
    let own = |i| {
        matches!(
            found.token(i),
            Some(Arrow | Bar | Coalesce | Fby | Implies | When | With)
        )
    };
    match range.into_iter().any(own) {
        true => Fix::maybe(title),
        false => Fix::sure(title),
    }
}

/// Recognises the conditional operator of C: `c ? x : y`.
pub(super) fn conditional(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    if found.token(at) != Some(Token::Question) || !found.expects(Token::Plus) {
        return None;
    }
    let (start, end) = operand(found, at);
    let level = found.structure.parent(at);
    let here = |i: &usize| found.structure.parent(*i) == level;
    // Within a branch of an outer conditional, the condition begins after `then` or `else`.
    let begins = |i: &usize| matches!(found.token(*i), Some(Token::Then | Token::Else));
    let branch = (start..at).rev().filter(here).find(begins);
    let start = branch.map_or(start, |branch| branch + 1);
    let mut inner = 0;
    let colon = (at + 1..end).filter(here).find(|i| match found.token(*i) {
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
    let fix = choice_fix(
        found,
        start..end,
        "write `if ... then ... else ...`".to_owned(),
    )
    .insert_before(found.span_at(start), "if ")
    .replace(found.span_at(at), word(found, at, "then"))
    .replace(found.span_at(colon), word(found, colon, "else"));
    let finding = habit("a conditional expression is written `if c then x else y`")
        .at(found.span_at(at), "`? :` is from another language")
        .fix(fix);
    let mend = Mend::Tokens(vec![
        found.before_token(start, Token::If),
        found.instead(at, &[Token::Then]),
        found.instead(colon, &[Token::Else]),
    ]);
    Some(Habit { finding, mend })
}

/// Returns `word` with the spaces that it needs when it replaces token `at`.
fn word(found: &Found<'_, '_>, at: usize, word: &str) -> String {
    super::signs::apart(found.span_at(at), found.cx.text, word)
}

/// Returns the range of the list element, or right side of an equation, that contains token `at`.
pub(super) fn operand(found: &Found<'_, '_>, at: usize) -> (usize, usize) {
    let level = found.structure.parent(at);
    let phrase = found.structure.phrase(at);
    let same = |i: &usize| found.structure.parent(*i) == level;
    let token = |i: usize| found.token(i);
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
pub(super) fn bare_unit(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    let is_number = matches!(found.token_before(), Some(Token::Int | Token::Real));
    if !is_number || found.token(at) != Some(Token::Ident) || !found.expects(Token::Plus) {
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
    let end = word + crate::units::rest(&found.cx.text[word..]);
    let after = found.lexemes[at..]
        .iter()
        .take_while(|lexeme| (lexeme.end as usize) <= end);
    let last = at + after.count();
    let unit = &found.cx.text[start..end];
    let place = found.cx.span(number.end, end as u32);
    let finding = Finding::new(
        Code::RPI0007,
        format!("a unit is written in brackets: `[{unit}]`"),
    )
    .at(found.span_at(at), "a unit needs brackets")
    .fix(Fix::maybe(format!("write `[{unit}]`")).replace(place, format!("[{unit}]")));
    let mend = Mend::Tokens(vec![
        found.before_token(at, Token::LBracket),
        found.before_token(last, Token::RBracket),
    ]);
    Some(Habit { finding, mend })
}

/// Recognises a product without `*`: `3(x + 1)`, `(a + b)(c + d)`, `2 x`.
pub(super) fn product(found: &Found<'_, '_>) -> Option<Habit> {
    use Token::{Ident, Int, LParen, RParen, Real};
    let at = found.fault.at;
    let before = found.token_before()?;
    let is_number = matches!(before, Int | Real);
    let is_factor = match found.token(at)? {
        LParen => is_number || before == RParen && !is_header(found, at - 1),
        Ident => is_number && found.cx.seeming.declares(found.written(at)),
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
    let finding = habit("a product is written with `*`")
        .at(found.span_at(at), "expected `*` before this")
        .fix(Fix::maybe("insert `*`").replace(gap, " * "));
    let mend = Mend::Tokens(vec![found.before_token(at, Token::Star)]);
    Some(Habit { finding, mend })
}

/// Recognises a unit in parentheses: `250(mm)`.
fn unit_in_parentheses(found: &Found<'_, '_>, at: usize, is_number: bool) -> Option<Habit> {
    let close = found.structure.partner(at).filter(|_| is_number)?;
    let is_part = |at: usize| {
        let is_sign = matches!(
            found.token(at),
            Some(Token::Slash | Token::Star | Token::Hat | Token::Int)
        );
        let name = found.written(at);
        let is_name = found.token(at) == Some(Token::Ident) && name.len() <= 4;
        is_sign || is_name && !found.cx.seeming.declares(name)
    };
    if found.token(at + 1) != Some(Token::Ident) || !(at + 1..close).all(is_part) {
        return None;
    }
    let unit = found.text(at + 1..close);
    let place = found.span_of(at..close + 1);
    let message = format!("a unit is written in brackets: `[{unit}]`");
    let finding = Finding::new(Code::RPI0007, message)
        .at(place, "parentheses after a value do not form a unit")
        .fix(Fix::maybe(format!("write `[{unit}]`")).replace(place, format!("[{unit}]")));
    let mend = found.brackets(at, close, [Token::LBracket, Token::RBracket]);
    Some(Habit { finding, mend })
}

/// Returns whether the parenthesis at token `close` ends the argument list of a call.
fn is_header(found: &Found<'_, '_>, close: usize) -> bool {
    let open = found.structure.partner(close);
    let before = open
        .and_then(|open| open.checked_sub(1))
        .and_then(|at| found.token(at));
    matches!(before, Some(Token::Ident | Token::Path | Token::RStatic))
}

/// Recognises a struct value with `:` after its fields: `P { x: 1.0 }`.
pub(super) fn field_by_colon(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    let inside = found
        .structure
        .parent(at)
        .and_then(|open| found.token(open));
    let is_field = found.token_before() == Some(Token::Ident) && found.expects(Token::Eq);
    if found.token(at) != Some(Token::Colon) || inside != Some(Token::LBrace) || !is_field {
        return None;
    }
    let finding = habit("the fields of a struct value are set with `=`")
        .at(found.span_at(at), "`:` follows argument names in calls")
        .fix(Fix::sure("write `=`").replace(found.span_at(at), " ="));
    let mend = Mend::Tokens(vec![found.instead(at, &[Token::Eq])]);
    Some(Habit { finding, mend })
}

/// Recognises a struct value without its type: `limits: Limits = { speed = 1.0 }`.
pub(super) fn struct_without_type(found: &Found<'_, '_>) -> Option<Habit> {
    use Token::{Colon, Eq, Ident, LBrace, RBrace};
    let at = found.fault.at;
    let begins = found.token_before() == Some(LBrace) && found.token(at) == Some(Ident);
    let is_field = matches!(found.token(at + 1), Some(Eq | Colon));
    if !begins || !is_field || !found.expects(RBrace) {
        return None;
    }
    let brace = found.span_at(at - 1);
    let before = |back: usize| at.checked_sub(back).and_then(|at| found.token(at));
    let finding = habit("a struct value begins with its type");
    let finding = match [before(4), before(3), before(2)] {
        [Some(Colon), Some(Ident), Some(Eq)] => {
            let ty = found.written(at - 3);
            let place = Span {
                end: brace.start,
                ..brace
            };
            let fix = Fix::sure(format!("write `{ty} {{`")).replace(place, format!("{ty} "));
            finding
                .at(brace, format!("expected `{ty}` before this"))
                .fix(fix)
        }
        _ => finding
            .at(brace, "expected the name of a struct type before this")
            .help("for example `Point {x = 1.0; y = 2.0}`"),
    };
    Some(Habit {
        finding,
        mend: Mend::Usual,
    })
}

/// Recognises a closing bracket without its opening one: `(x + 1))`.
pub(super) fn stray_bracket(found: &Found<'_, '_>) -> Option<Habit> {
    use Token::{RBrace, RBracket, RParen, RStatic};
    let at = found.fault.at;
    let closes = matches!(found.token(at), Some(RParen | RBracket | RBrace | RStatic));
    if !closes
        || found.structure.partner(at).is_some()
        || found.structure.open_bracket(at).is_some()
    {
        return None;
    }
    let written = found.written(at);
    let finding = Finding::new(Code::RPI0001, format!("unmatched `{written}`"))
        .at(found.span_at(at), "no bracket is open here")
        .fix(Fix::maybe(format!("delete `{written}`")).replace(found.span_at(at), ""));
    let mend = Mend::Tokens(vec![(at..at + 1, Vec::new())]);
    Some(Habit { finding, mend })
}
