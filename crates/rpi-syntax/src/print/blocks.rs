//! Printing of the blocks of equations of Kind 2: `if`, `when`, `cond` and `frame`.

use super::Printer;
use super::body;
use super::expr;
use super::layout::{Doc, concat, indent, word};
use super::ty::names;
use crate::ast::*;

pub(super) fn print_choice(printer: &Printer<'_>, choice: &ConditionalBlock) -> Doc {
    let mut parts = Vec::new();
    if choice.keyword == ConditionalKeyword::Cond {
        parts.push(word("cond"));
    }
    for (i, branch) in choice.branches.iter().enumerate() {
        let (head, close) = choice.keyword.branch_delimiters(i == 0);
        if i > 0 || choice.keyword == ConditionalKeyword::Cond {
            parts.push(Doc::HardLine);
        }
        parts.extend([
            word(head),
            expr::print_expr(printer, &branch.condition),
            word(close),
        ]);
        parts.push(indented(printer, &branch.statements));
    }
    if let Some(otherwise) = &choice.else_statements {
        let head = match choice.keyword {
            ConditionalKeyword::Cond => "otherwise:",
            _ => "else",
        };
        parts.extend([Doc::HardLine, word(head), indented(printer, otherwise)]);
    }
    parts.extend([Doc::HardLine, word(choice.keyword.close_keyword())]);
    concat(parts)
}

pub(super) fn print_keep(printer: &Printer<'_>, keep: &FrameBlock) -> Doc {
    let head = word("frame (");
    let names = super::layout::text(names(&keep.names));
    let initial = indented(printer, &keep.initial);
    let body = body::print_statements(printer, &keep.statements);
    let body = super::body::block("let", body, "tel");
    concat([head, names, word(")"), initial, Doc::HardLine, body])
}

fn indented(printer: &Printer<'_>, statements: &[Statement]) -> Doc {
    let lines = body::print_statements(printer, statements);
    match lines.is_empty() {
        true => lines,
        false => indent(concat([Doc::HardLine, lines])),
    }
}

impl ConditionalKeyword {
    /// Returns the keyword that begins the block, followed by a space.
    pub(crate) fn open_keyword(self) -> &'static str {
        match self {
            ConditionalKeyword::If => "if ",
            ConditionalKeyword::When => "when ",
            ConditionalKeyword::Cond => "cond ",
        }
    }

    /// Returns the texts before and after the condition of a branch, such as `elsif ` and ` then`. `is_first` is true
    /// for the first branch.
    fn branch_delimiters(self, is_first: bool) -> (&'static str, &'static str) {
        match (self, is_first) {
            (ConditionalKeyword::Cond, _) => ("| ", ":"),
            (_, true) => (self.open_keyword(), " then"),
            (_, false) => ("elsif ", " then"),
        }
    }

    /// Returns the keyword that closes the block.
    fn close_keyword(self) -> &'static str {
        match self {
            ConditionalKeyword::If => "fi",
            ConditionalKeyword::When | ConditionalKeyword::Cond => "end",
        }
    }
}
