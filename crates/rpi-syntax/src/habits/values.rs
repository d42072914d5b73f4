//! Errors in the right side of an equation: tuples without parentheses, foreign conditional expressions, operators as
//! arguments.

use super::{Habit, Mend, habit};
use crate::explain::Found;
use crate::token::Token;
use rpi_diag::{Applicability, Fix};

/// Recognises a doubled `;` after an equation: `y = x;;`.
pub(super) fn empty(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    let is_second = found.token_before() == Some(Token::Semi);
    if found.token(at) != Some(Token::Semi) || !is_second || !found.expects_equation() {
        return None;
    }
    let finding = habit("an equation ends with one `;`")
        .at(found.span_at(at), "unexpected second `;`")
        .fix(Fix::sure("delete it").replace(found.span_at(at), ""));
    let mend = Mend::Tokens(vec![(at..at + 1, Vec::new())]);
    Some(Habit { finding, mend })
}

/// Recognises several values without parentheses: `y, z = a, b;`.
pub(super) fn no_tuple(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    if found.token(at) != Some(Token::Comma) || !found.expects(Token::Semi) {
        return None;
    }
    let level = found.structure.parent(at);
    let phrase = found.structure.phrase(at);
    let is =
        |i: &usize, token| found.token(*i) == Some(token) && found.structure.parent(*i) == level;
    let eq = (phrase.start..at).find(|i| is(i, Token::Eq))?;
    let several = found.token(phrase.start) == Some(Token::LParen)
        || (phrase.start..eq).any(|i| is(&i, Token::Comma));
    if !several || phrase.end <= at + 1 {
        return None;
    }
    // It is not clear whether such an operator applies to one value or to all.
    let reaches = |i: usize| matches!(found.token(i), Some(Token::If | Token::With | Token::When));
    let title = "add parentheses";
    let fix = match (eq + 1..phrase.end).any(reaches) {
        true => Fix::maybe(title),
        false => Fix::sure(title),
    };
    let finding = habit("several values are written in parentheses")
        .at(found.span_at(at), "`(a, b)`")
        .fix(
            fix.insert_before(found.span_at(eq + 1), "(")
                .insert_after(found.span_at(phrase.end - 1), ")"),
        );
    let mend = Mend::Tokens(vec![
        found.before_token(eq + 1, Token::LParen),
        found.before_token(phrase.end, Token::RParen),
    ]);
    Some(Habit { finding, mend })
}

/// Recognises an increment: `y = n++;`.
pub(super) fn stepped(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    let is_plus = found.token(at) == Some(Token::Plus) && found.token_before() == Some(Token::Plus);
    let name = at
        .checked_sub(2)
        .filter(|name| found.token(*name) == Some(Token::Ident))?;
    let ends = matches!(
        found.token(at + 1),
        Some(Token::Semi | Token::Comma | Token::RParen | Token::RBracket)
    );
    if !is_plus || !ends {
        return None;
    }
    let signs = found.span_of(at - 1..at + 1);
    let finding = habit("an expression cannot change a flow")
        .at(signs, "increments it like a variable")
        .help(format!(
            "write `{} + 1`; a counter needs an equation of its own: `n = 0 -> pre n + 1`",
            found.written(name)
        ))
        .fix(Fix::maybe("write `+ 1`").replace(signs, " + 1"));
    let mend = Mend::Tokens(vec![(at - 1..at + 1, Vec::new())]);
    Some(Habit { finding, mend })
}

/// Keywords of conditional expressions in Structured Text: foreign spellings, RPI text, RPI tokens.
const CAPITALS: [(&[&str], &str, &[Token]); 5] = [
    (&["if"], "if", &[Token::If]),
    (&["then"], "then", &[Token::Then]),
    (&["else"], "else", &[Token::Else]),
    (
        &["elsif", "elseif", "elif"],
        "else if",
        &[Token::Else, Token::If],
    ),
    (&["end_if"], "", &[]),
];

/// Recognises a conditional in upper case: `y = IF c THEN a ELSE b;`, `y = IF c THEN a ELSIF d THEN b ELSE x END_IF;`.
pub(super) fn capitals(found: &Found<'_, '_>) -> Option<Habit> {
    let first = found.fault.at.checked_sub(1)?;
    let phrase = found.structure.phrase(first);
    let is = |at: usize, word: &str| {
        found.token(at) == Some(Token::Ident) && found.written(at).eq_ignore_ascii_case(word)
    };
    let has_then = (first + 1..phrase.end).any(|at| is(at, "then"));
    if !is(first, "if") || first == phrase.start || !has_then {
        return None;
    }
    let mut fix = Fix::sure("write it in lower case");
    let mut edits = Vec::new();
    for at in first..phrase.end {
        let known = CAPITALS
            .iter()
            .find(|(words, ..)| words.iter().any(|word| is(at, word)));
        let Some((_, meant, tokens)) = known else {
            continue;
        };
        fix = match tokens.is_empty() {
            true => {
                let before = found.span_at(at - 1).end;
                let place = found.span_at(at);
                fix.replace(found.cx.span(before, place.end), "")
            }
            false => fix.replace(found.span_at(at), *meant),
        };
        edits.push(found.instead(at, tokens));
    }
    let finding = habit("a conditional expression is written `if c then x else y`")
        .at(found.span_at(first), "keywords are written in lower case")
        .fix(fix);
    Some(Habit {
        finding,
        mend: Mend::Tokens(edits),
    })
}

/// Recognises a conditional with braces: `y = if (c) {a} else {b};`.
pub(super) fn braces(found: &Found<'_, '_>) -> Option<Habit> {
    use Token::{Else, If, LBrace, Then};
    let at = found.fault.at;
    if found.token(at) != Some(LBrace) || !found.expects(Then) {
        return None;
    }
    let level = found.structure.parent(at);
    let end = found.structure.phrase(at).end;
    let mut fix = Fix::sure("write `if ... then ... else ...`");
    let mut edits = Vec::new();
    let mut open = at;
    let last = loop {
        let close = closing(found, open)?;
        fix = fix
            .replace(found.span_at(open), word_for(found, open, "then"))
            .replace(found.span_at(close), word_for(found, close, ""));
        edits.push(found.instead(open, &[Then]));
        edits.push((close..close + 1, Vec::new()));
        match (found.token(close + 1), found.token(close + 2)) {
            (Some(Else), Some(LBrace)) => {
                let close_too = closing(found, close + 2)?;
                fix = fix
                    .replace(found.span_at(close + 2), word_for(found, close + 2, ""))
                    .replace(found.span_at(close_too), word_for(found, close_too, ""));
                edits.push((close + 2..close + 3, Vec::new()));
                edits.push((close_too..close_too + 1, Vec::new()));
                break close_too;
            }
            (Some(Else), Some(If)) => {
                let opens = |i: &usize| {
                    found.token(*i) == Some(LBrace) && found.structure.parent(*i) == level
                };
                open = (close + 3..end).find(opens)?;
            }
            _ => return None,
        }
    };
    // Without its braces, the last value would extend over the following operators.
    if !ends_value(found, last + 1) {
        fix.applicability = Applicability::Maybe;
    }
    let finding = habit("a conditional expression is written `if c then x else y`")
        .at(found.span_at(at), "a value cannot be in braces")
        .fix(fix);
    Some(Habit {
        finding,
        mend: Mend::Tokens(edits),
    })
}

/// Returns whether token `at` ends the expression before it.
fn ends_value(found: &Found<'_, '_>, at: usize) -> bool {
    use Token::{Comma, RBrace, RBracket, RParen, Semi};
    matches!(
        found.token(at),
        None | Some(Comma | RBrace | RBracket | RParen | Semi)
    )
}

/// Returns `word` with the spaces that it needs when it replaces token `at`; a space may remain for an empty word.
fn word_for(found: &Found<'_, '_>, at: usize, word: &str) -> String {
    let place = found.span_at(at);
    let before = found.cx.text[..place.start as usize].chars().next_back();
    let after = found.cx.text[place.end as usize..].chars().next();
    let is_word =
        |sign: Option<char>| sign.is_some_and(|sign| sign.is_alphanumeric() || sign == '_');
    if word.is_empty() {
        let joins = is_word(before) && is_word(after);
        return if joins { " " } else { "" }.to_owned();
    }
    let space = |sign: Option<char>| {
        if sign.is_some_and(char::is_whitespace) {
            ""
        } else {
            " "
        }
    };
    format!("{}{word}{}", space(before), space(after))
}

/// Returns the closing brace of a pair that encloses a value.
fn closing(found: &Found<'_, '_>, open: usize) -> Option<usize> {
    let close = found.structure.partner(open)?;
    let is_value = close > open + 1 && found.token(close - 1) != Some(Token::Semi);
    (is_value && found.token(close) == Some(Token::RBrace)).then_some(close)
}

/// Recognises `fby` in the syntax of SCADE: `fby(x, 1, 0)`.
pub(super) fn fby_called(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    if found.token(at) != Some(Token::Fby)
        || found.token(at + 1) != Some(Token::LParen)
        || found.expects(Token::Plus)
    {
        return None;
    }
    let finding = habit("`fby` is written between an initial value and a flow")
        .at(found.span_at(at), "`fby` is not a function")
        .help("`0 fby x` is 0 in the first cycle, then `x` of the previous cycle; a delay of two cycles is `0 fby 0 fby x`");
    let meant = one_late(found, at + 1);
    let finding = match (found.structure.partner(at + 1), meant) {
        (Some(close), Some(meant)) => {
            let whole = found.token_before() == Some(Token::Eq)
                && found.token(close + 1) == Some(Token::Semi);
            let text = if whole {
                meant.clone()
            } else {
                format!("({meant})")
            };
            let place = found.span_of(at..close + 1);
            finding.fix(Fix::maybe(format!("write `{meant}`")).replace(place, text))
        }
        _ => finding,
    };
    Some(Habit {
        finding,
        mend: Mend::Usual,
    })
}

/// Returns `0 fby x` for the arguments `(x, 1, 0)`, if the delay is one cycle.
fn one_late(found: &Found<'_, '_>, open: usize) -> Option<String> {
    let close = found.structure.partner(open)?;
    let is_comma = |i: &usize| {
        found.token(*i) == Some(Token::Comma) && found.structure.parent(*i) == Some(open)
    };
    let commas: Vec<usize> = (open + 1..close).filter(is_comma).collect();
    let [first, second] = commas[..] else {
        return None;
    };
    let simple = first == open + 2 && second == first + 2 && close == second + 2;
    (simple && found.written(first + 1) == "1").then(|| {
        format!(
            "{} fby {}",
            found.written(second + 1),
            found.written(open + 1)
        )
    })
}

/// Recognises an operator as an argument: `reduce(+, a)`.
pub(super) fn operator_given(found: &Found<'_, '_>) -> Option<Habit> {
    use Token::{And, Minus, Or, Plus, Slash, Star, Xor};
    let at = found.fault.at;
    let is_operator = matches!(
        found.token(at),
        Some(Plus | Minus | Star | Slash | And | Or | Xor)
    );
    let callee = at.checked_sub(2)?;
    if !is_operator
        || found.token_before() != Some(Token::LParen)
        || found.token(callee) != Some(Token::Ident)
        || found.token(at + 1) != Some(Token::Comma)
    {
        return None;
    }
    let op = found.written(at);
    let meant = match found.written(callee) {
        "map" => format!("map<<{op}, 3>>(a, b)"),
        _ => {
            let first = match found.token(at) {
                Some(And) => "true",
                Some(Or | Xor) => "false",
                Some(Star | Slash) => "1",
                _ => "0",
            };
            format!("red<<{op}, 3>>({first}, a)")
        }
    };
    let finding = habit("an operator is passed in `<< >>`, with the size of the array")
        .at(found.span_at(at), "an operator is not a value")
        .help(format!("for an array of 3 it is `{meant}`"));
    Some(Habit {
        finding,
        mend: Mend::Usual,
    })
}
