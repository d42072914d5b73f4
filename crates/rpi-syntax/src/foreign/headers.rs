//! Errors in the headers of declarations: `returns`, body delimiters, separators, types of ports.

use super::imperative::end_of_span;
use super::{ForeignSyntax, Repair, foreign_syntax};
use crate::lexer::Lexeme;
use crate::syntax_errors::ErrorContext;
use crate::token::Token;
use rpi_diag::{Code, Diagnostic, Fix};

/// Recognises out-ports without `returns`: `node f (x: real) -> (y: real)`, `node f (x: real) (y: real)`.
pub(super) fn missing_returns(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    let diagnostic = || foreign_syntax("the out-ports follow `returns`");
    if !found.expects(Token::Returns) {
        return None;
    }
    match found.token_at(at)? {
        Token::Arrow | Token::Implies => {
            let span = found.token_span(at);
            let fix = Fix::sure("write `returns`").replace(span, "returns");
            let diagnostic = diagnostic()
                .primary(span, "`->` initialises a flow")
                .fix(fix);
            let repair = Repair::ReplaceTokens(vec![found.replacement(at, &[Token::Returns])]);
            Some(ForeignSyntax { diagnostic, repair })
        }
        Token::LParen => {
            let span = found.token_span(at);
            let fix = Fix::sure("insert `returns`").insert_before(span, "returns ");
            let diagnostic = diagnostic()
                .primary(span, "expected `returns` before this")
                .fix(fix);
            let repair = Repair::ReplaceTokens(vec![found.insertion(at, Token::Returns)]);
            Some(ForeignSyntax { diagnostic, repair })
        }
        _ => None,
    }
}

/// Recognises commas between declarations or fields: `(x: real, b: bool)`, `{x = 1.0, y = 2.0}`.
pub(super) fn comma_for_semi(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    let names = found.token_at(at + 1) == Some(Token::Ident);
    let open = found.structure.parent(at).and_then(|at| found.token_at(at));
    let what = match open {
        Some(Token::LBrace) => "fields",
        _ => "declarations",
    };
    let defined = match found.token_at(at + 2) {
        Some(Token::Colon | Token::Comma) => true,
        Some(Token::Eq) => open == Some(Token::LBrace),
        _ => false,
    };
    if found.token_at(at) != Some(Token::Comma) || !found.expects(Token::Semi) || !names || !defined
    {
        return None;
    }
    let diagnostic = foreign_syntax(format!("{what} are separated by `;`"))
        .primary(
            found.token_span(at),
            "`,` separates names of the same type: `x, y: real`",
        )
        .fix(Fix::sure("write `;`").replace(found.token_span(at), ";"));
    let repair = Repair::ReplaceTokens(vec![found.replacement(at, &[Token::Semi])]);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Recognises declarations without a separator: `(x: real y: int)`.
pub(super) fn missing_semi(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    use Token::{Colon, Comma, Ident, Plus, RParen, Semi};
    let at = found.error.index;
    let declares =
        found.token_at(at) == Some(Ident) && matches!(found.token_at(at + 1), Some(Colon | Comma));
    let in_list = found.expects(Semi) && found.expects(RParen) && !found.expects(Plus);
    (declares && in_list).then(|| ForeignSyntax {
        diagnostic: found.missing_semi(),
        repair: Repair::ReplaceTokens(vec![found.insertion(at, Semi)]),
    })
}

/// Recognises ports without the closing parenthesis: `node f (x: real) returns (y: real let y = x; tel`.
pub(super) fn unclosed_ports(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    use Token::{Con, LParen, Let, RParen, Returns, Var};
    let at = found.error.index;
    let goes_on = matches!(found.token_at(at), Some(Con | Let | Returns | Var));
    let is_open =
        |i: &usize| found.token_at(*i) == Some(LParen) && found.structure.partner(*i).is_none();
    let open = (0..at).rev().find(is_open)?;
    let in_body = (0..at).any(|i| found.token_at(i) == Some(Let));
    if !goes_on || in_body || !found.expects(RParen) {
        return None;
    }
    Some(ForeignSyntax {
        diagnostic: found.unclosed_bracket(open),
        repair: Repair::ReplaceTokens(vec![found.insertion(at, RParen)]),
    })
}

/// Recognises a declaration without `:`: `(x real)`.
pub(super) fn missing_colon(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    use Token::{BoolType, Enum, Ident, IntType, RealType, Struct};
    let at = found.error.index;
    let named = found.token_before() == Some(Ident) && found.expects(Token::Colon);
    let is_upper = |at: usize| found.source_text(at).starts_with(char::is_uppercase);
    let is_type = match found.token_at(at)? {
        BoolType | IntType | RealType | Enum | Struct => true,
        // Heuristic: names of types usually begin with a capital letter, names of flows do not.
        Ident => is_upper(at) && !is_upper(at - 1) && found.token_at(at + 1) != Some(Token::Colon),
        _ => false,
    };
    if !named || !is_type {
        return None;
    }
    let name = found.token_span(at - 1);
    let diagnostic = found.unexpected_token();
    let diagnostic = diagnostic.fix(Fix::sure("insert `:`").insert_after(name, ":"));
    let repair = Repair::ReplaceTokens(vec![found.insertion(at, Token::Colon)]);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Recognises a declaration with the type before the name: `(real x)`.
pub(super) fn type_first(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    use Token::{BoolType, Comma, Ident, IntType, RParen, RealType, Semi};
    let at = found.error.index;
    let known = |token| matches!(token, BoolType | IntType | RealType);
    let ty = match (found.token_before(), found.token_at(at)) {
        (_, Some(token)) if known(token) && found.expects(Ident) && !found.expects(token) => at,
        (Some(Ident), Some(Ident)) if is_declared_by_type(found, at) => at - 1,
        _ => return None,
    };
    let ends = matches!(found.token_at(ty + 2), Some(Semi | Comma | RParen));
    if found.token_at(ty + 1) != Some(Ident) || !ends {
        return None;
    }
    let (written, name) = (found.source_text(ty), found.source_text(ty + 1));
    let span = found.range_span(ty..ty + 2);
    let meant = format!("{name}: {written}");
    let diagnostic = foreign_syntax(format!("the name is written before its type: `{meant}`"))
        .primary(span, "the type comes first here")
        .fix(Fix::sure(format!("write `{meant}`")).replace(span, meant));
    let token = found.lexemes[ty].token;
    let repair = match known(token) {
        true => Repair::ReplaceTokens(vec![(ty..ty + 2, swap_type_and_name(found, ty))]),
        false => Repair::RemovePhrase(ty..ty + 2, vec![found.ident(ty + 1)]),
    };
    Some(ForeignSyntax { diagnostic, repair })
}

/// Returns whether token `at` and the token before it are a name and its type, as in `Limits l`.
///
/// As a heuristic, the names of types begin with a capital letter and those of flows do not. Where the grammar accepts
/// a value, the cause is a missing comma or operator instead.
fn is_declared_by_type(found: &ErrorContext<'_, '_>, at: usize) -> bool {
    let is_upper = |at: usize| found.source_text(at).starts_with(char::is_uppercase);
    let is_declaration = found.expects(Token::Colon) && !found.expects(Token::Plus);
    is_declaration && is_upper(at - 1) && !is_upper(at)
}

/// Returns the tokens of `x: real` that replace those of `real x`, whose type is at token `ty`.
// The new tokens lie at the end of the old ones: the grammar needs locations in text order.
fn swap_type_and_name(found: &ErrorContext<'_, '_>, ty: usize) -> Vec<Lexeme> {
    let name = found.lexemes[ty + 1];
    let end = end_of_span(found.token_span(ty + 1)).start;
    let at = |token| Lexeme {
        token,
        start: end,
        end,
    };
    vec![name, at(Token::Colon), at(found.lexemes[ty].token)]
}

/// Recognises an array type with its size in brackets: `int[3]`.
pub(super) fn size_in_brackets(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    use Token::{BoolType, Hat, Ident, Int, IntType, LBracket, RBracket};
    let at = found.error.index;
    let shape = [
        found.token_at(at),
        found.token_at(at + 1),
        found.token_at(at + 2),
    ];
    let is_size = match shape {
        [Some(LBracket), Some(Int), Some(RBracket)] => true,
        // After `real`, brackets contain a unit.
        [Some(LBracket), Some(Ident), Some(RBracket)] => {
            let is_type = matches!(found.token_before(), Some(BoolType | IntType));
            is_type && found.cx.guessed_names.declares(found.source_text(at + 1))
        }
        _ => false,
    };
    if !is_size || !found.expects(Hat) {
        return None;
    }
    let meant = format!("^{}", found.source_text(at + 1));
    let span = found.range_span(at..at + 3);
    let diagnostic = foreign_syntax("the size of an array follows `^`")
        .primary(span, "brackets enclose an index, or the unit of a `real`")
        .fix(size_fix(found, at + 3, format!("write `{meant}`")).replace(span, meant));
    let size = found.lexemes[at + 1];
    let repair = Repair::ReplaceTokens(vec![
        found.replacement(at, &[Hat]),
        (at + 1..at + 3, vec![size]),
    ]);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Creates a fix for the notation of an array size. The fix is not sure if a further size follows at token `next`, as
/// in `int[3][2]`, because the order of the sizes changes too.
fn size_fix(found: &ErrorContext<'_, '_>, next: usize, title: String) -> Fix {
    match found.token_at(next) {
        Some(Token::LBracket) => Fix::maybe(title),
        _ => Fix::sure(title),
    }
}

/// Recognises array types of Pascal and IEC 61131-3: `array[3] of int`, `ARRAY [0..2] OF real[m]`.
pub(super) fn array_of(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    use Token::{BoolType, Hat, Ident, IntType, LBracket, Path, RealType};
    let at = found.error.index;
    let open = (at.saturating_sub(3)..=at).find(|at| found.token_at(*at) == Some(LBracket))?;
    let (word, close) = (open.checked_sub(1)?, found.structure.partner(open)?);
    let element = close + 2;
    let is = |at, word: &str| found.source_text(at).eq_ignore_ascii_case(word);
    let is_type = matches!(
        found.token_at(element)?,
        BoolType | IntType | RealType | Ident | Path
    );
    if !is(word, "array") || !is(close + 1, "of") || !is_type {
        return None;
    }
    let last = match (
        found.token_at(element + 1),
        found.structure.partner(element + 1),
    ) {
        (Some(LBracket), Some(end)) => end,
        _ => element,
    };
    let place = found.range_span(word..last + 1);
    let diagnostic = foreign_syntax("the size of an array follows the type of its elements")
        .primary(place, "`array ... of` is from another language");
    let Some(size) = array_size(found, open + 1..close) else {
        return Some(ForeignSyntax {
            diagnostic: diagnostic
                .help("an array of three integers is `int^3`; indices start at 0"),
            repair: Repair::RemoveErrorPhrase,
        });
    };
    let meant = format!("{}^{size}", found.range_text(element..last + 1));
    let fix = Fix::sure(format!("write `{meant}`")).replace(place, meant);
    let mut tokens = found.lexemes[element..=last].to_vec();
    tokens.extend(found.replacement(word, &[Hat]).1);
    tokens.push(found.lexemes[close - 1]);
    // The size of `0..2` is not a token of the text, so no token can stand for it.
    let repair = match close - open {
        2 => Repair::ReplaceTokens(vec![(word..last + 1, tokens)]),
        _ => Repair::RemoveErrorPhrase,
    };
    Some(ForeignSyntax {
        diagnostic: diagnostic.fix(fix),
        repair,
    })
}

/// Returns the size of an array from the tokens between its brackets, `3`, `n` or `0..2` (which is 3); `None` for other
/// forms.
fn array_size(found: &ErrorContext<'_, '_>, range: std::ops::Range<usize>) -> Option<String> {
    use Token::{DotDot, Ident, Int};
    let tokens: Vec<Token> = range.clone().filter_map(|at| found.token_at(at)).collect();
    match tokens[..] {
        [Int | Ident] => Some(found.range_text(range).to_owned()),
        [Int, DotDot, Int] if found.source_text(range.start) == "0" => {
            let last: u64 = found.source_text(range.end - 1).parse().ok()?;
            Some(last.checked_add(1)?.to_string())
        }
        _ => None,
    }
}

/// Recognises an enum with `;` between its values: `enum { A; B }`.
pub(super) fn enum_by_semi(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    use Token::{Comma, Enum, LBrace, Semi};
    let at = found.error.index;
    let open = found.structure.parent(at)?;
    let before = open.checked_sub(1).and_then(|at| found.token_at(at));
    let is_enum = found.token_at(open) == Some(LBrace) && before == Some(Enum);
    if found.token_at(at) != Some(Semi) || !is_enum || !found.expects(Comma) {
        return None;
    }
    let close = found.structure.partner(open)?;
    let mut fix = Fix::sure("write `,`");
    let mut edits = Vec::new();
    for at in (at..close).filter(|at| found.token_at(*at) == Some(Semi)) {
        let is_last = at + 1 == close;
        fix = fix.replace(found.token_span(at), if is_last { "" } else { "," });
        edits.push(match is_last {
            true => (at..at + 1, Vec::new()),
            false => found.replacement(at, &[Comma]),
        });
    }
    let diagnostic = foreign_syntax("the values of an enum are separated by `,`")
        .primary(found.token_span(at), "`;` separates the fields of a struct")
        .fix(fix);
    let repair = Repair::ReplaceTokens(edits);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Recognises an integer type with a unit: `int[m]`.
pub(super) fn unit_of_int(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    if found.token_at(at) != Some(Token::LBracket) || found.token_before() != Some(Token::IntType) {
        return None;
    }
    let close = found.structure.partner(at)?;
    let span = found.token_span(at - 1);
    let diagnostic = Diagnostic::new(Code::RPI0001, "an `int` cannot have a unit")
        .primary(
            found.range_span(at..close + 1),
            "only a `real` can have a unit",
        )
        .secondary(span, "declared as an integer")
        .fix(Fix::maybe("make it a `real`").replace(span, "real"));
    // The type stays the declared one, so that equations with other integers are not reported as well.
    let repair = Repair::ReplaceTokens(vec![(at..close + 1, Vec::new())]);
    Some(ForeignSyntax { diagnostic, repair })
}
