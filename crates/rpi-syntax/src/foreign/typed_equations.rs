//! Equations with a type, equations without `=`, casts, shifts, and `;` in place of other separators.

use super::{ForeignSyntax, Repair, foreign_syntax};
use crate::Dialect;
use crate::lexer::Lexeme;
use crate::syntax_errors::ErrorContext;
use crate::token::Token;
use rpi_diag::{Code, Diagnostic, Fix};
use std::ops::Range;

/// Recognises an equation that begins with a type or declaration keyword: `int z = 3;`, `let z: int = 3;`.
pub(super) fn typed_equation_keyword(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    use Token::{BoolType, Const, IntType, Let, RealType, Var};
    let word = found.token_at(found.error.index)?;
    let begins = matches!(word, BoolType | Const | IntType | Let | RealType | Var);
    (begins && found.expects_equation()).then(|| typed_equation(found))?
}

/// Recognises an equation with a type: `int z = 3;`, `z: int = 3;`, `Angle z = 3;`.
pub(super) fn typed_equation(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    use Token::{Const, Let, Var};
    let at = found.error.index;
    let phrase = match found.token_at(at)? {
        Const | Let | Var if found.token_at(at + 1).is_some() => {
            at..found.structure.phrase(at + 1).end
        }
        _ => found.structure.phrase(at),
    };
    if !is_statement(found, phrase.start) {
        return None;
    }
    let (ty, name) = type_and_name(found, phrase.clone())?;
    let written = found.source_text(name);
    let seen = match found.cx.dialect {
        Dialect::Lustre => "a flow has its type in its declaration".to_owned(),
        Dialect::Rpi => format!("`{written}` has the type of its value"),
    };
    let diagnostic = foreign_syntax("an equation cannot state the type of its flow")
        .primary(found.range_span(ty.clone()), seen);
    let sign = (name..phrase.end).find(|at| found.token_at(*at) == Some(Token::Eq))?;
    if found.cx.dialect == Dialect::Lustre {
        let diagnostic = diagnostic.help(format!(
            "declare it before `let`: `var {written}: {};`",
            found.source_text(ty.start)
        ));
        let repair = Repair::RemovePhrase(phrase, vec![found.ident(name)]);
        return Some(ForeignSyntax { diagnostic, repair });
    }
    let place = found
        .cx
        .span(found.lexemes[phrase.start].start, found.lexemes[sign].end);
    let meant = format!("{written} =");
    let stated = found.range_text(ty).trim_start_matches(':').trim();
    let diagnostic = diagnostic
        .help(format!(
            "a flow with a stated type is declared before `let`: `var {written}: {stated};`"
        ))
        .fix(Fix::maybe(format!("write `{meant} ...`")).replace(place, meant));
    let kept = vec![found.lexemes[name], found.lexemes[sign]];
    let repair = Repair::ReplaceTokens(vec![(phrase.start..sign + 1, kept)]);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Returns whether a statement of a body of equations begins at token `at`.
fn is_statement(found: &ErrorContext<'_, '_>, at: usize) -> bool {
    let before = at.checked_sub(1).and_then(|at| found.token_at(at));
    let begins = matches!(before, Some(Token::Let | Token::Semi | Token::Tel));
    begins && found.structure.is_in_block(at)
}

/// Returns the token range of the type in an equation with a type, and the token index of the name of the flow. `None`
/// if the phrase (a range of tokens) has another form.
fn type_and_name(
    found: &ErrorContext<'_, '_>,
    phrase: Range<usize>,
) -> Option<(Range<usize>, usize)> {
    use Token::{BoolType, Colon, Const, Eq, Ident, IntType, LBracket, Let, RealType, Var};
    let start = phrase.start;
    let first = match found.token_at(start)? {
        Let | Var | Const => start + 1,
        _ => start,
    };
    let shape = [found.token_at(first), found.token_at(first + 1)];
    if shape == [Some(Ident), Some(Colon)] {
        let sign = (first + 2..phrase.end).find(|at| found.token_at(*at) == Some(Eq))?;
        return (sign > first + 2).then_some((first + 1..sign, first));
    }
    let end = match shape {
        [Some(RealType), Some(LBracket)] => found.structure.partner(first + 1)? + 1,
        [Some(BoolType | IntType | RealType | Ident), _] => first + 1,
        _ => return None,
    };
    let is_foreign = end <= found.error.index || found.token_at(first) != Some(Ident);
    let named = [found.token_at(end), found.token_at(end + 1)] == [Some(Ident), Some(Eq)];
    (named && is_foreign).then_some((first..end, end))
}

/// Recognises an equation without `=`: `y x;`, `let y 3;`, `const c: int 3;`.
pub(super) fn missing_eq(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    use Token::{BoolType, Colon, Const, Eq, Ident, IntType, Let, RBracket, RealType, Semi, Tel};
    let (word, at) = match found.token_at(found.error.index)? {
        Let if found.expects_equation() => (Some(found.error.index), found.error.index + 2),
        _ => (None, found.error.index),
    };
    let before = at.checked_sub(1).and_then(|at| found.token_at(at))?;
    let second = at.checked_sub(2).and_then(|at| found.token_at(at));
    let begins = matches!(second, Some(Colon | Const | Let | Semi | Tel));
    let is_equation = match (word, before) {
        (Some(_), _) => before == Ident,
        (None, Ident) => found.expects(Eq) && begins && !found.source_text(at - 1).is_empty(),
        (None, BoolType | IntType | RealType | RBracket) => found.expects(Eq),
        (None, _) => false,
    };
    if !is_equation || !is_value(found, at) {
        return None;
    }
    let gap = found
        .cx
        .span(found.lexemes[at - 1].end, found.lexemes[at].start);
    let written = found.source_text(at - 1);
    let diagnostic = Diagnostic::new(Code::RPI0001, format!("expected `=` after `{written}`"))
        .primary(found.token_span(at), "the value begins here");
    let fix = Fix::maybe("insert `=`").replace(gap, " = ");
    let mut edits = vec![found.insertion(at, Eq)];
    let fix = match word {
        Some(word) => {
            edits.insert(0, (word..word + 1, Vec::new()));
            let place = found
                .cx
                .span(found.lexemes[word].start, found.lexemes[word + 1].start);
            fix.replace(place, "")
        }
        None => fix,
    };
    let repair = Repair::ReplaceTokens(edits);
    let diagnostic = diagnostic.fix(fix);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Recognises an assignment with `<=`: `y <= x;`.
pub(super) fn le_assignment(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    let name = at.checked_sub(1)?;
    let is_sign = found.token_at(at) == Some(Token::Le) && found.expects(Token::Eq);
    if !is_sign || found.token_at(name) != Some(Token::Ident) || !is_statement(found, name) {
        return None;
    }
    let span = found.token_span(at);
    let diagnostic = foreign_syntax("a definition is written with `=`")
        .primary(span, "`<=` is a comparison")
        .fix(Fix::sure("write `=`").replace(span, "="));
    let repair = Repair::ReplaceTokens(vec![found.replacement(at, &[Token::Eq])]);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Returns whether the right side of an equation seems to begin at token `at`.
///
/// The rest of the statement must be on one line, without `=` and `:`, and without two adjacent names or numbers.
fn is_value(found: &ErrorContext<'_, '_>, at: usize) -> bool {
    use Token::{Colon, Eq, False, Ident, Int, Not, Pre, Real, True};
    let begins = |token| matches!(token, False | Ident | Int | Not | Pre | Real | True);
    if !found.token_at(at).is_some_and(begins) {
        return false;
    }
    let phrase = found.structure.phrase(at);
    let value = &found.lexemes[at..phrase.end.max(at + 1).min(found.lexemes.len())];
    let in_row = |pair: &[Lexeme]| {
        matches!(pair[0].token, Ident | Int | Real) && matches!(pair[1].token, Ident | Int | Real)
    };
    let strange = value.windows(2).any(in_row)
        || value
            .iter()
            .any(|lexeme| matches!(lexeme.token, Eq | Colon));
    let last = value.last().map_or(0, |last| last.end);
    let line = found.cx.slice(found.lexemes[at - 1].start, last);
    !strange && !line.contains('\n')
}

/// Recognises a type conversion of C: `(int)x`.
pub(super) fn cast(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    use Token::{Ident, Int, IntType, LParen, RParen, Real, RealType};
    let at = found.error.index;
    let open = at.checked_sub(2)?;
    let ty = found.token_at(at - 1)?;
    let shape = [found.token_at(open), found.token_at(at)] == [Some(LParen), Some(RParen)];
    let value = matches!(found.token_at(at + 1), Some(Ident | Int | LParen | Real));
    if !shape || !value || !matches!(ty, IntType | RealType) {
        return None;
    }
    let word = found.source_text(at - 1);
    let span = found.range_span(open..at + 1);
    let diagnostic = foreign_syntax(format!("a conversion is written `{word} x`"))
        .primary(span, "a type cannot be in parentheses")
        .fix(Fix::maybe(format!("write `{word}`")).replace(span, format!("{word} ")));
    let repair = Repair::ReplaceTokens(vec![(open..at + 1, vec![found.lexemes[at - 1]])]);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Recognises a type conversion of Rust: `x as int`.
pub(super) fn as_cast(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    use Token::{Ident, Int, IntType, RParen, Real, RealType};
    let at = found.error.index;
    let ty = found.token_at(at + 1)?;
    let last = at.checked_sub(1)?;
    let start = match found.token_at(last)? {
        Ident | Int | Real => last,
        RParen => found.structure.partner(last)?,
        _ => return None,
    };
    if found.source_text(at) != "as"
        || !matches!(ty, IntType | RealType)
        || !found.expects(Token::Plus)
    {
        return None;
    }
    let meant = format!(
        "{} {}",
        found.source_text(at + 1),
        found.range_text(start..at)
    );
    let place = found.range_span(start..at + 2);
    let diagnostic = foreign_syntax(format!("a conversion is written `{meant}`"))
        .primary(
            found.range_span(at..at + 2),
            "the type is written before the value",
        )
        .fix(Fix::maybe(format!("write `{meant}`")).replace(place, meant));
    let mut tokens = vec![found.lexemes[at + 1]];
    tokens.extend_from_slice(&found.lexemes[start..at]);
    let repair = Repair::ReplaceTokens(vec![(start..at + 2, tokens)]);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Maximum distance in tokens from the rejected token back to a shift operator. Bounds the time per syntax error.
const MAX_DISTANCE: usize = 50;

/// Recognises a shift: `x << 2`, `x >> 1`.
pub(super) fn shift(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    use Token::{Ident, Int, LStatic, RParen, Star};
    let at = found.error.index;
    let sign = (at.saturating_sub(MAX_DISTANCE)..=at)
        .rev()
        .find(|at| is_shift(found, *at))?;
    let before = sign.checked_sub(1).and_then(|at| found.token_at(at));
    let sides = [before, found.token_at(sign + 1)];
    if !matches!(sides, [Some(Ident | Int | RParen), Some(Ident | Int)]) {
        return None;
    }
    // A name directly after `<<` is a static argument.
    let gap = found
        .cx
        .slice(found.lexemes[sign].end, found.lexemes[sign + 1].start);
    let is_name = sides[1] == Some(Ident);
    if found.token_at(at).is_none() || is_name && gap.is_empty() {
        return None;
    }
    let by = if found.token_at(sign) == Some(LStatic) {
        "*"
    } else {
        "div"
    };
    let diagnostic = foreign_syntax("there is no shift operator").primary(
        found.token_span(sign),
        "double angle brackets enclose static parameters",
    );
    let amount: Option<u32> = found.source_text(sign + 1).parse().ok().filter(|n| *n < 63);
    let diagnostic = match amount {
        Some(amount) => {
            with_shift_fix(found, diagnostic, sign, &format!("{by} {}", 1u64 << amount))
        }
        None => diagnostic.help(format!("write `{by}` and the power of two")),
    };
    let repair = Repair::ReplaceTokens(vec![found.replacement(sign, &[Star])]);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Adds the fix that replaces the shift at token `sign` by `meant`, such as `div 2`.
///
/// A shift has lower precedence than arithmetic: `x - 1 >> 1` shifts the difference, so that it needs parentheses.
fn with_shift_fix(
    found: &ErrorContext<'_, '_>,
    diagnostic: Diagnostic,
    sign: usize,
    meant: &str,
) -> Diagnostic {
    let Some(first) = shift_operand_start(found, sign) else {
        return diagnostic.help(format!(
            "write `{meant}`, with parentheses around the operand that is meant"
        ));
    };
    let is_single = first + 1 == sign || found.structure.partner(sign - 1) == Some(first);
    let (place, meant) = match is_single {
        true => (found.range_span(sign..sign + 2), meant.to_owned()),
        false => {
            let operand = found.range_text(first..sign);
            let whole = found.range_span(first..sign + 2);
            (whole, format!("({operand}) {meant}"))
        }
    };
    diagnostic.fix(Fix::maybe(format!("write `{meant}`")).replace(place, meant))
}

/// Returns the first token of the left operand, if the shift at token `sign` is a whole value: it and its operand end at
/// a bracket, comma or sign of an equation.
fn shift_operand_start(found: &ErrorContext<'_, '_>, sign: usize) -> Option<usize> {
    use Token::{Comma, Div, Eq, Ident, Int, LBracket, LParen, Minus, Mod, Plus, Star};
    use Token::{RBracket, RParen, Semi, Slash};
    let ends = matches!(
        found.token_at(sign + 2),
        Some(Semi | RParen | RBracket | Comma)
    );
    let mut first = sign;
    loop {
        let before = first.checked_sub(1)?;
        match found.token_at(before)? {
            Div | Ident | Int | Minus | Mod | Plus | Slash | Star => first = before,
            RParen => {
                first = found
                    .structure
                    .partner(before)
                    .filter(|open| *open < before)?
            }
            Eq | LParen | LBracket | Comma => return (ends && first < sign).then_some(first),
            _ => return None,
        }
    }
}

/// Returns whether the `<<` or `>>` at token `at` is a shift: it has no partner within the same equation.
fn is_shift(found: &ErrorContext<'_, '_>, at: usize) -> bool {
    use Token::{Eq, LStatic, RStatic, Semi};
    if !matches!(found.token_at(at), Some(LStatic | RStatic)) {
        return false;
    }
    let Some(other) = found.structure.partner(at) else {
        return true;
    };
    let between = &found.lexemes[at.min(other)..at.max(other)];
    let has = |token| between.iter().any(|lexeme| lexeme.token == token);
    has(Semi) && has(Eq)
}

/// Recognises a call with `;` between its arguments: `f(x; y)`.
pub(super) fn arguments_by_semi(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    use Token::{Comma, Ident, LParen, Path, RStatic, Semi};
    let at = found.error.index;
    let open = found.structure.parent(at)?;
    let before = open.checked_sub(1).and_then(|at| found.token_at(at));
    let is_call =
        found.token_at(open) == Some(LParen) && matches!(before, Some(Ident | Path | RStatic));
    if found.token_at(at) != Some(Semi) || !is_call || !found.expects(Token::Plus) {
        return None;
    }
    let close = found.structure.partner(open)?;
    let is_semi =
        |i: &usize| found.token_at(*i) == Some(Semi) && found.structure.parent(*i) == Some(open);
    let diagnostic = foreign_syntax("the arguments of a call are separated by `,`")
        .primary(found.token_span(at), "`;` separates declarations");
    let is_type = |at: usize| {
        found.token_at(at).is_some_and(is_type_word)
            && matches!(found.token_at(at + 1), Some(Semi | Token::RParen))
    };
    if let Some(ty) = (at..close).find(|at| is_type(*at)) {
        return Some(ForeignSyntax {
            diagnostic: type_as_argument(found, open, at, ty),
            repair: Repair::RemoveErrorPhrase,
        });
    }
    let semis: Vec<usize> = (at..close).filter(is_semi).collect();
    let fix = semis.iter().fold(Fix::sure("write `,`"), |fix, at| {
        fix.replace(found.token_span(*at), ",")
    });
    let edits = semis.iter().map(|at| found.replacement(*at, &[Comma]));
    Some(ForeignSyntax {
        diagnostic: diagnostic.fix(fix),
        repair: Repair::ReplaceTokens(edits.collect()),
    })
}

/// Creates the diagnostic for a type in place of an argument: `f(x; int)`. `open` is the parenthesis of the call, `semi`
/// the first `;` and `ty` the type.
fn type_as_argument(
    found: &ErrorContext<'_, '_>,
    open: usize,
    semi: usize,
    ty: usize,
) -> Diagnostic {
    let value = match found.token_at(ty) {
        Some(Token::BoolType) => "true",
        Some(Token::RealType) => "1.0",
        _ => "1",
    };
    let before = found.range_text(open - 1..semi);
    foreign_syntax("an argument of a call is an expression, not a type")
        .primary(found.token_span(ty), "expected a value")
        .secondary(found.token_span(semi), "arguments are separated by `,`")
        .help(format!(
            "write a value in place of `{}`: `{before}, {value})`",
            found.source_text(ty)
        ))
}

/// Recognises a `;` in place of `:` or `,` in a header: `(x; int)`, `(x; y: int)`.
pub(super) fn semi_in_head(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    use Token::{Colon, Comma, Ident, LParen, RParen, Semi};
    let at = found.error.index;
    let named =
        found.token_before() == Some(Ident) && found.expects(Colon) && !found.expects(Token::Plus);
    let second = at.checked_sub(2).and_then(|at| found.token_at(at));
    let begins = matches!(second, Some(LParen | Semi | Comma));
    if found.token_at(at) != Some(Semi) || !named || !begins {
        return None;
    }
    let span = found.token_span(at);
    let next = found.token_at(at + 1)?;
    let ends = matches!(found.token_at(at + 2), Some(Semi | RParen));
    let (meant, message, seen) = match next {
        ty if is_type_word(ty) && ends => {
            let message = format!("expected `:` after `{}`", found.source_text(at - 1));
            let diagnostic = Diagnostic::new(Code::RPI0001, message);
            (Colon, diagnostic, "the type follows")
        }
        Ident if matches!(found.token_at(at + 2), Some(Colon | Comma)) => {
            let diagnostic = foreign_syntax("names of the same type are separated by `,`");
            (
                Comma,
                diagnostic,
                "`;` ends a declaration, which has no type yet",
            )
        }
        _ => return None,
    };
    let sign = meant.spelling().unwrap_or_default();
    let diagnostic = message
        .primary(span, seen)
        .fix(Fix::maybe(format!("write `{sign}`")).replace(span, sign));
    // The names before the `;` need not have the type after it, so the `,` is not taken for granted.
    let repair = match meant {
        Colon => Repair::ReplaceTokens(vec![found.replacement(at, &[meant])]),
        _ => Repair::RemoveErrorPhrase,
    };
    Some(ForeignSyntax { diagnostic, repair })
}

fn is_type_word(token: Token) -> bool {
    matches!(token, Token::BoolType | Token::IntType | Token::RealType)
}
