//! Constructs of Kind 2 that a control core cannot execute and the grammar does not accept.
//!
//! A specific message keeps users from looking for a typing error. The type checker reports the constructs of Kind 2
//! that parse but cannot be executed.

use super::{ForeignSyntax, Repair};
use crate::Dialect;
use crate::ast::Ident;
use crate::syntax_errors::ErrorContext;
use crate::token::Token;
use rpi_diag::{Code, Diagnostic, Span, Subject};
use std::ops::Range;

/// Recognises set and map literals of Kind 2, which RPI does not support: `{1, 2}`, `map[]@<int, bool>`.
pub(super) fn set_or_map(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index.checked_sub(1)?;
    let is_map = at > 0 && found.source_text(at - 1) == "map";
    let (first, name) = match (found.token_at(at)?, found.token_at(at + 1)) {
        (Token::LBrace, _) if found.expects(Token::RBrace) => (at, "set"),
        (Token::LBracket, Some(Token::RBracket)) if is_map => (at - 1, "map"),
        _ => return None,
    };
    let last = found.structure.partner(at).unwrap_or(at);
    let construct = format!("a {name}");
    let mut syntax = remove_phrase(found, &construct, found.range_span(first..last + 1))?;
    syntax.diagnostic = syntax.diagnostic.about(Subject::Construct(construct));
    syntax.diagnostic.help = vec![
        "store the elements in an array of a fixed size, such as `int^8`, with the number of used elements; or leave the node to a model checker such as Kind 2".to_owned(),
    ];
    Some(syntax)
}

/// Recognises a reachability query of Kind 2, which RPI does not support: `check reachable x > 3`.
pub(super) fn reachability_query(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index.checked_sub(1)?;
    let follows_check = at > 0 && found.source_text(at - 1) == "check";
    if !follows_check || found.source_text(at) != "reachable" {
        return None;
    }
    remove_phrase(found, "a reachability query", found.token_span(at))
}

/// Recognises a recursive function of Kind 2, which RPI does not support: `function rec f (n: int)`.
pub(super) fn recursive_function(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index.checked_sub(1)?;
    let follows = at > 0 && matches!(found.token_at(at - 1), Some(Token::Function | Token::Node));
    if !follows || found.source_text(at) != "rec" {
        return None;
    }
    let diagnostic = unsupported(found, "a recursive function", found.token_span(at))?
        .help("compute across cycles: `n = 0 -> pre n + 1`; or over the elements of an array: `fold`, `red`");
    Some(ForeignSyntax {
        diagnostic,
        repair: Repair::RemoveErrorPhrase,
    })
}

/// Reports an unsupported construct of Kind 2 at `span`. The repair removes the statement that contains the syntax
/// error. `None` unless the file is a Lustre file.
fn remove_phrase(
    found: &ErrorContext<'_, '_>,
    construct: &str,
    span: Span,
) -> Option<ForeignSyntax> {
    let diagnostic = unsupported(found, construct, span)?;
    let phrase = found.structure.phrase(found.error.index);
    let names = defined_names(found, phrase.clone());
    Some(ForeignSyntax {
        diagnostic,
        repair: Repair::RemovePhrase(phrase, names),
    })
}

/// Returns the names at the start of a range of tokens, such as the left side of an equation.
fn defined_names(found: &ErrorContext<'_, '_>, phrase: Range<usize>) -> Vec<Ident> {
    let is_head = |at: &usize| {
        matches!(
            found.token_at(*at),
            Some(Token::Ident | Token::Comma | Token::LParen | Token::RParen)
        )
    };
    let head: Vec<usize> = phrase.take_while(is_head).collect();
    let is_name = |at: &&usize| found.token_at(**at) == Some(Token::Ident);
    head.iter()
        .filter(is_name)
        .map(|at| found.ident(*at))
        .collect()
}

/// Creates the diagnostic of an unsupported construct of Kind 2 at `span`; `None` unless the file is a Lustre file.
fn unsupported(found: &ErrorContext<'_, '_>, construct: &str, span: Span) -> Option<Diagnostic> {
    let diagnostic = Diagnostic::new(
        Code::RPI0001,
        format!("{construct} of Kind 2 cannot be executed"),
    );
    (found.cx.dialect == Dialect::Lustre).then(|| {
        diagnostic
            .primary(span, "not supported")
            .help("delete it here, and keep it in the file that Kind 2 checks")
    })
}
