//! Printing of lists, with the empty lines between their elements.

use super::Printer;
use super::layout::{Doc, concat, empty, group, indent, text, word};
use crate::ast;
use rpi_diag::Span;

/// Brackets and separator of a list.
#[derive(Clone, Copy)]
pub(super) struct Delimiters {
    pub(super) open: &'static str,
    pub(super) separator: &'static str,
    pub(super) close: &'static str,
    /// Whether a list on one line has spaces inside its brackets: `{ a, b }`.
    pub(super) spaced: bool,
}

pub(super) const PARENS: Delimiters = brackets("(", ",", ")");
pub(super) const PORTS: Delimiters = brackets("(", ";", ")");
pub(super) const SQUARE: Delimiters = brackets("[", ",", "]");
pub(super) const CURLY: Delimiters = brackets("{", ";", "}");
pub(super) const STATIC_ARGS: Delimiters = brackets("<<", ",", ">>");
pub(super) const STATIC_PARAMS: Delimiters = brackets("<<", ";", ">>");

pub(super) const SPACED_COMMAS: Delimiters = spaced(",");
pub(super) const SPACED_SEMIS: Delimiters = spaced(";");

pub(super) const fn brackets(
    open: &'static str,
    separator: &'static str,
    close: &'static str,
) -> Delimiters {
    Delimiters {
        open,
        separator,
        close,
        spaced: false,
    }
}

const fn spaced(separator: &'static str) -> Delimiters {
    Delimiters {
        open: "{",
        separator,
        close: "}",
        spaced: true,
    }
}

/// Prints a list in brackets on one line, `(a, b)`, or with one element per line if it does not fit. `write` prints an
/// element.
pub(super) fn print_list<T>(
    printer: &Printer<'_>,
    brackets: Delimiters,
    elements: &[T],
    span: impl Fn(&T) -> Span,
    mut write: impl FnMut(&Printer, &T) -> Doc,
) -> Doc {
    let edge = || {
        if brackets.spaced {
            Doc::Line
        } else {
            Doc::SoftLine
        }
    };
    let mut parts = Vec::new();
    for (i, element) in elements.iter().enumerate() {
        let is_last = i + 1 == elements.len();
        parts.push(if i == 0 { edge() } else { Doc::Line });
        let written = write(printer, element);
        parts.push(printer.mark_offset(span(element), written));
        parts.push(word(if is_last { "" } else { brackets.separator }));
    }
    bracketed(brackets, concat(parts), edge())
}

/// Prints parts of an expression, such as the operands of a chain, on one line, or one per line if they do not fit.
/// `write` prints the part with the given index.
pub(super) fn print_phrases<T>(
    printer: &Printer<'_>,
    elements: &[T],
    write: impl FnMut(&Printer, usize, &T) -> Doc,
) -> Doc {
    let mut parts = print_phrase_parts(printer, elements, write).into_iter();
    let first = parts.next().unwrap_or_else(empty);
    let rest = concat(parts.map(indent));
    match rest.is_empty() {
        true => group(first),
        false => group(concat([Doc::Hang(Box::new(first)), rest])),
    }
}

/// Returns the document of each element, printed by `write`; all but the first begin with a [`Doc::Line`].
pub(super) fn print_phrase_parts<T>(
    printer: &Printer<'_>,
    elements: &[T],
    mut write: impl FnMut(&Printer, usize, &T) -> Doc,
) -> Vec<Doc> {
    let mut parts = Vec::new();
    for (i, element) in elements.iter().enumerate() {
        let before = if i == 0 { empty() } else { Doc::Line };
        parts.push(concat([before, write(printer, i, element)]));
    }
    parts
}

/// Prints the lines of a block, one below the other.
///
/// An empty line in the source is preserved; several become one. An element for which `write` returns true has an empty
/// line before and after it.
pub(super) fn print_lines<T>(
    printer: &Printer<'_>,
    elements: &[T],
    span: impl Fn(&T) -> Span,
    mut write: impl FnMut(&Printer, usize, &T) -> (Doc, bool),
) -> Doc {
    let mut parts = Vec::new();
    let mut was_apart = false;
    for (i, element) in elements.iter().enumerate() {
        let (doc, apart) = write(printer, i, element);
        let blank = apart || was_apart || printer.blank_before(span(element));
        parts.extend((i > 0).then_some(Doc::HardLine));
        parts.extend((i > 0 && blank).then_some(Doc::EmptyLine));
        parts.push(printer.mark_offset(span(element), doc));
        was_apart = apart;
    }
    concat(parts)
}

/// Prints the doc comment of a tree that has no source text; prints nothing otherwise, as comments of the source are
/// inserted later.
pub(super) fn doc_lines(printer: &Printer<'_>, doc: Option<&ast::Doc>) -> Doc {
    let Some(doc) = doc.filter(|_| printer.source.is_none()) else {
        return empty();
    };
    let line = |line: &str| match line.trim_end() {
        "" => text("--|"),
        line => text(format!("--| {line}")),
    };
    concat(doc.split('\n').flat_map(|l| [line(l), Doc::HardLine]))
}

/// Prints content between brackets; content of several lines is indented. `edge` is the optional line break before the
/// closing bracket.
fn bracketed(brackets: Delimiters, content: Doc, edge: Doc) -> Doc {
    let open = word(brackets.open);
    let close = word(brackets.close);
    match content.is_empty() {
        true => concat([open, close]),
        false => group(concat([open, indent(content), edge, close])),
    }
}
