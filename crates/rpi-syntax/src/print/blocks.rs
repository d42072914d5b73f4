//! Blocks of equations: `if`, `when`, `cond` and `frame` of Kind 2.

use super::Printer;
use super::layout::{Doc, concat, indent, word};
use super::ty::names;
use crate::ast::*;
use rpi_diag::Span;

impl Printer<'_> {
    pub(super) fn choice(&mut self, choice: &Choice, span: Span) -> Doc {
        let mut parts = Vec::new();
        if choice.word == ChoiceWord::Cond {
            parts.push(word("cond"));
        }
        for (i, branch) in choice.branches.iter().enumerate() {
            let (head, close) = choice.word.head(i == 0);
            let end = choice.end_of(i, span);
            if i > 0 || choice.word == ChoiceWord::Cond {
                parts.push(Doc::Hard);
            }
            parts.extend([word(head), self.expr(&branch.condition), word(close)]);
            parts.push(self.indented(&branch.statements, end));
        }
        if let Some(otherwise) = &choice.otherwise {
            let head = match choice.word {
                ChoiceWord::Cond => "otherwise:",
                _ => "else",
            };
            parts.extend([Doc::Hard, word(head), self.indented(otherwise, span.end)]);
        }
        parts.extend([Doc::Hard, word(choice.word.closes())]);
        concat(parts)
    }

    pub(super) fn keep(&mut self, keep: &Keep, span: Span) -> Doc {
        let head = word("frame (");
        let names = super::layout::text(names(&keep.names));
        let first = keep
            .statements
            .first()
            .map_or(span.end, |first| first.span.start);
        let initial = self.indented(&keep.initial, first);
        let body = self.statements(&keep.statements, span.end);
        let body = super::body::block("let", body, "tel");
        concat([head, names, word(")"), initial, Doc::Hard, body])
    }

    fn indented(&mut self, statements: &[Statement], end: u32) -> Doc {
        let lines = self.statements(statements, end);
        match lines.is_nothing() {
            true => lines,
            false => indent(concat([Doc::Hard, lines])),
        }
    }
}

impl Choice {
    /// Where the text of a branch ends.
    fn end_of(&self, branch: usize, whole: Span) -> u32 {
        let next = self.branches.get(branch + 1);
        let otherwise = self.otherwise.iter().flatten().next();
        let next = next.map(|next| next.condition.span.start);
        let next = next.or_else(|| otherwise.map(|first| first.span.start));
        next.unwrap_or(whole.end)
    }
}

impl ChoiceWord {
    /// The word that begins it.
    pub(crate) fn opens(self) -> &'static str {
        match self {
            ChoiceWord::If => "if ",
            ChoiceWord::When => "when ",
            ChoiceWord::Cond => "cond ",
        }
    }

    /// What stands around the condition of a branch.
    fn head(self, is_first: bool) -> (&'static str, &'static str) {
        match (self, is_first) {
            (ChoiceWord::Cond, _) => ("| ", ":"),
            (_, true) => (self.opens(), " then"),
            (_, false) => ("elsif ", " then"),
        }
    }

    fn closes(self) -> &'static str {
        match self {
            ChoiceWord::If => "fi",
            ChoiceWord::When | ChoiceWord::Cond => "end",
        }
    }
}
