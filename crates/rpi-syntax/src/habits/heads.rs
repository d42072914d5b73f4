//! Errors in the headers of declarations: `returns`, body delimiters, separators, types of ports.

use super::bodies::behind;
use super::{Habit, Mend, habit};
use crate::explain::Found;
use crate::lexer::Lexeme;
use crate::token::Token;
use rpi_diag::{Code, Finding, Fix};

/// Recognises out-ports without `returns`: `node f (x: real) -> (y: real)`, `node f (x: real) (y: real)`.
pub(super) fn returns(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    let finding = || habit("the out-ports follow `returns`");
    if !found.expects(Token::Returns) {
        return None;
    }
    match found.token(at)? {
        Token::Arrow | Token::Implies => {
            let span = found.span_at(at);
            let fix = Fix::sure("write `returns`").replace(span, "returns");
            let finding = finding().at(span, "`->` initialises a flow").fix(fix);
            let mend = Mend::Tokens(vec![found.instead(at, &[Token::Returns])]);
            Some(Habit { finding, mend })
        }
        Token::LParen => {
            let span = found.span_at(at);
            let fix = Fix::sure("insert `returns`").insert_before(span, "returns ");
            let finding = finding()
                .at(span, "expected `returns` before this")
                .fix(fix);
            let mend = Mend::Tokens(vec![found.before_token(at, Token::Returns)]);
            Some(Habit { finding, mend })
        }
        _ => None,
    }
}

/// Recognises a body in braces: `node f (x: real) returns (y: real) { y = x; }`.
pub(super) fn braces(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    if found.token(at) != Some(Token::LBrace) || !found.expects(Token::Let) {
        return None;
    }
    let close = found.structure.partner(at)?;
    let fix = Fix::sure("write `let` and `tel`")
        .replace(found.span_at(at), "let")
        .replace(found.span_at(close), "tel");
    let finding = habit("a body is written between `let` and `tel`")
        .at(
            found.span_at(at),
            "braces enclose the fields of a struct or the values of an enum",
        )
        .also(found.span_at(close), "the body ends here")
        .fix(fix);
    let mend = found.brackets(at, close, [Token::Let, Token::Tel]);
    Some(Habit { finding, mend })
}

/// Recognises a body without `let`: `node f (x: real) returns (y: real) y = x; tel`.
pub(super) fn no_let(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    let begins_equation =
        found.token(at) == Some(Token::Ident) && found.token(at + 1) == Some(Token::Eq);
    let has_tel = found.lexemes[at..]
        .iter()
        .any(|lexeme| lexeme.token == Token::Tel);
    if !found.expects(Token::Let) || !begins_equation || at == 0 {
        return None;
    }
    let before = found.span_at(at - 1);
    if !has_tel {
        return Some(no_body(found, at));
    }
    let finding = Finding::new(Code::RPI0001, "this body has no `let`")
        .at(
            found.span_at(at),
            "equations are written between `let` and `tel`",
        )
        .fix(Fix::sure("insert `let`").insert_after(before, "\nlet"));
    let mend = Mend::Tokens(vec![found.before_token(at, Token::Let)]);
    Some(Habit { finding, mend })
}

/// Reports a body without `let` and `tel`: `node f (x: real) returns (y: real) y = x;`.
fn no_body(found: &Found<'_, '_>, at: usize) -> Habit {
    let (before, last) = (found.span_at(at - 1), found.lexemes.len());
    let finding = habit("a body is written between `let` and `tel`")
        .at(found.span_at(at), "expected `let` before this")
        .fix(
            Fix::sure("insert `let` and `tel`")
                .insert_after(before, "\nlet")
                .insert_after(found.span_at(last - 1), "\ntel"),
        );
    let mend = Mend::Tokens(vec![
        found.before_token(at, Token::Let),
        found.before_token(last, Token::Tel),
    ]);
    Habit { finding, mend }
}

/// Recognises a body without `let` after local declarations: `var z: real; y = x; tel`.
pub(super) fn no_let_after_locals(found: &Found<'_, '_>) -> Option<Habit> {
    use Token::{Colon, Eq, Ident, Semi, Tel, Var};
    let name = found.fault.at.checked_sub(1)?;
    let shape = [found.token(name), found.token(name + 1)];
    let ends_locals = name > 0 && found.token(name - 1) == Some(Semi);
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
    let finding = Finding::new(Code::RPI0001, "this body has no `let`")
        .at(
            found.span_at(name),
            "the first equation; equations are written between `let` and `tel`",
        )
        .fix(Fix::sure("insert `let`").insert_after(found.span_at(name - 1), "\nlet"));
    let mend = Mend::Tokens(vec![found.before_token(name, Token::Let)]);
    Some(Habit { finding, mend })
}

/// Recognises a body between keywords of other languages: `begin y = x; end`.
pub(super) fn begin_end(found: &Found<'_, '_>) -> Option<Habit> {
    let fault = found.fault.at;
    // After local declarations, the grammar takes the word for the next name and rejects the token after it.
    let at = match found.expects(Token::Colon) {
        true => fault.checked_sub(1)?,
        false => fault,
    };
    let is_word = match at < fault {
        true => found.written(at) == "begin",
        false => matches!(found.written(at), "begin" | "where" | "is" | "do" | "as"),
    };
    if !is_word || !(at < fault || found.expects(Token::Let)) {
        return None;
    }
    let end = end_of(found, at).filter(|end| found.token(*end) != Some(Token::Tel));
    let finding = habit("a body is written between `let` and `tel`").at(
        found.span_at(at),
        format!("`{}` is not a keyword", found.written(at)),
    );
    let fix = Fix::sure("write `let` and `tel`").replace(found.span_at(at), "let");
    let mut tokens = vec![found.instead(at, &[Token::Let])];
    let finding = match end {
        Some(end) => {
            tokens.push(found.instead(end, &[Token::Tel]));
            let fix = fix.replace(found.span_at(end), "tel");
            finding
                .also(found.span_at(end), "the body ends here")
                .fix(fix)
        }
        None => finding.fix(fix),
    };
    let mend = Mend::Tokens(tokens);
    Some(Habit { finding, mend })
}

/// Returns the `end` or `tel` that closes the body opened at token `begin`, skipping nested blocks.
fn end_of(found: &Found<'_, '_>, begin: usize) -> Option<usize> {
    let mut open = 0;
    (begin + 1..found.lexemes.len()).find(|at| {
        match (found.token(*at), found.written(*at)) {
            (Some(Token::Let | Token::Automaton), _) | (_, "begin") => open += 1,
            (Some(Token::Tel), _) | (_, "end") if open > 0 => open -= 1,
            (Some(Token::Tel), _) | (_, "end") => return true,
            _ => {}
        }
        false
    })
}

/// Recognises commas between declarations or fields: `(x: real, b: bool)`, `{x = 1.0, y = 2.0}`.
pub(super) fn comma(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    let names = found.token(at + 1) == Some(Token::Ident);
    let open = found.structure.parent(at).and_then(|at| found.token(at));
    let what = match open {
        Some(Token::LBrace) => "fields",
        _ => "declarations",
    };
    let defined = match found.token(at + 2) {
        Some(Token::Colon | Token::Comma) => true,
        Some(Token::Eq) => open == Some(Token::LBrace),
        _ => false,
    };
    if found.token(at) != Some(Token::Comma) || !found.expects(Token::Semi) || !names || !defined {
        return None;
    }
    let finding = habit(format!("{what} are separated by `;`"))
        .at(
            found.span_at(at),
            "`,` separates names of the same type: `x, y: real`",
        )
        .fix(Fix::sure("write `;`").replace(found.span_at(at), ";"));
    let mend = Mend::Tokens(vec![found.instead(at, &[Token::Semi])]);
    Some(Habit { finding, mend })
}

/// Recognises declarations without a separator: `(x: real y: int)`.
pub(super) fn no_semi(found: &Found<'_, '_>) -> Option<Habit> {
    use Token::{Colon, Comma, Ident, Plus, RParen, Semi};
    let at = found.fault.at;
    let declares =
        found.token(at) == Some(Ident) && matches!(found.token(at + 1), Some(Colon | Comma));
    let in_list = found.expects(Semi) && found.expects(RParen) && !found.expects(Plus);
    (declares && in_list).then(|| Habit {
        finding: found.missing_semi(),
        mend: Mend::Tokens(vec![found.before_token(at, Semi)]),
    })
}

/// Recognises ports without the closing parenthesis: `node f (x: real) returns (y: real let y = x; tel`.
pub(super) fn open_ports(found: &Found<'_, '_>) -> Option<Habit> {
    use Token::{Con, LParen, Let, RParen, Returns, Var};
    let at = found.fault.at;
    let goes_on = matches!(found.token(at), Some(Con | Let | Returns | Var));
    let is_open =
        |i: &usize| found.token(*i) == Some(LParen) && found.structure.partner(*i).is_none();
    let open = (0..at).rev().find(is_open)?;
    let in_body = (0..at).any(|i| found.token(i) == Some(Let));
    if !goes_on || in_body || !found.expects(RParen) {
        return None;
    }
    let last = found.span_at(at - 1);
    Some(Habit {
        finding: found
            .open_bracket(open)
            .fix(Fix::sure("insert `)`").insert_after(last, ")")),
        mend: Mend::Tokens(vec![found.before_token(at, RParen)]),
    })
}

/// Recognises a declaration without `:`: `(x real)`.
pub(super) fn no_colon(found: &Found<'_, '_>) -> Option<Habit> {
    use Token::{BoolType, Enum, Ident, IntType, RealType, Struct};
    let at = found.fault.at;
    let named = found.token_before() == Some(Ident) && found.expects(Token::Colon);
    let is_upper = |at: usize| found.written(at).starts_with(char::is_uppercase);
    let is_type = match found.token(at)? {
        BoolType | IntType | RealType | Enum | Struct => true,
        // Heuristic: names of types usually begin with a capital letter, names of flows do not.
        Ident => is_upper(at) && !is_upper(at - 1) && found.token(at + 1) != Some(Token::Colon),
        _ => false,
    };
    if !named || !is_type {
        return None;
    }
    let name = found.span_at(at - 1);
    let finding = found.unexpected();
    let finding = finding.fix(Fix::sure("insert `:`").insert_after(name, ":"));
    let mend = Mend::Tokens(vec![found.before_token(at, Token::Colon)]);
    Some(Habit { finding, mend })
}

/// Recognises a declaration with the type before the name: `(real x)`.
pub(super) fn type_first(found: &Found<'_, '_>) -> Option<Habit> {
    use Token::{BoolType, Comma, Ident, IntType, RParen, RealType, Semi};
    let at = found.fault.at;
    let known = |token| matches!(token, BoolType | IntType | RealType);
    let ty = match (found.token_before(), found.token(at)) {
        (_, Some(token)) if known(token) && found.expects(Ident) && !found.expects(token) => at,
        (Some(Ident), Some(Ident)) if is_declared_by_type(found, at) => at - 1,
        _ => return None,
    };
    let ends = matches!(found.token(ty + 2), Some(Semi | Comma | RParen));
    if found.token(ty + 1) != Some(Ident) || !ends {
        return None;
    }
    let (written, name) = (found.written(ty), found.written(ty + 1));
    let span = found.span_of(ty..ty + 2);
    let meant = format!("{name}: {written}");
    let finding = habit(format!("the name is written before its type: `{meant}`"))
        .at(span, "the type comes first here")
        .fix(Fix::sure(format!("write `{meant}`")).replace(span, meant));
    let token = found.lexemes[ty].token;
    let mend = match known(token) {
        true => Mend::Tokens(vec![(ty..ty + 2, swapped(found, ty))]),
        false => Mend::Phrase(ty..ty + 2, vec![found.ident(ty + 1)]),
    };
    Some(Habit { finding, mend })
}

/// Returns whether two names in a row are a type and the name declared with it.
///
/// Names of types usually begin with a capital letter, names of flows do not. Where the grammar accepts a value, the
/// cause is a missing comma or operator instead.
fn is_declared_by_type(found: &Found<'_, '_>, at: usize) -> bool {
    let is_upper = |at: usize| found.written(at).starts_with(char::is_uppercase);
    let is_declaration = found.expects(Token::Colon) && !found.expects(Token::Plus);
    is_declaration && is_upper(at - 1) && !is_upper(at)
}

/// Returns the tokens `x: real` for `real x`.
// The new tokens lie at the end of the old ones: the grammar needs locations in text order.
fn swapped(found: &Found<'_, '_>, ty: usize) -> Vec<Lexeme> {
    let name = found.lexemes[ty + 1];
    let end = behind(found.span_at(ty + 1)).start;
    let at = |token| Lexeme {
        token,
        start: end,
        end,
    };
    vec![name, at(Token::Colon), at(found.lexemes[ty].token)]
}

/// Recognises an array type with its size in brackets: `int[3]`.
pub(super) fn size_in_brackets(found: &Found<'_, '_>) -> Option<Habit> {
    use Token::{BoolType, Hat, Ident, Int, IntType, LBracket, RBracket};
    let at = found.fault.at;
    let shape = [found.token(at), found.token(at + 1), found.token(at + 2)];
    let is_size = match shape {
        [Some(LBracket), Some(Int), Some(RBracket)] => true,
        // After `real`, brackets contain a unit.
        [Some(LBracket), Some(Ident), Some(RBracket)] => {
            let is_type = matches!(found.token_before(), Some(BoolType | IntType));
            is_type && found.cx.seeming.declares(found.written(at + 1))
        }
        _ => false,
    };
    if !is_size || !found.expects(Hat) {
        return None;
    }
    let meant = format!("^{}", found.written(at + 1));
    let span = found.span_of(at..at + 3);
    let finding = habit("the size of an array follows `^`")
        .at(span, "brackets enclose an index, or the unit of a `real`")
        .fix(size_fix(found, at + 3, format!("write `{meant}`")).replace(span, meant));
    let size = found.lexemes[at + 1];
    let mend = Mend::Tokens(vec![
        found.instead(at, &[Hat]),
        (at + 1..at + 3, vec![size]),
    ]);
    Some(Habit { finding, mend })
}

/// Creates a fix for the size of an array: not a sure one for two sizes, `int[3][2]`, whose order changes too.
fn size_fix(found: &Found<'_, '_>, next: usize, title: String) -> Fix {
    match found.token(next) {
        Some(Token::LBracket) => Fix::maybe(title),
        _ => Fix::sure(title),
    }
}

/// Recognises array types of Pascal and IEC 61131-3: `array[3] of int`, `ARRAY [0..2] OF real[m]`.
pub(super) fn array_of(found: &Found<'_, '_>) -> Option<Habit> {
    use Token::{BoolType, Hat, Ident, IntType, LBracket, Path, RealType};
    let at = found.fault.at;
    let open = (at.saturating_sub(3)..=at).find(|at| found.token(*at) == Some(LBracket))?;
    let (word, close) = (open.checked_sub(1)?, found.structure.partner(open)?);
    let element = close + 2;
    let is = |at, word: &str| found.written(at).eq_ignore_ascii_case(word);
    let is_type = matches!(
        found.token(element)?,
        BoolType | IntType | RealType | Ident | Path
    );
    if !is(word, "array") || !is(close + 1, "of") || !is_type {
        return None;
    }
    let last = match (
        found.token(element + 1),
        found.structure.partner(element + 1),
    ) {
        (Some(LBracket), Some(end)) => end,
        _ => element,
    };
    let place = found.span_of(word..last + 1);
    let finding = habit("the size of an array follows the type of its elements")
        .at(place, "`array ... of` is from another language");
    let Some(size) = size_between(found, open + 1..close) else {
        return Some(Habit {
            finding: finding.help("an array of three integers is `int^3`; indices start at 0"),
            mend: Mend::Usual,
        });
    };
    let meant = format!("{}^{size}", found.text(element..last + 1));
    let fix = Fix::sure(format!("write `{meant}`")).replace(place, meant);
    let mut tokens = found.lexemes[element..=last].to_vec();
    tokens.extend(found.instead(word, &[Hat]).1);
    tokens.push(found.lexemes[close - 1]);
    // The size of `0..2` is not a token of the text, so no token can stand for it.
    let mend = match close - open {
        2 => Mend::Tokens(vec![(word..last + 1, tokens)]),
        _ => Mend::Usual,
    };
    Some(Habit {
        finding: finding.fix(fix),
        mend,
    })
}

/// Returns the size of an array written as `3`, `n` or `0..2` (which is 3).
fn size_between(found: &Found<'_, '_>, range: std::ops::Range<usize>) -> Option<String> {
    use Token::{DotDot, Ident, Int};
    let tokens: Vec<Token> = range.clone().filter_map(|at| found.token(at)).collect();
    match tokens[..] {
        [Int | Ident] => Some(found.text(range).to_owned()),
        [Int, DotDot, Int] if found.written(range.start) == "0" => {
            let last: u64 = found.written(range.end - 1).parse().ok()?;
            Some(last.checked_add(1)?.to_string())
        }
        _ => None,
    }
}

/// Recognises an enum with `;` between its values: `enum { A; B }`.
pub(super) fn enum_by_semi(found: &Found<'_, '_>) -> Option<Habit> {
    use Token::{Comma, Enum, LBrace, Semi};
    let at = found.fault.at;
    let open = found.structure.parent(at)?;
    let before = open.checked_sub(1).and_then(|at| found.token(at));
    let is_enum = found.token(open) == Some(LBrace) && before == Some(Enum);
    if found.token(at) != Some(Semi) || !is_enum || !found.expects(Comma) {
        return None;
    }
    let close = found.structure.partner(open)?;
    let mut fix = Fix::sure("write `,`");
    let mut edits = Vec::new();
    for at in (at..close).filter(|at| found.token(*at) == Some(Semi)) {
        let is_last = at + 1 == close;
        fix = fix.replace(found.span_at(at), if is_last { "" } else { "," });
        edits.push(match is_last {
            true => (at..at + 1, Vec::new()),
            false => found.instead(at, &[Comma]),
        });
    }
    let finding = habit("the values of an enum are separated by `,`")
        .at(found.span_at(at), "`;` separates the fields of a struct")
        .fix(fix);
    let mend = Mend::Tokens(edits);
    Some(Habit { finding, mend })
}

/// Recognises an integer type with a unit: `int[m]`.
pub(super) fn unit_of_int(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    if found.token(at) != Some(Token::LBracket) || found.token_before() != Some(Token::IntType) {
        return None;
    }
    let close = found.structure.partner(at)?;
    let span = found.span_at(at - 1);
    let finding = Finding::new(Code::RPI0001, "an `int` cannot have a unit")
        .at(
            found.span_of(at..close + 1),
            "only a `real` can have a unit",
        )
        .also(span, "declared as an integer")
        .fix(Fix::maybe("make it a `real`").replace(span, "real"));
    let mend = Mend::Tokens(vec![found.instead(at - 1, &[Token::RealType])]);
    Some(Habit { finding, mend })
}
