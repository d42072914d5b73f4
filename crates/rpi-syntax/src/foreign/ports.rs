//! Headers of other languages: ports without parentheses, types or names, sections of variables.

use super::{ForeignSyntax, Repair, foreign_syntax};
use crate::foreign::type_first;
use crate::syntax_errors::ErrorContext;
use crate::token::Token;
use rpi_diag::{Fix, Span};

/// Recognises ports without a type or name: `node f (x) returns ...`, `node f (int) ...`, `node f(x) = x + 1;`.
pub(super) fn incomplete_port(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    use Token::{Comma, Ident, LParen, RParen, Semi};
    let at = found.error.index;
    let open = match found.token_at(at) {
        Some(RParen) => found.structure.partner(at),
        _ => found.structure.parent(at),
    };
    let in_header = open.is_some_and(|open| type_first::is_port_list(found, open));
    if !in_header || (0..at).any(|at| found.token_at(at) == Some(Token::Let)) {
        return None;
    }
    let ends = |at: usize| matches!(found.token_at(at), Some(RParen | Semi | Comma));
    let begins = |at: usize| {
        matches!(
            at.checked_sub(1).and_then(|at| found.token_at(at)),
            Some(LParen | Semi | Comma)
        )
    };
    if found.token_before() == Some(Ident)
        && found.expects(Token::Colon)
        && found.token_at(at) == Some(RParen)
    {
        return Some(untyped(found, at - 1));
    }
    let is_type = found.token_at(at) != Some(Ident) && type_first::type_of(found, at).is_some();
    if !is_type || !begins(at) || !ends(at + 1) || !found.expects(Ident) {
        return None;
    }
    let ty = found.source_text(at);
    let meant = format!("y: {ty}");
    let diagnostic = foreign_syntax("a port needs a name and a type")
        .primary(found.token_span(at), "this type has no port name")
        .fix(Fix::maybe(format!("write `{meant}`")).replace(found.token_span(at), meant));
    Some(ForeignSyntax {
        diagnostic,
        repair: Repair::RemoveErrorPhrase,
    })
}

/// Reports the port at token `at`, which has no type. The repair removes the whole declaration if it has the form of
/// another language, as in `node f(x) = x + 1;`, else only the port.
fn untyped(found: &ErrorContext<'_, '_>, at: usize) -> ForeignSyntax {
    let name = found.source_text(at);
    let is_equation =
        found.token_at(at + 2) == Some(Token::Eq) && found.token_at(at + 3) != Some(Token::LParen);
    let is_foreign = is_equation || found.token_at(at + 2) == Some(Token::LBrace);
    let diagnostic = foreign_syntax("every port needs a type")
        .primary(found.token_span(at), format!("`{name}` has no type"));
    match is_foreign {
        true => ForeignSyntax {
            diagnostic: diagnostic.help(format!(
                "`function f ({name}: real) returns (y: real) let y = {name} + 1.0; tel`"
            )),
            repair: Repair::RemoveItem,
        },
        false => ForeignSyntax {
            diagnostic: diagnostic.help(format!(
                "write the type after a colon, such as `{name}: real` or `{name}: int`"
            )),
            repair: Repair::RemoveErrorPhrase,
        },
    }
}

/// Recognises another token for `returns`: `node f (x: int) = (y: int)`, `node f (x: int): int`.
pub(super) fn returns_sign(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    use Token::{Arrow, Colon, Eq, LParen};
    let at = found.error.index;
    if !found.expects(Token::Returns) {
        return None;
    }
    let span = found.token_span(at);
    let diagnostic = foreign_syntax("the out-ports follow `returns`");
    match (found.token_at(at)?, found.token_at(at + 1)?) {
        (Eq, LParen) => {
            let diagnostic = diagnostic.primary(span, "equations belong into the body");
            Some(found.replace_word(diagnostic, at, Token::Returns))
        }
        (Colon | Arrow, _) if type_first::type_of(found, at + 1).is_some() => {
            let ty = type_first::type_of(found, at + 1)?;
            let meant = format!("returns (y: {})", ty.spelling().unwrap_or_default());
            let place = found.range_span(at..at + 2);
            Some(ForeignSyntax {
                diagnostic: diagnostic
                    .primary(place, "an out-port needs a name and a type")
                    .fix(
                        Fix::maybe(format!("write `{meant}`")).replace(place, format!(" {meant}")),
                    ),
                repair: Repair::RemoveItem,
            })
        }
        _ => None,
    }
}

/// Recognises ports without parentheses: `node f x: int returns ...`, `returns y: int`.
pub(super) fn bare_ports(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    use Token::{Colon, Con, Ident, LParen, Let, RParen, Returns, Semi, Var};
    let at = found.error.index;
    let is_port = found.token_at(at) == Some(Ident)
        && matches!(found.token_at(at + 1), Some(Colon | Token::Comma));
    let in_body = (0..at).any(|at| found.token_at(at) == Some(Let));
    let count = |token| {
        (0..at)
            .filter(|at| found.token_at(*at) == Some(token))
            .count()
    };
    let in_parentheses = count(LParen) > count(RParen);
    if !is_port || in_body || in_parentheses || !found.expects(LParen) || found.expects(Token::Plus)
    {
        return None;
    }
    let ends = |i: &usize| {
        matches!(
            found.token_at(*i),
            Some(Returns | Let | Var | Con | Token::Const) | None
        )
    };
    let mut end = (at..=found.lexemes.len()).find(ends)?;
    if found.token_at(end - 1) == Some(Semi) {
        end -= 1;
    }
    let is_closed = found.token_at(end - 1) == Some(RParen);
    let fix = Fix::sure("write `( )`").insert_before(found.token_span(at), "(");
    let (fix, mut tokens) = (fix, vec![found.insertion(at, LParen)]);
    let fix = match is_closed {
        true => fix,
        false => {
            tokens.push(found.insertion(end, RParen));
            fix.insert_after(found.token_span(end - 1), ")")
        }
    };
    let diagnostic = foreign_syntax("ports are written in parentheses")
        .primary(found.range_span(at..end), "expected `(`")
        .fix(fix);
    let repair = Repair::ReplaceTokens(tokens);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Recognises keywords for local variables: `sig z: int;`, `local z: int;`, `VAR_TEMP z: int;`.
pub(super) fn locals_keyword(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    const WORDS: [&str; 9] = [
        "sig",
        "local",
        "locals",
        "signal",
        "vars",
        "variables",
        "var_temp",
        "static",
        "register",
    ];
    let at = found.error.index;
    let word = found.source_text(at).to_ascii_lowercase();
    let is_section = found.token_at(at + 1) == Some(Token::Ident)
        && matches!(found.token_at(at + 2), Some(Token::Colon | Token::Comma));
    if !WORDS.contains(&&*word)
        || !is_section
        || !found.expects(Token::Let)
        || !found.expects(Token::Var)
    {
        return None;
    }
    let diagnostic = foreign_syntax("local flows are declared after `var`")
        .primary(found.token_span(at), "keyword of another language");
    Some(found.replace_word(diagnostic, at, Token::Var))
}

/// Recognises a closing keyword of another language after local variables: `var x: int; end_var let ...`.
pub(super) fn locals_closing_keyword(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let fault = found.error.index;
    let mut places = [fault, fault.saturating_sub(1)].into_iter();
    let at = places.find(|at| {
        let word = found.source_text(*at).to_ascii_lowercase();
        matches!(&*word, "end_var" | "endvar" | "end")
            && *at > 0
            && found.token_at(at - 1) == Some(Token::Semi)
    })?;
    let is_there =
        found.token_at(at + 1) == Some(Token::Let) || found.token_at(at + 1) == Some(Token::Semi);
    if !is_there || (0..at).any(|at| found.token_at(at) == Some(Token::Let)) {
        return None;
    }
    let end = at + 1 + usize::from(found.token_at(at + 1) == Some(Token::Semi));
    let place = found.range_span(at..end);
    let diagnostic = foreign_syntax("`let` ends the local declarations")
        .primary(place, "local declarations have no closing keyword")
        .fix(Fix::sure(format!("delete `{}`", found.source_text(at))).replace(place, ""));
    Some(ForeignSyntax {
        diagnostic,
        repair: Repair::ReplaceTokens(vec![(at..end, Vec::new())]),
    })
}

/// Recognises the redundant `rec` of `let rec x = ...`.
pub(super) fn let_rec(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let fault = found.error.index;
    let mut places = [fault, fault.saturating_sub(1)].into_iter();
    let at = places.find(|at| {
        found.source_text(*at) == "rec" && *at > 0 && found.token_at(at - 1) == Some(Token::Let)
    })?;
    if found.token_at(at + 1) != Some(Token::Ident) {
        return None;
    }
    let place = span_with_leading_space(found, at);
    let diagnostic = foreign_syntax("equations may refer to one another without `rec`")
        .primary(found.token_span(at), "keyword of another language")
        .fix(Fix::sure("delete `rec`").replace(place, ""));
    Some(ForeignSyntax {
        diagnostic,
        repair: Repair::ReplaceTokens(vec![(at..at + 1, Vec::new())]),
    })
}

/// Returns the span of token `at` including the white space before it.
fn span_with_leading_space(found: &ErrorContext<'_, '_>, at: usize) -> Span {
    found
        .cx
        .span(found.lexemes[at - 1].end, found.lexemes[at].end)
}

/// Recognises a function header of MATLAB: `function y = f(x)`.
pub(super) fn matlab_header(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    use Token::{Eq, Function, Ident, LParen, Node};
    let shape = [1, 2, 3, 4].map(|at| found.token_at(at));
    let is_head = matches!(found.token_at(0), Some(Function | Node));
    if !is_head
        || shape != [Some(Ident), Some(Eq), Some(Ident), Some(LParen)]
        || found.error.index != 4
    {
        return None;
    }
    let (result, name) = (found.source_text(1), found.source_text(3));
    let last = found.lexemes.len();
    found
        .cx
        .suppress_foreign_operators(found.range_span(0..last));
    let diagnostic =
        foreign_syntax("the name is written before the ports, and the out-ports follow `returns`")
            .primary(
                found.range_span(0..4),
                "header in the syntax of another language",
            )
            .help(format!(
                "`{} {name} (x: real) returns ({result}: real) let {result} = 2.0 * x; tel`",
                found.source_text(0)
            ));
    Some(ForeignSyntax {
        diagnostic,
        repair: Repair::RemoveItem,
    })
}
