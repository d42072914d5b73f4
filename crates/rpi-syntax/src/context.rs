//! What the actions of the grammar need to know about the text.

use crate::Mode;
use crate::ast::{Doc, Ident, Name};
use crate::comments::{Comment, Comments};
use crate::lexer::{Lexed, Lexeme};
use crate::name::Interner;
use crate::phrase;
use crate::seeming::Seeming;
use rpi_diag::{Code, FileId, Finding, Span};
use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;

/// How many faults of a file are mended. Whoever has more gets to know of the first one of each declaration.
const PATIENCE: usize = 10_000;

/// The text being parsed, with what is found on the way.
pub(crate) struct Context<'t> {
    pub(crate) file: FileId,
    pub(crate) text: &'t str,
    pub(crate) mode: Mode,
    names: Interner,
    pub(crate) seeming: Seeming<'t>,
    comments: &'t Comments,
    lexemes: &'t [Lexeme],
    read_as: &'t BTreeMap<(u32, u32), String>,
    has_docs: bool,
    findings: RefCell<Vec<Finding>>,
    /// How many faults may still be mended.
    patience: Cell<usize>,
    /// Statements of other languages, of which all is said: their signs are not told besides.
    foreign: RefCell<Vec<Span>>,
    /// The names that a broken phrase seems to define, by the offset where it starts.
    broken: RefCell<BTreeMap<u32, Vec<Ident>>>,
}

impl<'t> Context<'t> {
    pub(crate) fn new(file: FileId, text: &'t str, mode: Mode, lexed: &'t Lexed) -> Context<'t> {
        Context {
            file,
            text,
            mode,
            names: Interner::default(),
            seeming: Seeming::new(text),
            comments: &lexed.comments,
            lexemes: &lexed.lexemes,
            read_as: &lexed.read_as,
            has_docs: lexed.comments.has_docs(),
            findings: RefCell::default(),
            patience: Cell::new(PATIENCE),
            foreign: RefCell::default(),
            broken: RefCell::default(),
        }
    }

    pub(crate) fn span(&self, start: u32, end: u32) -> Span {
        Span::new(self.file, start, end)
    }

    /// The range from `start` to the last token that begins before `end`.
    pub(crate) fn span_to_token(&self, start: u32, end: u32) -> Span {
        let after = self.lexemes.partition_point(|lexeme| lexeme.start < end);
        let last = self.lexemes[..after]
            .last()
            .map_or(end, |lexeme| lexeme.end);
        self.span(start, last.clamp(start, end.max(start)))
    }

    pub(crate) fn slice(&self, start: u32, end: u32) -> &'t str {
        self.text
            .get(start as usize..end as usize)
            .unwrap_or_default()
    }

    /// The white space before the line of this place.
    pub(crate) fn indent_of_line(&self, at: u32) -> &'t str {
        let before = self.slice(0, at);
        let line = &self.text[before.rfind('\n').map_or(0, |end| end + 1)..];
        &line[..line.len() - line.trim_start_matches([' ', '\t']).len()]
    }

    /// How far in the line begins, if what stands here is the first in it.
    pub(crate) fn indent(&self, at: u32) -> Option<usize> {
        let before = self.slice(0, at);
        let rest = before.trim_end_matches([' ', '\t']);
        (rest.is_empty() || rest.ends_with('\n')).then_some(before.len() - rest.len())
    }

    /// The name or number at a place, as it is read.
    pub(crate) fn name(&self, start: u32, end: u32) -> Name {
        let other = match self.read_as.is_empty() {
            true => None,
            false => self.read_as.get(&(start, end)),
        };
        self.names
            .name(other.map_or(self.slice(start, end), String::as_str))
    }

    pub(crate) fn ident(&self, start: u32, end: u32) -> Ident {
        Ident {
            name: self.name(start, end),
            span: self.span(start, end),
        }
    }

    /// A name for a text that does not stand in the source as it is.
    pub(crate) fn intern(&self, text: &str) -> Name {
        self.names.name(text)
    }

    /// The comments at a stretch of the text.
    pub(crate) fn comments_between(&self, start: u32, end: u32) -> &'t [Comment] {
        self.comments.between(start, end)
    }

    /// The doc comment that ends right before `start`.
    pub(crate) fn doc(&self, start: u32) -> Option<Doc> {
        match self.has_docs {
            true => self.comments.doc_before(self.text, start),
            false => None,
        }
    }

    pub(crate) fn report(&self, finding: Finding) {
        self.findings.borrow_mut().push(finding);
    }

    /// What has been found so far, which is then forgotten.
    pub(crate) fn take_findings(&self) -> Vec<Finding> {
        self.findings.take()
    }

    /// Whether one more fault may be mended, which costs reading a declaration again.
    pub(crate) fn may_mend(&self) -> bool {
        let left = self.patience.get().checked_sub(1);
        self.patience.set(left.unwrap_or(0));
        left.is_some()
    }

    pub(crate) fn swallow_signs(&self, statement: Span) {
        self.foreign.borrow_mut().push(statement);
    }

    pub(crate) fn foreign_statements(self) -> Vec<Span> {
        let mut foreign = self.foreign.into_inner();
        foreign.sort_unstable_by_key(|statement| statement.start);
        foreign
    }

    pub(crate) fn set_broken(&self, start: u32, names: Vec<Ident>) {
        self.broken.borrow_mut().insert(start, names);
    }

    /// The names that the broken phrase at `start` seems to define.
    pub(crate) fn broken_names(&self, start: u32) -> Vec<Ident> {
        self.broken
            .borrow()
            .get(&start)
            .cloned()
            .unwrap_or_default()
    }

    /// Two comparisons, one behind the other; `middle` is what stands between them if both could be meant. Further ones
    /// of the same row are not told again.
    pub(crate) fn comparisons_in_a_row(&self, signs: [Span; 2], middle: Option<Span>) {
        let text = middle.map(|span| (span, self.slice(span.start, span.end)));
        let mut findings = self.findings.borrow_mut();
        let same = |last: &mut Finding| {
            last.code == Code::RPI0009 && last.labels.iter().any(|label| label.span == signs[0])
        };
        match findings.pop_if(same) {
            Some(last) => findings.push(phrase::further_comparison(last, signs[1], text)),
            None => findings.push(phrase::comparisons_in_a_row(signs, text)),
        }
    }

    /// `x when c` is an operand of something larger: Kind 2 reads that differently.
    /// `-x ** y`: the sign with its operand, and the power.
    pub(crate) fn note_signed_base(&self, base: Span, power: Span) {
        if self.mode == Mode::Rpi {
            let text = self.slice(base.start, power.end);
            self.report(phrase::sign_before_power(base, power, text));
        }
    }

    pub(crate) fn note_sampled_part(&self, part: Span) {
        if self.mode == Mode::Lustre {
            self.report(phrase::when_binds_tightly(part));
        }
    }
}
