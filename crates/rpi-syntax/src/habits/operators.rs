//! Habits inside expressions.

use super::{Habit, Mend, habit};
use crate::explain::Found;
use crate::token::Token;
use rpi_diag::{Code, Finding, Fix, Span};

/// `x % 2`
pub(super) fn remainder(found: &Found<'_, '_>) -> Option<Habit> {
    let at = match (found.token_before(), found.token(found.fault.at)) {
        (_, Some(Token::Percent)) => found.fault.at,
        (Some(Token::Percent), _) => found.fault.at - 1,
        _ => return None,
    };
    let title = "write `mod`";
    // Behind a number it is a per cent sign, and something lacks behind it.
    let fix = match at == found.fault.at {
        true => Fix::sure(title),
        false => Fix::maybe(title),
    };
    let finding = habit("the remainder is written `mod`")
        .at(
            found.span_at(at),
            "a per cent sign stands behind a number: `60%` is 0.6",
        )
        .fix(fix.replace(found.span_at(at), word(found, at, "mod")));
    let mend = Mend::Tokens(vec![found.instead(at, &[Token::Mod])]);
    Some(Habit { finding, mend })
}

/// `if a then x elif b then y else z`
pub(super) fn else_if(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    let word = found.written(at);
    let is_word = matches!(word, "elif" | "elsif" | "elseif");
    if !is_word || !found.expects(Token::Else) {
        return None;
    }
    let finding = habit("a further condition follows `else if`")
        .at(
            found.span_at(at),
            format!("`{word}` is of another language"),
        )
        .fix(Fix::sure("write `else if`").replace(found.span_at(at), "else if"));
    let mend = Mend::Tokens(vec![found.instead(at, &[Token::Else, Token::If])]);
    Some(Habit { finding, mend })
}

/// `y = if c then x;`
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
        .at(found.span_at(own), "a flow has a value in every cycle")
        .also(super::bodies::behind(end), "expected `else` here")
        .help("say what holds otherwise: `if c then x else y`; to keep the value of the cycle before: `else pre y`");
    Some(Habit {
        finding,
        mend: Mend::Usual,
    })
}

/// The `if` before the fault that has no `else` yet.
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

/// `y = if c then x else z end;`
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
        .at(found.span_at(at), "no word closes it")
        .fix(
            named_unlike(found, at, format!("delete `{}`", found.written(at)))
                .replace(found.span_at(at), ""),
        );
    let mend = Mend::Tokens(vec![(at..at + 1, Vec::new())]);
    Some(Habit { finding, mend })
}

/// A fix that is sure if nothing is declared by the name of a token: an operator could be what lacks before it.
fn named_unlike(found: &Found<'_, '_>, at: usize, title: String) -> Fix {
    match found.cx.seeming.declares(found.written(at)) {
        true => Fix::maybe(title),
        false => Fix::sure(title),
    }
}

/// A fix of a choice as it is written elsewhere: sure unless an operator stands beside it that only this language has, as which of them
/// reaches farther is not said.
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

/// `c ? x : y`
pub(super) fn conditional(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    if found.token(at) != Some(Token::Question) || !found.expects(Token::Plus) {
        return None;
    }
    let (start, end) = operand(found, at);
    let level = found.structure.parent(at);
    let here = |i: &usize| found.structure.parent(*i) == level;
    // In a branch of a choice around it the condition is what stands there.
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
    let finding = habit("a choice is written `if c then x else y`")
        .at(found.span_at(at), "`? :` is of another language")
        .fix(fix);
    let mend = Mend::Tokens(vec![
        found.before_token(start, Token::If),
        found.instead(at, &[Token::Then]),
        found.instead(colon, &[Token::Else]),
    ]);
    Some(Habit { finding, mend })
}

/// What a word is replaced by that stands in place of a sign: with the spaces that it needs.
fn word(found: &Found<'_, '_>, at: usize, word: &str) -> String {
    super::signs::apart(found.span_at(at), found.cx.text, word)
}

/// The element of a list, or the right side of an equation, in which a token stands.
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

/// `3 mm`
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
    .at(found.span_at(at), "does not belong to the number like this")
    .fix(Fix::maybe(format!("write `[{unit}]`")).replace(place, format!("[{unit}]")));
    let mend = Mend::Tokens(vec![
        found.before_token(at, Token::LBracket),
        found.before_token(last, Token::RBracket),
    ]);
    Some(Habit { finding, mend })
}

/// `3(x + 1)`, `(a + b)(c + d)`, `2 x`
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
        .at(
            found.span_at(at),
            "does not belong to what stands before it",
        )
        .fix(Fix::maybe("insert `*`").replace(gap, " * "));
    let mend = Mend::Tokens(vec![found.before_token(at, Token::Star)]);
    Some(Habit { finding, mend })
}

/// `250(mm)`
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
        .at(place, "parentheses call a node")
        .fix(Fix::maybe(format!("write `[{unit}]`")).replace(place, format!("[{unit}]")));
    let mend = found.brackets(at, close, [Token::LBracket, Token::RBracket]);
    Some(Habit { finding, mend })
}

/// Whether the list of arguments of a call ends at a token.
fn is_header(found: &Found<'_, '_>, close: usize) -> bool {
    let open = found.structure.partner(close);
    let before = open
        .and_then(|open| open.checked_sub(1))
        .and_then(|at| found.token(at));
    matches!(before, Some(Token::Ident | Token::Path | Token::RStatic))
}

/// `P { x: 1.0 }`
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
    let finding = habit("the fields of a value are given by `=`")
        .at(found.span_at(at), "`:` names arguments of calls")
        .fix(Fix::sure("write `=`").replace(found.span_at(at), " ="));
    let mend = Mend::Tokens(vec![found.instead(at, &[Token::Eq])]);
    Some(Habit { finding, mend })
}

/// `limits: Limits = { speed = 1.0 }`
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
    let finding = habit("a value of a struct begins with its type");
    let finding = match [before(4), before(3), before(2)] {
        [Some(Colon), Some(Ident), Some(Eq)] => {
            let ty = found.written(at - 3);
            let place = Span {
                end: brace.start,
                ..brace
            };
            let fix = Fix::sure(format!("write `{ty} {{`")).replace(place, format!("{ty} "));
            finding.at(brace, format!("of `{ty}`, it seems")).fix(fix)
        }
        _ => finding
            .at(brace, "of which type is this?")
            .help("for instance `Point {x = 1.0; y = 2.0}`"),
    };
    Some(Habit {
        finding,
        mend: Mend::Usual,
    })
}

/// `(x + 1))`
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
    let finding = Finding::new(Code::RPI0001, format!("this `{written}` closes nothing"))
        .at(found.span_at(at), "no bracket is open here")
        .fix(Fix::maybe(format!("delete `{written}`")).replace(found.span_at(at), ""));
    let mend = Mend::Tokens(vec![(at..at + 1, Vec::new())]);
    Some(Habit { finding, mend })
}
