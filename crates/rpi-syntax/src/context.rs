//! State shared by the grammar actions while a file is parsed.

use crate::Dialect;
use crate::ast::{Doc, Ident, Name};
use crate::comments::{Comment, Comments};
use crate::guessed_names::GuessedNames;
use crate::lexer::{LexOutput, Lexeme};
use crate::name::Interner;
use crate::validation;
use rpi_diag::{Code, Diagnostic, FileId, Span};
use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;

/// Maximum number of syntax errors per file after which parsing continues with the same declaration. Further
/// declarations report only their first error.
const MAX_RECOVERIES: usize = 10_000;

/// Text that is being parsed, with the diagnostics collected so far.
pub(crate) struct ParseContext<'t> {
    pub(crate) file: FileId,
    pub(crate) text: &'t str,
    pub(crate) dialect: Dialect,
    names: Interner,
    pub(crate) guessed_names: &'t GuessedNames<'t>,
    comments: &'t Comments,
    lexemes: &'t [Lexeme],
    /// RPI text of literals in the notation of another language, by the byte range of the literal.
    replaced_text: &'t BTreeMap<(u32, u32), String>,
    has_docs: bool,
    diagnostics: RefCell<Vec<Diagnostic>>,
    /// Number of syntax errors that parsing may still recover from in this file.
    recoveries_left: Cell<usize>,
    /// Source ranges of reported statements of other languages. Foreign operators inside them are not reported again.
    foreign_statements: RefCell<Vec<Span>>,
    /// Names that a statement or declaration with a syntax error seems to define, by its start offset in bytes.
    error_names: RefCell<BTreeMap<u32, Vec<Ident>>>,
}

impl<'t> ParseContext<'t> {
    pub(crate) fn new(
        file: FileId,
        text: &'t str,
        mode: Dialect,
        lexed: &'t LexOutput,
        guessed_names: &'t GuessedNames<'t>,
    ) -> ParseContext<'t> {
        ParseContext {
            file,
            text,
            dialect: mode,
            names: Interner::default(),
            guessed_names,
            comments: &lexed.comments,
            lexemes: &lexed.lexemes,
            replaced_text: &lexed.replaced_text,
            has_docs: lexed.comments.has_docs(),
            diagnostics: RefCell::default(),
            recoveries_left: Cell::new(MAX_RECOVERIES),
            foreign_statements: RefCell::default(),
            error_names: RefCell::default(),
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

    /// Returns the spaces and tabs at the start of the line that contains the byte offset `at`.
    pub(crate) fn indent_of_line(&self, at: u32) -> &'t str {
        let before = self.slice(0, at);
        let line = &self.text[before.rfind('\n').map_or(0, |end| end + 1)..];
        &line[..line.len() - line.trim_start_matches([' ', '\t']).len()]
    }

    /// Returns the indentation in bytes of the token at byte offset `at`; `None` if it is not the first token of its
    /// line.
    pub(crate) fn indent(&self, at: u32) -> Option<usize> {
        let before = self.slice(0, at);
        let rest = before.trim_end_matches([' ', '\t']);
        (rest.is_empty() || rest.ends_with('\n')).then_some(before.len() - rest.len())
    }

    /// Returns the name or number at a byte range. For a literal in the notation of another language, returns its RPI
    /// form.
    pub(crate) fn name(&self, start: u32, end: u32) -> Name {
        let other = match self.replaced_text.is_empty() {
            true => None,
            false => self.replaced_text.get(&(start, end)),
        };
        self.names
            .intern(other.map_or(self.slice(start, end), String::as_str))
    }

    pub(crate) fn ident(&self, start: u32, end: u32) -> Ident {
        Ident {
            name: self.name(start, end),
            span: self.span(start, end),
        }
    }

    /// Returns an interned name for a text that does not occur verbatim in the source.
    pub(crate) fn intern(&self, text: &str) -> Name {
        self.names.intern(text)
    }

    /// Returns the comments that begin in `start..end`.
    pub(crate) fn comments_between(&self, start: u32, end: u32) -> &'t [Comment] {
        self.comments.between(start, end)
    }

    /// Returns the text of the doc comment directly before the byte offset `start`; `None` if there is none.
    pub(crate) fn doc(&self, start: u32) -> Option<Doc> {
        match self.has_docs {
            true => self.comments.doc_before(self.text, start),
            false => None,
        }
    }

    pub(crate) fn report(&self, diagnostic: Diagnostic) {
        self.diagnostics.borrow_mut().push(diagnostic);
    }

    /// Returns the diagnostics collected so far and removes them.
    pub(crate) fn take_diagnostics(&self) -> Vec<Diagnostic> {
        self.diagnostics.take()
    }

    /// Returns whether parsing may recover from one more syntax error of the file, and counts the error. Each recovery
    /// parses a declaration again.
    pub(crate) fn may_recover(&self) -> bool {
        let left = self.recoveries_left.get().checked_sub(1);
        self.recoveries_left.set(left.unwrap_or(0));
        left.is_some()
    }

    /// Suppresses diagnostics about foreign operators within `statement`, a reported statement of another language.
    pub(crate) fn suppress_foreign_operators(&self, statement: Span) {
        self.foreign_statements.borrow_mut().push(statement);
    }

    /// Returns the source ranges of the reported statements of other languages, in text order.
    pub(crate) fn into_foreign_statements(self) -> Vec<Span> {
        let mut foreign = self.foreign_statements.into_inner();
        foreign.sort_unstable_by_key(|statement| statement.start);
        foreign
    }

    /// Records the names that the statement or declaration with a syntax error at byte offset `start` seems to define.
    pub(crate) fn set_error_names(&self, start: u32, names: Vec<Ident>) {
        self.error_names.borrow_mut().insert(start, names);
    }

    /// Returns the names that the statement or declaration with a syntax error at byte offset `start` seems to define.
    pub(crate) fn error_names(&self, start: u32) -> Vec<Ident> {
        self.error_names
            .borrow()
            .get(&start)
            .cloned()
            .unwrap_or_default()
    }

    /// Reports chained comparisons: `a < b < c`. `signs` are the places of the operators. `middle` is the place of the
    /// operand between them if both comparisons may be meant. Further comparisons of the same chain extend the
    /// diagnostic.
    pub(crate) fn report_chained_comparison(&self, signs: [Span; 2], middle: Option<Span>) {
        let text = middle.map(|span| (span, self.slice(span.start, span.end)));
        let mut diagnostics = self.diagnostics.borrow_mut();
        let same = |last: &mut Diagnostic| {
            last.code == Code::RPI0009 && last.labels.iter().any(|label| label.span == signs[0])
        };
        match diagnostics.pop_if(same) {
            Some(last) => {
                diagnostics.push(validation::extend_chained_comparison(last, signs[1], text))
            }
            None => diagnostics.push(validation::chained_comparison(signs, text)),
        }
    }

    /// Warns about `-x ** y` in RPI files, where the sign binds more strongly than the power. `base` is the place of
    /// `-x`, `power` that of the exponent.
    pub(crate) fn warn_sign_before_power(&self, base: Span, power: Span) {
        if self.dialect == Dialect::Rpi {
            let text = self.slice(base.start, power.end);
            self.report(validation::sign_before_power(base, power, text));
        }
    }

    /// Warns about `x when c` as an operand in Lustre files, which Kind 2 parses differently. `part` is the place of
    /// the sampled expression.
    pub(crate) fn warn_sampled_operand(&self, part: Span) {
        if self.dialect == Dialect::Lustre {
            self.report(validation::when_precedence(part));
        }
    }
}
