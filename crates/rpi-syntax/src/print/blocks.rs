//! Printing of the blocks of equations of Kind 2: `if`, `when`, `cond` and `frame`.

use super::Printer;
use super::layout::{Doc, concat, indent, word};
use super::ty::names;
use crate::ast::*;

impl Printer<'_> {
    pub(super) fn choice(&mut self, choice: &Choice) -> Doc {
        let mut parts = Vec::new();
        if choice.word == ChoiceWord::Cond {
            parts.push(word("cond"));
        }
        for (i, branch) in choice.branches.iter().enumerate() {
            let (head, close) = choice.word.head(i == 0);
            if i > 0 || choice.word == ChoiceWord::Cond {
                parts.push(Doc::Hard);
            }
            parts.extend([word(head), self.expr(&branch.condition), word(close)]);
            parts.push(self.indented(&branch.statements));
        }
        if let Some(otherwise) = &choice.otherwise {
            let head = match choice.word {
                ChoiceWord::Cond => "otherwise:",
                _ => "else",
            };
            parts.extend([Doc::Hard, word(head), self.indented(otherwise)]);
        }
        parts.extend([Doc::Hard, word(choice.word.closes())]);
        concat(parts)
    }

    pub(super) fn keep(&mut self, keep: &Keep) -> Doc {
        let head = word("frame (");
        let names = super::layout::text(names(&keep.names));
        let initial = self.indented(&keep.initial);
        let body = self.statements(&keep.statements);
        let body = super::body::block("let", body, "tel");
        concat([head, names, word(")"), initial, Doc::Hard, body])
    }

    fn indented(&mut self, statements: &[Statement]) -> Doc {
        let lines = self.statements(statements);
        match lines.is_nothing() {
            true => lines,
            false => indent(concat([Doc::Hard, lines])),
        }
    }
}

impl ChoiceWord {
    /// Returns the keyword that begins the block, with a space.
    pub(crate) fn opens(self) -> &'static str {
        match self {
            ChoiceWord::If => "if ",
            ChoiceWord::When => "when ",
            ChoiceWord::Cond => "cond ",
        }
    }

    /// Returns the text before and after the condition of a branch.
    fn head(self, is_first: bool) -> (&'static str, &'static str) {
        match (self, is_first) {
            (ChoiceWord::Cond, _) => ("| ", ":"),
            (_, true) => (self.opens(), " then"),
            (_, false) => ("elsif ", " then"),
        }
    }

    /// Returns the keyword that closes the block.
    fn closes(self) -> &'static str {
        match self {
            ChoiceWord::If => "fi",
            ChoiceWord::When | ChoiceWord::Cond => "end",
        }
    }
}
