//! State shared by the grammar actions while a file is parsed.

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

/// Maximum number of errors per file with recovery. Beyond it, only the first error of each declaration is reported.
const PATIENCE: usize = 10_000;

/// Text being parsed, with the diagnostics found so far.
pub(crate) struct Context<'t> {
    pub(crate) file: FileId,
    pub(crate) text: &'t str,
    pub(crate) mode: Mode,
    names: Interner,
    pub(crate) seeming: Seeming<'t>,
    comments: &'t Comments,
    lexemes: &'t [Lexeme],
    /// Text that replaces a literal of another language, by its byte range.
    read_as: &'t BTreeMap<(u32, u32), String>,
    has_docs: bool,
    findings: RefCell<Vec<Finding>>,
    /// Number of errors that may still be recovered from.
    patience: Cell<usize>,
    /// Statements of other languages that have been reported. Foreign operators inside them are not reported again.
    foreign: RefCell<Vec<Span>>,
    /// Names that a phrase with a syntax error seems to define, by its start offset.
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

    /// Returns the span from `start` to the end of the last token that begins before `end`.
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

    /// Returns the indentation of the line that contains the byte offset.
    pub(crate) fn indent_of_line(&self, at: u32) -> &'t str {
        let before = self.slice(0, at);
        let line = &self.text[before.rfind('\n').map_or(0, |end| end + 1)..];
        &line[..line.len() - line.trim_start_matches([' ', '\t']).len()]
    }

    /// Returns the indentation in bytes if the offset is at the first token of its line.
    pub(crate) fn indent(&self, at: u32) -> Option<usize> {
        let before = self.slice(0, at);
        let rest = before.trim_end_matches([' ', '\t']);
        (rest.is_empty() || rest.ends_with('\n')).then_some(before.len() - rest.len())
    }

    /// Returns the name or number at a byte range. A literal of another language is replaced by its RPI form.
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

    /// Interns a text that does not occur verbatim in the source.
    pub(crate) fn intern(&self, text: &str) -> Name {
        self.names.name(text)
    }

    /// Returns the comments that begin in `start..end`.
    pub(crate) fn comments_between(&self, start: u32, end: u32) -> &'t [Comment] {
        self.comments.between(start, end)
    }

    /// Returns the doc comment directly before the byte offset `start`.
    pub(crate) fn doc(&self, start: u32) -> Option<Doc> {
        match self.has_docs {
            true => self.comments.doc_before(self.text, start),
            false => None,
        }
    }

    pub(crate) fn report(&self, finding: Finding) {
        self.findings.borrow_mut().push(finding);
    }

    /// Returns the diagnostics so far and clears them.
    pub(crate) fn take_findings(&self) -> Vec<Finding> {
        self.findings.take()
    }

    /// Returns whether recovery from one more error is allowed, and counts it. Each recovery parses a declaration
    /// again.
    pub(crate) fn may_mend(&self) -> bool {
        let left = self.patience.get().checked_sub(1);
        self.patience.set(left.unwrap_or(0));
        left.is_some()
    }

    /// Suppresses diagnostics about foreign operators in a statement of another language.
    pub(crate) fn swallow_signs(&self, statement: Span) {
        self.foreign.borrow_mut().push(statement);
    }

    /// Returns the statements of other languages that have been reported, in text order.
    pub(crate) fn foreign_statements(self) -> Vec<Span> {
        let mut foreign = self.foreign.into_inner();
        foreign.sort_unstable_by_key(|statement| statement.start);
        foreign
    }

    /// Records the names that the phrase with a syntax error at `start` seems to define.
    pub(crate) fn set_broken(&self, start: u32, names: Vec<Ident>) {
        self.broken.borrow_mut().insert(start, names);
    }

    /// Returns the names that the phrase with a syntax error at `start` seems to define.
    pub(crate) fn broken_names(&self, start: u32) -> Vec<Ident> {
        self.broken
            .borrow()
            .get(&start)
            .cloned()
            .unwrap_or_default()
    }

    /// Reports chained comparisons: `a < b < c`. `middle` is the operand between them if both may be meant. Further
    /// comparisons of the same chain extend the diagnostic.
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

    /// Warns about `-x ** y` in RPI files. `base` is the negated operand, `power` the exponent.
    pub(crate) fn note_signed_base(&self, base: Span, power: Span) {
        if self.mode == Mode::Rpi {
            let text = self.slice(base.start, power.end);
            self.report(phrase::sign_before_power(base, power, text));
        }
    }

    /// Warns about `x when c` as an operand in Lustre files: Kind 2 parses it differently.
    pub(crate) fn note_sampled_part(&self, part: Span) {
        if self.mode == Mode::Lustre {
            self.report(phrase::when_binds_tightly(part));
        }
    }
}
