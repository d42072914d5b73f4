//! Declarations of other languages with the type before the name, as in C.

use super::{ForeignSyntax, Repair, foreign_syntax};
use crate::lexer::Lexeme;
use crate::syntax_errors::ErrorContext;
use crate::token::Token;
use rpi_diag::Fix;

/// Returns the RPI type keyword for a numeric or Boolean type of another language, such as `double`; `None` for other
/// words.
pub(super) fn foreign_type(word: &str) -> Option<Token> {
    let word = word.to_ascii_lowercase();
    let word = word
        .trim_end_matches("_t")
        .trim_end_matches(|c: char| c.is_ascii_digit());
    Some(match word {
        "float" | "double" | "real" | "lreal" | "f" | "single" | "num" => Token::RealType,
        "int" | "integer" | "uint" | "dint" | "udint" | "lint" | "sint" | "usint" | "long"
        | "short" | "char" | "byte" | "word" | "dword" | "unsigned" | "i" | "u" | "size" => {
            Token::IntType
        }
        "bool" | "boolean" | "bit" => Token::BoolType,
        _ => return None,
    })
}

/// Recognises ports with the type first: `(double x)`, `(int a[3], bool c)`, `(unsigned int n)`.
pub(super) fn ports_with_type_first(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let fault = found.error.index;
    let near = [fault, fault.saturating_sub(1), fault.saturating_sub(2)];
    let begins = |at: &usize| begins_port(found, *at) && type_of(found, *at).is_some();
    let mut at = near.into_iter().find(begins)?;
    let in_header =
        (found.structure.parent(at)).is_some_and(|open| is_declaration_list(found, open));
    let first =
        TypeFirstPort::read(found, at).filter(|port| in_header && fault <= port.name + 1)?;
    let place = found.range_span(at..first.end);
    let diagnostic = foreign_syntax(format!(
        "the name is written before its type: `{}`",
        first.text
    ))
    .primary(place, "the type comes first here");
    let mut fix = match found.token_at(at) {
        Some(Token::Ident) => Fix::maybe(format!("write `{}`", first.text)),
        _ => Fix::sure(format!("write `{}`", first.text)),
    };
    let mut edits = Vec::new();
    let mut next = Some(first);
    // One diagnostic covers all following ports in the same form.
    while let Some(port) = next {
        fix = fix.replace(found.range_span(at..port.end), port.text.clone());
        edits.push((at..port.end, port.tokens));
        at = port.end + 1;
        next = match found.token_at(port.end) {
            Some(Token::Comma | Token::Semi) => TypeFirstPort::read(found, at),
            _ => None,
        };
        if next.is_some() && found.token_at(port.end) == Some(Token::Comma) {
            fix = fix.replace(found.token_span(port.end), ";");
            edits.push(found.replacement(port.end, &[Token::Semi]));
        }
    }
    Some(ForeignSyntax {
        diagnostic: diagnostic.fix(fix),
        repair: Repair::ReplaceTokens(edits),
    })
}

/// Returns whether the token before `at` allows a port or field to begin at token `at`.
fn begins_port(found: &ErrorContext<'_, '_>, at: usize) -> bool {
    use Token::{Comma, LBrace, LParen, Semi};
    let before = at.checked_sub(1).and_then(|at| found.token_at(at));
    matches!(before, Some(Comma | LBrace | LParen | Semi))
}

/// Returns whether the bracket at token `open` encloses ports or the fields of a struct.
fn is_declaration_list(found: &ErrorContext<'_, '_>, open: usize) -> bool {
    let before = open.checked_sub(1).and_then(|at| found.token_at(at));
    let is_struct = found.token_at(open) == Some(Token::LBrace) && before == Some(Token::Struct);
    is_struct || is_port_list(found, open)
}

/// Port of another language whose type is written before its name, as in C.
struct TypeFirstPort {
    /// Index of the token with the name.
    name: usize,
    /// Index one past the last token of the port.
    end: usize,
    /// Source text of the port in RPI: `x: int^3`.
    text: String,
    /// RPI tokens of the port, with the name before the type.
    tokens: Vec<Lexeme>,
}

impl TypeFirstPort {
    fn read(found: &ErrorContext<'_, '_>, first: usize) -> Option<TypeFirstPort> {
        use Token::{Comma, Hat, Ident, Int, LBracket, RBrace, RBracket, RParen, Semi};
        let ends = |at: usize| matches!(found.token_at(at), Some(Comma | Semi | RParen | RBrace));
        let mut last = first;
        while last < first + 2 && type_of(found, last + 1).is_some() && !ends(last + 2) {
            last += 1;
        }
        let ty = type_of(found, last)?;
        let name = last + 1;
        let shape = [name + 1, name + 2, name + 3].map(|at| found.token_at(at));
        let is_array = matches!(shape, [Some(LBracket), Some(Int | Ident), Some(RBracket)]);
        let end = name + if is_array { 4 } else { 1 };
        if found.token_at(name) != Some(Ident) || !ends(end) {
            return None;
        }
        let word = ty.spelling().unwrap_or_default();
        let mut meant = format!("{}: {word}", found.source_text(name));
        let mut tokens = vec![found.lexemes[name]];
        tokens.extend(found.replacement(last, &[Token::Colon, ty]).1);
        if is_array {
            meant.push_str(&format!("^{}", found.source_text(name + 2)));
            tokens.extend(found.replacement(name + 1, &[Hat]).1);
            tokens.push(found.lexemes[name + 2]);
        }
        let tokens = in_text_order(&tokens);
        Some(TypeFirstPort {
            name,
            end,
            text: meant,
            tokens,
        })
    }
}

/// Returns the tokens with locations in ascending order, as the grammar requires.
///
/// A token that is out of order gets the empty location at the end of the token before it.
pub(super) fn in_text_order(tokens: &[Lexeme]) -> Vec<Lexeme> {
    let mut end = 0;
    let mut ordered = Vec::with_capacity(tokens.len());
    for lexeme in tokens {
        let start = lexeme.start.max(end);
        end = lexeme.end.max(start);
        ordered.push(Lexeme {
            start,
            end,
            ..*lexeme
        });
    }
    ordered
}

/// Returns the type keyword that token `at` denotes in RPI or in another language; `None` if it denotes no type.
pub(crate) fn type_of(found: &ErrorContext<'_, '_>, at: usize) -> Option<Token> {
    match found.token_at(at)? {
        token @ (Token::BoolType | Token::IntType | Token::RealType) => Some(token),
        Token::Ident => foreign_type(found.source_text(at)),
        _ => None,
    }
}

/// Returns whether the bracket at token `open` encloses the ports of a declaration.
pub(crate) fn is_port_list(found: &ErrorContext<'_, '_>, open: usize) -> bool {
    found.token_at(open) == Some(Token::LParen) && found.structure.parent(open).is_none()
}

/// Recognises a top-level constant with the type first: `const int n = 3;`.
pub(super) fn const_with_type_first(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let fault = found.error.index;
    let mut places = [fault, fault.saturating_sub(1)].into_iter();
    let at = places.find(|at| {
        let before = at.checked_sub(1).and_then(|at| found.token_at(at));
        let shape = [found.token_at(at + 1), found.token_at(at + 2)]
            == [Some(Token::Ident), Some(Token::Eq)];
        matches!(before, Some(Token::Const | Token::Semi)) && shape && type_of(found, *at).is_some()
    })?;
    if found.token_at(0) != Some(Token::Const) {
        return None;
    }
    let ty = type_of(found, at)?;
    let meant = format!(
        "{}: {}",
        found.source_text(at + 1),
        ty.spelling().unwrap_or_default()
    );
    let place = found.range_span(at..at + 2);
    let diagnostic = foreign_syntax(format!("the name is written before its type: `{meant}`"))
        .primary(place, "the type comes first here")
        .fix(Fix::sure(format!("write `{meant}`")).replace(place, meant));
    let mut tokens = vec![found.lexemes[at + 1]];
    tokens.extend(found.replacement(at, &[Token::Colon, ty]).1);
    Some(ForeignSyntax {
        diagnostic,
        repair: Repair::ReplaceTokens(vec![(at..at + 2, in_text_order(&tokens))]),
    })
}

/// Recognises array and list types: `[int; 3]`, `list[int]`.
pub(super) fn array_type(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    use Token::{Colon, Hat, Ident, Int, LBracket, RBracket, Semi};
    let at = found.error.index;
    let open = (at.saturating_sub(4)..=at)
        .rev()
        .find(|at| found.token_at(*at) == Some(LBracket))?;
    let close = found.structure.partner(open)?;
    let before = open.checked_sub(1).and_then(|at| found.token_at(at));
    let ty = type_of(found, open + 1)?;
    let word = ty.spelling().unwrap_or_default();
    let diagnostic = foreign_syntax("the size of an array follows `^`");
    let shape = [open + 2, open + 3].map(|at| found.token_at(at));
    if before == Some(Colon)
        && matches!(shape, [Some(Semi), Some(Int | Ident)])
        && close == open + 4
    {
        let size = found.source_text(open + 3);
        let (meant, place) = (format!("{word}^{size}"), found.range_span(open..close + 1));
        let mut tokens = found.replacement(open, &[ty, Hat]).1;
        tokens.push(found.lexemes[open + 3]);
        return Some(ForeignSyntax {
            diagnostic: diagnostic
                .primary(place, "type of another language")
                .fix(Fix::sure(format!("write `{meant}`")).replace(place, meant)),
            repair: Repair::ReplaceTokens(vec![(open..close + 1, tokens)]),
        });
    }
    let is_list = before == Some(Ident) && found.token_at(open - 2) == Some(Colon) && at <= close;
    if !is_list || at != close && found.token_at(open + 2) != Some(RBracket) && at > close {
        return None;
    }
    let place = found.range_span(open - 1..close + 1);
    let diagnostic = diagnostic
        .primary(place, "type of another language")
        .help(format!(
            "an array of three elements is `{word}^3`; lists of variable length do not exist"
        ));
    Some(ForeignSyntax {
        diagnostic,
        repair: Repair::RemoveErrorPhrase,
    })
}

/// Recognises a declaration in C syntax among equations: `int x;`.
pub(super) fn declared_in_body(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    use Token::{Comma, Ident, Semi};
    let fault = found.error.index;
    let start = found.structure.phrase(fault).start;
    let before = start.checked_sub(1).and_then(|at| found.token_at(at));
    let is_statement = matches!(before, Some(Token::Let | Semi | Token::Tel))
        && found.structure.is_in_block(start);
    let ty = type_of(found, start).filter(|_| is_statement)?;
    let name = (start + 1..start + 4)
        .find(|at| found.token_at(*at) == Some(Ident) && type_of(found, *at).is_none())?;
    if (start..name).any(|at| type_of(found, at).is_none()) {
        return None;
    }
    let end = found.structure.phrase(start).end;
    let is_row = (name..end).all(|at| matches!(found.token_at(at), Some(Ident | Comma)));
    if !is_row || found.token_at(end) != Some(Semi) || fault > end {
        return None;
    }
    let names = found.range_text(name..end);
    let diagnostic = foreign_syntax("locals are declared before `let`")
        .primary(found.range_span(start..end), "declaration among the equations")
        .help(format!(
            "`var {names}: {};` between the ports and `let`; in `.rpi` files it is optional: an equation declares its flow",
            ty.spelling().unwrap_or_default()
        ))
        .fix(Fix::maybe("delete it").replace(found.range_span(start..end + 1), ""));
    Some(ForeignSyntax {
        diagnostic,
        repair: Repair::ReplaceTokens(vec![(start..end + 1, Vec::new())]),
    })
}

/// Recognises an array declaration in C syntax among equations: `int a[3] = {1, 2, 3};`, `int a[3];`.
pub(super) fn array_in_body(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    use Token::{Ident, LBracket, Semi};
    let start = found.structure.phrase(found.error.index).start;
    let before = start.checked_sub(1).and_then(|at| found.token_at(at));
    let is_statement = matches!(before, Some(Token::Let | Semi | Token::Tel));
    let ty =
        type_of(found, start).filter(|_| is_statement && found.structure.is_in_block(start))?;
    let shape =
        [found.token_at(start + 1), found.token_at(start + 2)] == [Some(Ident), Some(LBracket)];
    let close = found.structure.partner(start + 2).filter(|_| shape)?;
    let end = found.structure.phrase(start).end;
    let name = found.source_text(start + 1);
    let size = found.range_text(start + 3..close.max(start + 4));
    let diagnostic = foreign_syntax("an array is defined by an equation with its elements")
        .primary(
            found.range_span(start..close + 1),
            "declaration in the syntax of another language",
        )
        .help(format!(
            "`{name} = [1, 2, 3];`; its type may be declared before `let`: `var {name}: {}^{size};`",
            ty.spelling().unwrap_or_default()
        ));
    let names = match found.token_at(close + 1) {
        Some(Token::Eq) => vec![found.ident(start + 1)],
        _ => Vec::new(),
    };
    found
        .cx
        .suppress_foreign_operators(found.range_span(start..end));
    Some(ForeignSyntax {
        diagnostic,
        repair: Repair::RemovePhrase(start..end, names),
    })
}
