//! Statements of other languages, recognised by their first word, with their RPI counterparts.

use super::imperative::{self, block_end};
use super::{ForeignSyntax, Repair, foreign_syntax};
use crate::foreign::statement_kinds;
use crate::foreign::statement_kinds::Extent;
use crate::foreign::statement_kinds::StatementKind;
use crate::syntax_errors::ErrorContext;
use crate::token::Token;
use rpi_diag::{Diagnostic, Fix};
use std::ops::Range;

/// Recognises a statement of another language from the table of such statements: `while (c) { ... }`, `wait for c;`,
/// `emit s;`.
pub(super) fn statement(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = statement_start(found)?;
    let kind = statement_kinds::kind_of(found.source_text(at))?;
    // In a task, `start` is an RPI step.
    if found.in_task() && found.token_at(at) == Some(Token::Start) {
        return None;
    }
    if kind.extent == Extent::Phrase && ends_line(found, at) {
        let repair = Repair::ReplaceTokens(vec![(at..at + 1, Vec::new())]);
        let diagnostic = diagnostic(found, kind, at);
        return Some(ForeignSyntax { diagnostic, repair });
    }
    let end = statement_end(found, kind.extent, at);
    found
        .cx
        .suppress_foreign_operators(found.range_span(at..end));
    let diagnostic = match choice_equation(found, kind, at..end) {
        Some(meant) => foreign_syntax(kind.message)
            .primary(found.token_span(at), kind.label)
            .help("each flow has one equation, with a value for every case")
            .fix(
                Fix::maybe(format!("write `{meant}`"))
                    .replace(found.range_span(at..end), meant.clone()),
            ),
        None => diagnostic(found, kind, at),
    };
    Some(ForeignSyntax {
        diagnostic,
        repair: Repair::RemovePhrase(at..end, defined_names(found, at, end)),
    })
}

fn diagnostic(found: &ErrorContext<'_, '_>, kind: &StatementKind, at: usize) -> Diagnostic {
    let (label, help) = match found.in_task() {
        true => ("keyword of another language", kind.step_help),
        false => (kind.label, kind.help),
    };
    foreign_syntax(kind.message)
        .primary(found.token_span(at), label)
        .help(help)
}

/// Returns the equation that replaces a choice among values with one equation of the same flow in each case:
/// `y = if x = 0 then 1 else 2;` for `switch (x) { case 0: y = 1; break; default: y = 2; }`.
fn choice_equation(
    found: &ErrorContext<'_, '_>,
    kind: &StatementKind,
    range: Range<usize>,
) -> Option<String> {
    use Token::{Colon, Eq, Ident, Int, LParen, Semi};
    if !kind.is_choice() || found.in_task() {
        return None;
    }
    let subject = range.start + 1 + usize::from(found.token_at(range.start + 1) == Some(LParen));
    if found.token_at(subject) != Some(Ident) {
        return None;
    }
    let is_default = |at: usize| {
        let word = found.source_text(at);
        ["else", "default", "otherwise"]
            .iter()
            .any(|other| word.eq_ignore_ascii_case(other))
    };
    let (mut cases, mut target, mut other) = (String::new(), None, None);
    for sign in range.clone().filter(|at| found.token_at(*at) == Some(Eq)) {
        let name = sign - 1;
        let semi = (sign..range.end).find(|at| found.token_at(*at) == Some(Semi))?;
        let value = found.range_text(sign + 1..semi);
        let label = name.checked_sub(if found.token_at(name - 1) == Some(Colon) {
            2
        } else {
            1
        })?;
        let text = found.source_text(name);
        if found.token_at(name) != Some(Ident) || *target.get_or_insert(text) != text {
            return None;
        }
        match found.token_at(label)? {
            _ if is_default(label) => other = Some(value),
            Ident | Int if label + 2 == name && other.is_none() => cases.push_str(&format!(
                "if {} = {} then {value} else ",
                found.source_text(subject),
                found.source_text(label)
            )),
            _ => return None,
        }
    }
    let (target, other) = (target?, other?);
    (!cases.is_empty()).then(|| format!("{target} = {cases}{other};"))
}

/// Returns the token index of the first word of the statement with the error; `None` if no statement of another
/// language begins with it.
fn statement_start(found: &ErrorContext<'_, '_>) -> Option<usize> {
    use Token::{Colon, Comma, Dot, End, Eq, Let, Semi, Tel};
    let fault = found.error.index;
    let places = [
        found.structure.phrase(fault).start,
        fault,
        fault.saturating_sub(1),
    ];
    let is_first = |at: &usize| {
        let before = at.checked_sub(1).and_then(|at| found.token_at(at));
        let is_head = matches!(before, Some(Let | Semi | Tel | End));
        let is_reserved = found
            .token_at(*at)
            .and_then(Token::keyword)
            .is_some_and(|word| word.is_reserved_in(found.cx.dialect));
        let is_target = matches!(found.token_at(at + 1), Some(Eq | Dot | Comma));
        let is_repeat = found.in_task() && found.token_at(*at) == Some(Token::Repeat);
        let is_label = found.token_at(at + 1) == Some(Colon) && found.in_task();
        is_head && !is_repeat && !is_reserved && !is_target && !is_label && *at <= fault
    };
    let is_kind = |at: &usize| {
        let is_call = matches!(found.token_at(at + 1), Some(Token::LParen | Token::LStatic));
        statement_kinds::kind_of(found.source_text(*at))
            .is_some_and(|kind| !is_call || kind.extent != Extent::Phrase)
    };
    places.into_iter().find(|at| is_first(at) && is_kind(at))
}

/// Returns whether token `at` is the last one on its line, as at the end of a statement without `;`.
fn ends_line(found: &ErrorContext<'_, '_>, at: usize) -> bool {
    let (Some(this), Some(next)) = (found.lexemes.get(at), found.lexemes.get(at + 1)) else {
        return false;
    };
    found.cx.slice(this.end, next.start).contains('\n')
}

/// Returns the index one past the last token of a foreign statement that begins at token `at` and ends by the rule
/// `reach`.
pub(super) fn statement_end(found: &ErrorContext<'_, '_>, reach: Extent, at: usize) -> usize {
    let phrase = || {
        let end = found.structure.phrase(at).end.max(at + 1);
        end + usize::from(found.token_at(end) == Some(Token::Semi))
    };
    match reach {
        Extent::Phrase => phrase(),
        Extent::Block => nested_block_end(found, at),
        Extent::Returns => {
            let close = found
                .structure
                .parent(at)
                .and_then(|open| found.structure.partner(open));
            let close = close.unwrap_or(found.lexemes.len());
            let returns = (at..close).find(|at| found.token_at(*at) == Some(Token::Returns));
            let semi = returns
                .and_then(|at| (at..close).find(|at| found.token_at(*at) == Some(Token::Semi)));
            semi.map_or_else(|| nested_block_end(found, at), |semi| semi + 1)
        }
    }
}

/// Returns the index one past the last token of a statement with blocks that begins at token `at`. A block ends with
/// its braces, its `let ... tel` or its closing keyword.
pub(crate) fn nested_block_end(found: &ErrorContext<'_, '_>, at: usize) -> usize {
    let (mut i, mut has_block) = (at, false);
    loop {
        match found.token_at(i) {
            None | Some(Token::Tel) => return i.max(at + 1),
            Some(Token::Semi) if has_block => return i + 1,
            Some(Token::Semi) => return block_end(found, at),
            Some(Token::LBrace | Token::Let) => {
                let Some(close) = found.structure.partner(i) else {
                    return block_end(found, at);
                };
                (i, has_block) = (close + 1, true);
                if !continues_statement(found, i) {
                    return i + usize::from(found.token_at(i) == Some(Token::Semi));
                }
            }
            Some(Token::LParen | Token::LBracket) => {
                i = found
                    .structure
                    .partner(i)
                    .filter(|close| *close > i)
                    .unwrap_or(i)
                    + 1;
            }
            Some(_) => i += 1,
        }
    }
}

/// Returns whether token `at`, such as `else`, continues a statement after one of its blocks.
fn continues_statement(found: &ErrorContext<'_, '_>, at: usize) -> bool {
    let words = [
        "else", "elsif", "elif", "catch", "except", "finally", "while", "until", "case", "default",
        "times",
    ];
    words
        .iter()
        .any(|word| found.source_text(at).eq_ignore_ascii_case(word))
}

/// Returns the names that the statement at the tokens `at..end` seems to define.
fn defined_names(found: &ErrorContext<'_, '_>, at: usize, end: usize) -> Vec<crate::ast::Ident> {
    let mut names = imperative::defined_names(found, at..end);
    // `reset n = ...` defines the name after its keyword.
    if [found.token_at(at + 1), found.token_at(at + 2)] == [Some(Token::Ident), Some(Token::Eq)] {
        names.push(found.ident(at + 1));
    }
    names
}

impl ErrorContext<'_, '_> {
    /// Returns whether the syntax error is in the declaration of a task.
    pub(super) fn in_task(&self) -> bool {
        self.token_at(0) == Some(Token::Task)
    }
}
