//! Printing of the blocks of equations of Kind 2: `if`, `when`, `cond` and `frame`.

use super::Printer;
use super::body;
use super::expr;
use super::layout::{Doc, concat, indent, word};
use super::ty::names;
use crate::ast::*;

pub(super) fn print_choice(printer: &Printer<'_>, choice: &Choice) -> Doc {
    let mut parts = Vec::new();
    if choice.word == ChoiceWord::Cond {
        parts.push(word("cond"));
    }
    for (i, branch) in choice.branches.iter().enumerate() {
        let (head, close) = choice.word.head(i == 0);
        if i > 0 || choice.word == ChoiceWord::Cond {
            parts.push(Doc::Hard);
        }
        parts.extend([
            word(head),
            expr::print_expr(printer, &branch.condition),
            word(close),
        ]);
        parts.push(indented(printer, &branch.statements));
    }
    if let Some(otherwise) = &choice.otherwise {
        let head = match choice.word {
            ChoiceWord::Cond => "otherwise:",
            _ => "else",
        };
        parts.extend([Doc::Hard, word(head), indented(printer, otherwise)]);
    }
    parts.extend([Doc::Hard, word(choice.word.closes())]);
    concat(parts)
}

pub(super) fn print_keep(printer: &Printer<'_>, keep: &Keep) -> Doc {
    let head = word("frame (");
    let names = super::layout::text(names(&keep.names));
    let initial = indented(printer, &keep.initial);
    let body = body::print_statements(printer, &keep.statements);
    let body = super::body::block("let", body, "tel");
    concat([head, names, word(")"), initial, Doc::Hard, body])
}

fn indented(printer: &Printer<'_>, statements: &[Statement]) -> Doc {
    let lines = body::print_statements(printer, statements);
    match lines.is_nothing() {
        true => lines,
        false => indent(concat([Doc::Hard, lines])),
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
