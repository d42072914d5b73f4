//! Errors in the right side of an equation: tuples without parentheses, foreign conditional expressions, operators as
//! arguments.

use super::conditional_extent::with_parentheses;
use super::operators::innermost_if;
use super::{ForeignSyntax, Repair, foreign_syntax};
use crate::syntax_errors::ErrorContext;
use crate::token::Token;
use rpi_diag::Fix;

/// Recognises a doubled `;` after an equation: `y = x;;`.
pub(super) fn doubled_semi(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    let is_second = found.token_before() == Some(Token::Semi);
    if found.token_at(at) != Some(Token::Semi) || !is_second || !found.expects_equation() {
        return None;
    }
    let diagnostic = foreign_syntax("an equation ends with one `;`")
        .primary(found.token_span(at), "unexpected second `;`")
        .fix(Fix::sure("delete it").replace(found.token_span(at), ""));
    let repair = Repair::ReplaceTokens(vec![(at..at + 1, Vec::new())]);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Recognises several values without parentheses: `y, z = a, b;`.
pub(super) fn tuple_without_parens(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    if found.token_at(at) != Some(Token::Comma) || !found.expects(Token::Semi) {
        return None;
    }
    let level = found.structure.parent(at);
    let phrase = found.structure.phrase(at);
    let is =
        |i: &usize, token| found.token_at(*i) == Some(token) && found.structure.parent(*i) == level;
    let eq = (phrase.start..at).find(|i| is(i, Token::Eq))?;
    let several = found.token_at(phrase.start) == Some(Token::LParen)
        || (phrase.start..eq).any(|i| is(&i, Token::Comma));
    if !several || phrase.end <= at + 1 {
        return None;
    }
    // It is not clear whether such an operator applies to one value or to all.
    let reaches = |i: usize| {
        matches!(
            found.token_at(i),
            Some(Token::If | Token::With | Token::When)
        )
    };
    let title = "add parentheses";
    let fix = match (eq + 1..phrase.end).any(reaches) {
        true => Fix::maybe(title),
        false => Fix::sure(title),
    };
    let diagnostic = foreign_syntax("several values are written in parentheses")
        .primary(
            found.token_span(at),
            "begins another value of this equation",
        )
        .fix(
            fix.insert_before(found.token_span(eq + 1), "(")
                .insert_after(found.token_span(phrase.end - 1), ")"),
        );
    let repair = Repair::ReplaceTokens(vec![
        found.insertion(eq + 1, Token::LParen),
        found.insertion(phrase.end, Token::RParen),
    ]);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Recognises an increment: `y = n++;`.
pub(super) fn increment(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    let is_plus =
        found.token_at(at) == Some(Token::Plus) && found.token_before() == Some(Token::Plus);
    let name = at
        .checked_sub(2)
        .filter(|name| found.token_at(*name) == Some(Token::Ident))?;
    let ends = matches!(
        found.token_at(at + 1),
        Some(Token::Semi | Token::Comma | Token::RParen | Token::RBracket)
    );
    if !is_plus || !ends {
        return None;
    }
    let signs = found.range_span(at - 1..at + 1);
    let diagnostic = foreign_syntax("an expression cannot change a flow")
        .primary(signs, "increments it like a variable")
        .help(format!(
            "write `{} + 1`; a counter needs an equation of its own: `n = 0 -> pre n + 1`",
            found.source_text(name)
        ))
        .fix(Fix::maybe("write `+ 1`").replace(signs, " + 1"));
    let repair = Repair::ReplaceTokens(vec![(at - 1..at + 1, Vec::new())]);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Keywords of conditional expressions in Structured Text: spellings in lower case, text that RPI uses instead, and its
/// tokens.
const UPPER_CASE_KEYWORDS: [(&[&str], &str, &[Token]); 5] = [
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
pub(super) fn upper_case_conditional(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let first = found.error.index.checked_sub(1)?;
    let phrase = found.structure.phrase(first);
    let is = |at: usize, word: &str| {
        found.token_at(at) == Some(Token::Ident) && found.source_text(at).eq_ignore_ascii_case(word)
    };
    let has_then = (first + 1..phrase.end).any(|at| is(at, "then"));
    if !is(first, "if") || first == phrase.start || !has_then {
        return None;
    }
    let mut fix = Fix::sure("write it in lower case");
    let mut edits = Vec::new();
    for at in first..phrase.end {
        let known = UPPER_CASE_KEYWORDS
            .iter()
            .find(|(words, ..)| words.iter().any(|word| is(at, word)));
        let Some((_, meant, tokens)) = known else {
            continue;
        };
        fix = match tokens.is_empty() {
            true => {
                let before = found.token_span(at - 1).end;
                let place = found.token_span(at);
                fix.replace(found.cx.span(before, place.end), "")
            }
            false => fix.replace(found.token_span(at), *meant),
        };
        edits.push(found.replacement(at, tokens));
    }
    let diagnostic = foreign_syntax("a conditional expression is written `if c then x else y`")
        .primary(
            found.token_span(first),
            "keywords are written in lower case",
        )
        .fix(fix);
    Some(ForeignSyntax {
        diagnostic,
        repair: Repair::ReplaceTokens(edits),
    })
}

/// Recognises a conditional with braces: `y = if (c) {a} else {b};`.
pub(super) fn conditional_with_braces(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    use Token::{Else, If, LBrace, Then};
    let at = found.error.index;
    if found.token_at(at) != Some(LBrace) || !found.expects(Then) {
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
            .replace(found.token_span(open), spaced_word(found, open, "then"))
            .replace(found.token_span(close), spaced_word(found, close, ""));
        edits.push(found.replacement(open, &[Then]));
        edits.push((close..close + 1, Vec::new()));
        match (found.token_at(close + 1), found.token_at(close + 2)) {
            (Some(Else), Some(LBrace)) => {
                let close_too = closing(found, close + 2)?;
                fix = fix
                    .replace(
                        found.token_span(close + 2),
                        spaced_word(found, close + 2, ""),
                    )
                    .replace(
                        found.token_span(close_too),
                        spaced_word(found, close_too, ""),
                    );
                edits.push((close + 2..close + 3, Vec::new()));
                edits.push((close_too..close_too + 1, Vec::new()));
                break close_too;
            }
            (Some(Else), Some(If)) => {
                let opens = |i: &usize| {
                    found.token_at(*i) == Some(LBrace) && found.structure.parent(*i) == level
                };
                open = (close + 3..end).find(opens)?;
            }
            _ => return None,
        }
    };
    // Without its braces, the last value would extend over the following operators.
    let diagnostic = foreign_syntax("a conditional expression is written `if c then x else y`")
        .primary(found.token_span(at), "a value cannot be in braces");
    if !ends_value(found, last + 1) {
        let own = innermost_if(found)?;
        let place = found.range_span(own..last + 1);
        return Some(ForeignSyntax {
            diagnostic: with_parentheses(diagnostic, fix, place),
            repair: Repair::RemoveErrorPhrase,
        });
    }
    Some(ForeignSyntax {
        diagnostic: diagnostic.fix(fix),
        repair: Repair::ReplaceTokens(edits),
    })
}

/// Returns whether token `at` cannot continue an expression: `,`, `;`, a closing bracket or the end of the text.
fn ends_value(found: &ErrorContext<'_, '_>, at: usize) -> bool {
    use Token::{Comma, RBrace, RBracket, RParen, Semi};
    matches!(
        found.token_at(at),
        None | Some(Comma | RBrace | RBracket | RParen | Semi)
    )
}

/// Returns `word` with the spaces that it needs in the source text in place of token `at`. An empty word becomes a
/// space where the words around it would join.
fn spaced_word(found: &ErrorContext<'_, '_>, at: usize, word: &str) -> String {
    let place = found.token_span(at);
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

/// Returns the token index of the `}` that matches the brace at token `open`; `None` if the braces are empty or contain
/// a statement.
fn closing(found: &ErrorContext<'_, '_>, open: usize) -> Option<usize> {
    let close = found.structure.partner(open)?;
    let is_value = close > open + 1 && found.token_at(close - 1) != Some(Token::Semi);
    (is_value && found.token_at(close) == Some(Token::RBrace)).then_some(close)
}

/// Recognises the delay of SCADE, `fby` as a function: `fby(x, 1, 0)`.
pub(super) fn fby_function(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    if found.token_at(at) != Some(Token::Fby)
        || found.token_at(at + 1) != Some(Token::LParen)
        || found.expects(Token::Plus)
    {
        return None;
    }
    let diagnostic = foreign_syntax("`fby` is written between an initial value and a flow")
        .primary(found.token_span(at), "`fby` is not a function")
        .help("`0 fby x` is 0 in the first cycle, then `x` of the previous cycle; a delay of two cycles is `0 fby 0 fby x`");
    let meant = unit_delay(found, at + 1);
    let diagnostic = match (found.structure.partner(at + 1), meant) {
        (Some(close), Some(meant)) => {
            let whole = found.token_before() == Some(Token::Eq)
                && found.token_at(close + 1) == Some(Token::Semi);
            let text = if whole {
                meant.clone()
            } else {
                format!("({meant})")
            };
            let place = found.range_span(at..close + 1);
            diagnostic.fix(Fix::maybe(format!("write `{meant}`")).replace(place, text))
        }
        _ => diagnostic,
    };
    Some(ForeignSyntax {
        diagnostic,
        repair: Repair::RemoveErrorPhrase,
    })
}

/// Returns `0 fby x` for the arguments `(x, 1, 0)` after the parenthesis at token `open`. `None` unless the delay is
/// one cycle and each argument is one token.
fn unit_delay(found: &ErrorContext<'_, '_>, open: usize) -> Option<String> {
    let close = found.structure.partner(open)?;
    let is_comma = |i: &usize| {
        found.token_at(*i) == Some(Token::Comma) && found.structure.parent(*i) == Some(open)
    };
    let commas: Vec<usize> = (open + 1..close).filter(is_comma).collect();
    let [first, second] = commas[..] else {
        return None;
    };
    let simple = first == open + 2 && second == first + 2 && close == second + 2;
    (simple && found.source_text(first + 1) == "1").then(|| {
        format!(
            "{} fby {}",
            found.source_text(second + 1),
            found.source_text(open + 1)
        )
    })
}

/// Recognises an operator as an argument: `reduce(+, a)`.
pub(super) fn operator_argument(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    use Token::{And, Minus, Or, Plus, Slash, Star, Xor};
    let at = found.error.index;
    let is_operator = matches!(
        found.token_at(at),
        Some(Plus | Minus | Star | Slash | And | Or | Xor)
    );
    let callee = at.checked_sub(2)?;
    if !is_operator
        || found.token_before() != Some(Token::LParen)
        || found.token_at(callee) != Some(Token::Ident)
        || found.token_at(at + 1) != Some(Token::Comma)
    {
        return None;
    }
    let op = found.source_text(at);
    let meant = match found.source_text(callee) {
        "map" => format!("map<<{op}, 3>>(a, b)"),
        _ => {
            let first = match found.token_at(at) {
                Some(And) => "true",
                Some(Or | Xor) => "false",
                Some(Star | Slash) => "1",
                _ => "0",
            };
            format!("red<<{op}, 3>>({first}, a)")
        }
    };
    let diagnostic = foreign_syntax("an operator is passed in `<< >>`, with the size of the array")
        .primary(found.token_span(at), "an operator is not a value")
        .help(format!("for an array of 3 it is `{meant}`"));
    Some(ForeignSyntax {
        diagnostic,
        repair: Repair::RemoveErrorPhrase,
    })
}
