//! Lists, with the comments between their elements.

use super::Printer;
use super::layout::{Doc, concat, group, indent, nothing, text, word};
use super::trivia::Own;
use crate::ast;
use rpi_diag::Span;

/// How a list in brackets is written.
#[derive(Clone, Copy)]
pub(super) struct Brackets {
    pub(super) open: &'static str,
    pub(super) separator: &'static str,
    pub(super) close: &'static str,
    /// Whether spaces stand inside the brackets on one line: `{ a, b }`.
    pub(super) spaced: bool,
}

pub(super) const PARENS: Brackets = brackets("(", ",", ")");
pub(super) const PORTS: Brackets = brackets("(", ";", ")");
pub(super) const SQUARE: Brackets = brackets("[", ",", "]");
pub(super) const CURLY: Brackets = brackets("{", ";", "}");
pub(super) const STATIC_ARGS: Brackets = brackets("<<", ",", ">>");
pub(super) const STATIC_PARAMS: Brackets = brackets("<<", ";", ">>");

pub(super) const SPACED_COMMAS: Brackets = spaced(",");
pub(super) const SPACED_SEMIS: Brackets = spaced(";");

pub(super) const fn brackets(
    open: &'static str,
    separator: &'static str,
    close: &'static str,
) -> Brackets {
    Brackets {
        open,
        separator,
        close,
        spaced: false,
    }
}

const fn spaced(separator: &'static str) -> Brackets {
    Brackets {
        open: "{",
        separator,
        close: "}",
        spaced: true,
    }
}

/// An element with the comments that stand before it.
struct Placed {
    lead: Vec<Own>,
    /// Whether an empty line stands directly before the element.
    blank_before: bool,
    doc: Doc,
}

impl Placed {
    /// The lines of comments and element; `first`: nothing stands before them in the list.
    fn lines(self, first: bool) -> Vec<(bool, Doc)> {
        let lead = self.lead.into_iter().map(|own| (own.blank_before, own.doc));
        let mut lines: Vec<(bool, Doc)> = lead.chain([(self.blank_before, self.doc)]).collect();
        lines[0].0 &= !first;
        lines
    }
}

impl Printer<'_> {
    /// `(a, b)` on one line, or an element on each.
    pub(super) fn list<T>(
        &mut self,
        brackets: Brackets,
        elements: &[T],
        span: impl Fn(&T) -> Span,
        mut write: impl FnMut(&mut Self, &T) -> Doc,
    ) -> Doc {
        let end = elements
            .last()
            .map_or(0, |last| self.trivia.next_token(span(last).end));
        let edge = || {
            if brackets.spaced {
                Doc::Line
            } else {
                Doc::Soft
            }
        };
        let mut parts = Vec::new();
        for (i, element) in elements.iter().enumerate() {
            let limit = elements.get(i + 1).map_or(end, |next| span(next).start);
            let is_last = i + 1 == elements.len();
            parts.push(if i == 0 { edge() } else { Doc::Line });
            let placed = self.placed(span(element), |p| write(p, element));
            parts.push(joined(placed.lines(i == 0)));
            parts.push(word(if is_last { "" } else { brackets.separator }));
            parts.extend(self.trivia.after(span(element).end, limit));
        }
        let own = self.trivia.before(end);
        parts.extend(own.into_iter().flat_map(|own| [Doc::Hard, own.doc]));
        self.trivia.reach(end + brackets.close.len() as u32);
        bracketed(brackets, concat(parts), edge())
    }

    /// Phrases one after the other, each on a line of its own if there is not enough room for all on
    /// one: the operands of a chain, the branches of an `if`.
    pub(super) fn phrases<T>(
        &mut self,
        elements: &[T],
        span: impl Fn(&T) -> Span,
        write: impl FnMut(&mut Self, usize, &T) -> Doc,
    ) -> Doc {
        let mut parts = self.phrase_parts(elements, span, write).into_iter();
        let first = parts.next().unwrap_or_else(nothing);
        group(concat([first, concat(parts.map(indent))]))
    }

    /// The same phrases, each after the first with a `Line` before it, to be set by who asks.
    pub(super) fn phrase_parts<T>(
        &mut self,
        elements: &[T],
        span: impl Fn(&T) -> Span,
        mut write: impl FnMut(&mut Self, usize, &T) -> Doc,
    ) -> Vec<Doc> {
        let mut parts = Vec::new();
        for (i, element) in elements.iter().enumerate() {
            // The first one does not begin a line: it has no place for comments before it.
            let phrase = match i {
                0 => write(self, 0, element),
                _ => {
                    let placed = self.placed(span(element), |p| write(p, i, element));
                    let lines = placed.lines(true).into_iter();
                    let lines = lines.map(|(_, line)| (false, line)).collect();
                    concat([Doc::Line, joined(lines)])
                }
            };
            let limit = elements.get(i + 1).map_or(0, |next| span(next).start);
            let behind = self.trivia.after(span(element).end, limit);
            parts.push(concat([phrase, concat(behind)]));
        }
        parts
    }

    /// Lines of a block, one below the other. Empty lines of the source are kept, one at most. What
    /// `write` marks as set apart has an empty line before and after it. `end` is where the block
    /// ends in the source if nothing is in it.
    pub(super) fn lines<T>(
        &mut self,
        elements: &[T],
        span: impl Fn(&T) -> Span,
        end: u32,
        write: impl FnMut(&mut Self, usize, &T) -> (Doc, bool),
    ) -> Doc {
        let end = elements
            .last()
            .map_or(end, |last| self.trivia.next_token(span(last).end));
        let mut block = self.open_block(elements, span, end, write);
        let rest = self.trivia.before(end).into_iter();
        block.extend(rest.map(|own| (own.blank_before, own.doc)));
        joined(block)
    }

    /// Lines of a block that no word ends: what stands below the last one belongs to what follows.
    pub(super) fn open_lines<T>(
        &mut self,
        elements: &[T],
        span: impl Fn(&T) -> Span,
        write: impl FnMut(&mut Self, usize, &T) -> (Doc, bool),
    ) -> Doc {
        let last = elements.last();
        let end = last.map_or(0, |last| self.trivia.next_token(span(last).end));
        let block = self.open_block(elements, span, end, write);
        joined(block)
    }

    /// The lines of a block whose last element is followed by what stands at `end`.
    fn open_block<T>(
        &mut self,
        elements: &[T],
        span: impl Fn(&T) -> Span,
        end: u32,
        mut write: impl FnMut(&mut Self, usize, &T) -> (Doc, bool),
    ) -> Vec<(bool, Doc)> {
        let mut block: Vec<(bool, Doc)> = Vec::new();
        let mut was_apart = false;
        for (i, element) in elements.iter().enumerate() {
            let limit = elements.get(i + 1).map_or(end, |next| span(next).start);
            let mut apart = false;
            let mut placed = self.placed(span(element), |p| {
                let (doc, is_apart) = write(p, i, element);
                apart = is_apart;
                doc
            });
            let suffixes = self.trivia.after(span(element).end, limit);
            placed.doc = concat(std::iter::once(placed.doc).chain(suffixes));
            let mut lines = placed.lines(i == 0);
            if i > 0 && (apart || was_apart) && lines.iter().all(|(blank, _)| !blank) {
                lines[0].0 = true;
            }
            was_apart = apart;
            block.extend(lines);
        }
        block
    }

    /// The lines of a doc comment that comes from the tree.
    pub(super) fn doc_lines(&self, doc: Option<&ast::Doc>) -> Doc {
        let Some(doc) = doc.filter(|_| self.docs_from_tree) else {
            return nothing();
        };
        let line = |line: &str| match line.trim_end() {
            "" => text("--|"),
            line => text(format!("--| {line}")),
        };
        concat(doc.split('\n').flat_map(|l| [line(l), Doc::Hard]))
    }

    /// Writes an element, and takes the comments before it and those in it that it did not place.
    fn placed(&mut self, span: Span, write: impl FnOnce(&mut Self) -> Doc) -> Placed {
        let mut lead = self.trivia.before(span.start);
        let mut blank_before = self.trivia.blank_before(span.start);
        self.trivia.reach(span.start);
        let doc = write(self);
        let mut left = self.trivia.before(span.end);
        self.trivia.reach(span.end);
        // What was documentation of nothing must not become that of the element.
        if left.last().is_some_and(|own| own.is_doc) {
            match lead.first_mut() {
                Some(first) => first.blank_before = true,
                None => blank_before = true,
            }
        }
        left.append(&mut lead);
        Placed {
            lead: left,
            blank_before,
            doc,
        }
    }
}

/// The lines, each with whether an empty one stands before it; none does before the first.
fn joined(lines: Vec<(bool, Doc)>) -> Doc {
    let mut parts = Vec::new();
    for (i, (blank_before, line)) in lines.into_iter().enumerate() {
        parts.extend((i > 0).then_some(Doc::Hard));
        parts.extend((blank_before && i > 0).then_some(Doc::Empty));
        parts.push(line);
    }
    concat(parts)
}

/// The content between brackets, indented if it breaks; `edge` stands before the last one.
fn bracketed(brackets: Brackets, content: Doc, edge: Doc) -> Doc {
    let open = word(brackets.open);
    let close = word(brackets.close);
    match content.is_nothing() {
        true => concat([open, close]),
        false => group(concat([open, indent(content), edge, close])),
    }
}
