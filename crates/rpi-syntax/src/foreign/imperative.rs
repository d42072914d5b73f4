//! Imperative statements of other languages in place of equations.

use super::{ForeignSyntax, Repair, foreign_syntax};
use crate::ast::Ident;
use crate::guessed_declarations;
use crate::syntax_errors::ErrorContext;
use crate::token::Token;
use rpi_diag::{Code, Diagnostic, Fix, Span};
use std::ops::Range;

/// Recognises a doubled `;` after a declaration: `use motion;;`.
pub(super) fn doubled_semi(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    let is_second = [found.token_before(), found.token_at(at)] == [Some(Token::Semi); 2];
    // If the grammar expects anything here, the second `;` may mark a missing element.
    if !is_second || !found.error.expected.is_empty() {
        return None;
    }
    let span = found.token_span(at);
    let diagnostic = Diagnostic::new(Code::RPI0001, "unexpected second `;`")
        .primary(span, "the declaration has already ended")
        .fix(Fix::sure("delete `;`").replace(span, ""));
    let repair = Repair::ReplaceTokens(vec![(at..at + 1, Vec::new())]);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Recognises a declaration keyword before an equation: `let z = x;`, `var z = x;`.
pub(super) fn declaration_keyword(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    let word = matches!(
        found.token_at(at),
        Some(Token::Let | Token::Var | Token::Const)
    );
    // Skips `mut` of Rust: `let mut x = ...`.
    let name = at + 1 + usize::from(found.source_text(at + 1) == "mut");
    let equation =
        found.token_at(name) == Some(Token::Ident) && found.token_at(name + 1) == Some(Token::Eq);
    if !found.expects_equation() || !word || !equation {
        return None;
    }
    let written = found.range_text(at..name);
    let place = found
        .cx
        .span(found.lexemes[at].start, found.lexemes[name].start);
    let diagnostic = foreign_syntax(format!("an equation needs no `{written}`"))
        .primary(found.token_span(at), "the equation declares the flow")
        .fix(Fix::sure(format!("delete `{written}`")).replace(place, ""));
    let repair = Repair::ReplaceTokens(vec![(at..name, Vec::new())]);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Recognises a declaration of locals after `let`: `var z: int;`.
pub(super) fn declaration_after_let(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    let typed = matches!(found.token_at(at + 2), Some(Token::Colon | Token::Comma));
    if !found.expects_equation() || found.token_at(at) != Some(Token::Var) || !typed {
        return None;
    }
    let end = found.structure.phrase(at).end;
    let diagnostic = foreign_syntax("locals are declared before `let`")
        .primary(found.token_span(at), "declaration among the equations")
        .help("move it between the ports and `let`; in `.rpi` files it is optional: an equation declares its flow");
    let repair = Repair::ReplaceTokens(vec![(at..(end + 1).min(found.lexemes.len()), Vec::new())]);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Recognises compound assignments: `n += 1;` and `n++;`.
pub(super) fn compound_assignment(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    use Token::{Eq, Minus, Plus, Slash, Star};
    let at = found.error.index;
    let op = found
        .token_at(at)
        .filter(|op| matches!(op, Plus | Minus | Star | Slash))?;
    let next = found.token_at(at + 1)?;
    if found.token_before() != Some(Token::Ident)
        || !found.expects(Eq)
        || !(next == Eq || next == op)
    {
        return None;
    }
    let phrase = found.structure.phrase(at);
    let name = found.source_text(at - 1).to_owned();
    let by = match next == Eq && at + 2 < phrase.end {
        true => found.range_text(at + 2..phrase.end).to_owned(),
        false => "1".to_owned(),
    };
    let zero = if by.contains(['.', '[']) { "0.0" } else { "0" };
    let sign = op.spelling().unwrap_or_default();
    let meant = format!("{name} = {zero} -> pre {name} {sign} {by}");
    let others = found.lexemes.windows(2).enumerate();
    let is_other = |(i, pair): (usize, &[crate::lexer::Lexeme])| {
        i + 1 != at && pair[1].token == Eq && found.source_text(i) == name
    };
    let diagnostic =
        foreign_syntax("a flow is defined by one equation, which holds in every cycle")
            .primary(
                found.range_span(at..at + 2),
                format!("assigns to `{name}` like a variable"),
            )
            .help(format!(
                "its value in the previous cycle is `pre {name}`: `{meant}`"
            ));
    let diagnostic = match others.into_iter().any(is_other) {
        true => diagnostic,
        false => {
            let place = found.range_span(at - 1..phrase.end);
            diagnostic.fix(Fix::maybe(format!("write `{meant}`")).replace(place, meant))
        }
    };
    let names = vec![found.ident(at - 1)];
    Some(ForeignSyntax {
        diagnostic,
        repair: Repair::RemovePhrase(at - 1..phrase.end, names),
    })
}

/// Recognises a return statement: `return x;`.
pub(super) fn return_statement(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index.checked_sub(1)?;
    if found.source_text(at) != "return" || found.token_at(at) != Some(Token::Ident) {
        return None;
    }
    let outputs = outputs(found);
    let span = found.token_span(at);
    let diagnostic = foreign_syntax("an out-port is defined by an equation")
        .primary(span, "there is no `return`: all equations hold at once");
    let phrase = found.structure.phrase(at);
    let value = found.token_at(at + 2) == Some(Token::Semi);
    let diagnostic = match &outputs[..] {
        [one] if value && found.source_text(at + 1) == &*one.name => {
            let place = found.range_span(at..at + 3);
            diagnostic.fix(Fix::sure("delete it").replace(place, ""))
        }
        [one] => {
            let meant = format!("{} =", one.name);
            diagnostic.fix(Fix::sure(format!("write `{meant}`")).replace(span, meant))
        }
        _ => diagnostic.help("write an equation for each out-port: `y = ...;`"),
    };
    Some(ForeignSyntax {
        diagnostic,
        repair: Repair::RemovePhrase(at..phrase.end.max(at + 1), outputs),
    })
}

/// Returns the names of the out-ports in the header of the declaration; empty if they cannot be read.
fn outputs(found: &ErrorContext<'_, '_>) -> Vec<Ident> {
    let Some(word) = (0..found.error.index).find(|at| found.token_at(*at) == Some(Token::Returns))
    else {
        return Vec::new();
    };
    let Some(close) = found.structure.partner(word + 1) else {
        return Vec::new();
    };
    let is_name = |at: &usize| {
        let next = found.token_at(at + 1);
        let before = found.token_at(at - 1);
        found.token_at(*at) == Some(Token::Ident)
            && matches!(next, Some(Token::Colon | Token::Comma))
            && matches!(before, Some(Token::LParen | Token::Comma | Token::Semi))
    };
    (word + 2..close)
        .filter(is_name)
        .map(|at| found.ident(at))
        .collect()
}

/// Recognises results and fragments without a name, or with `if` for `when`: `finish when c`, `fragment when c`.
pub(super) fn unnamed_result(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    use Token::{Fail, Finish, Fragment, Ident, If, Let, When, Yield};
    let at = found.error.index;
    let before = found.token_before()?;
    let here = found.token_at(at)?;
    let second = at.checked_sub(2).and_then(|at| found.token_at(at));
    match (before, here) {
        (Ident, If) if matches!(second, Some(Finish | Yield | Fail)) => {
            let span = found.token_span(at);
            let diagnostic = foreign_syntax("the condition of a result follows `when`")
                .primary(span, "expected `when`")
                .fix(Fix::sure("write `when`").replace(span, "when"));
            let repair = Repair::ReplaceTokens(vec![found.replacement(at, &[When])]);
            Some(ForeignSyntax { diagnostic, repair })
        }
        (Finish | Yield | Fail, When | If) => {
            let word = found.source_text(at - 1);
            let diagnostic = missing_name(found, &format!("this `{word}` has no result name"));
            let diagnostic = diagnostic.help(format!(
                "tasks and successors branch on results by name: `{word} done when ...`"
            ));
            Some(ForeignSyntax {
                diagnostic,
                repair: Repair::RemoveErrorPhrase,
            })
        }
        (Fragment, When | Let) => {
            let diagnostic = missing_name(found, "this fragment has no name")
                .help("its flows are read through its name: `fragment Slow when c let y = ...; tel`, then `Slow.y`");
            let phrase = found.structure.phrase(at);
            let names =
                guessed_declarations::inner_targets(found.cx, &found.lexemes[phrase.clone()]);
            let names = names.collect();
            Some(ForeignSyntax {
                diagnostic,
                repair: Repair::RemovePhrase(phrase, names),
            })
        }
        _ => None,
    }
}

fn missing_name(found: &ErrorContext<'_, '_>, message: &str) -> Diagnostic {
    Diagnostic::new(Code::RPI0001, message).primary(
        found.token_span(found.error.index),
        "expected a name before this",
    )
}

/// Returns the index one past the last token of a foreign block that begins at token `at`: after its `end` or closing
/// brace, or at the enclosing `tel`.
pub(super) fn block_end(found: &ErrorContext<'_, '_>, at: usize) -> usize {
    let mut i = at;
    while let Some(token) = found.token_at(i) {
        let closes = matches!(
            &*found.source_text(i).to_ascii_lowercase(),
            "end"
                | "endif"
                | "endfor"
                | "end_if"
                | "end_for"
                | "end_while"
                | "end_case"
                | "endcase"
                | "endswitch"
                | "done"
                | "endwhile"
                | "end_repeat"
                | "end_loop"
                | "endloop"
                | "endparfor"
                | "wend"
                | "next"
                | "od"
        );
        let next = i + 1;
        let ends_braces = token == Token::RBrace && found.token_at(next) != Some(Token::Else);
        if token == Token::Tel {
            return i.max(at + 1);
        }
        if closes || ends_braces {
            return next + usize::from(found.token_at(next) == Some(Token::Semi));
        }
        i = next;
    }
    found.lexemes.len()
}

/// Returns the names that equations in the range of tokens seem to define, each name once.
pub(super) fn defined_names(found: &ErrorContext<'_, '_>, range: Range<usize>) -> Vec<Ident> {
    use Token::{Colon, Else, Eq, Ident as Word, LBrace, Let, RParen, Semi, Then};
    let begins = |at: usize| {
        let words = ["do", "then", "else"];
        matches!(
            found.token_at(at),
            Some(Then | Else | Semi | LBrace | Let | Colon | RParen)
        ) || words
            .iter()
            .any(|word| found.source_text(at).eq_ignore_ascii_case(word))
    };
    let begins_line = |at: usize| {
        let gap = found
            .cx
            .slice(found.lexemes[at - 1].end, found.lexemes[at].start);
        gap.contains('\n')
    };
    let is_target = |at: &usize| {
        let is_equation = found.token_at(*at) == Some(Word) && found.token_at(at + 1) == Some(Eq);
        is_equation && (begins(at - 1) || begins_line(*at))
    };
    let names = range.skip(1).filter(is_target);
    let mut names: Vec<Ident> = names.map(|at| found.ident(at)).collect();
    let mut seen = std::collections::BTreeSet::new();
    names.retain(|ident| seen.insert(ident.name.clone()));
    names
}

/// Returns the empty span at the end of `span`, for labels and insertions after it.
pub(super) fn end_of_span(span: Span) -> Span {
    Span {
        start: span.end,
        ..span
    }
}

impl ErrorContext<'_, '_> {
    /// Returns the token at index `at` as an identifier.
    pub(super) fn ident(&self, at: usize) -> Ident {
        let lexeme = self.lexemes[at];
        self.cx.ident(lexeme.start, lexeme.end)
    }
}
