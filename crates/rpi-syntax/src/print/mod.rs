//! Formatter: turns a syntax tree into text in the one style of the language.
//!
//! | file | content |
//! |---|---|
//! | `layout.rs` | documents, and their layout in lines |
//! | `trivia.rs` | positions of comments relative to the tokens of the source |
//! | `flat_doc.rs`, `piece_map.rs`, `align.rs`, `insert_comments.rs` | insertion of comments into a document |
//! | `list.rs` | lists in brackets and lists of lines, with the empty lines between them |
//! | `parens.rs` | required parentheses |
//! | `header.rs` | headers of declarations |
//! | `expr.rs`, `infix.rs`, `call.rs`, `ty.rs`, `decl.rs`, `body.rs`, `blocks.rs`, `contract.rs`, `task.rs` | constructs of the language |

mod align;
mod blocks;
mod body;
mod call;
mod contract;
mod decl;
mod expr;
mod flat_doc;
mod header;
mod infix;
mod insert_comments;
mod layout;
mod list;
mod parens;
mod piece_map;
mod task;
mod trivia;
mod ty;

use crate::ast::File;
use crate::parse::parse_with_tokens;
use crate::{Dialect, with_large_stack};
use insert_comments::insert_comments;
use layout::{Doc, concat, lay_out};
use rpi_diag::{Diagnostic, FileId, Severity, Span};
use trivia::Source;

pub use header::header;

/// Returns the text of a tree without source text, in the standard format. Doc comments in the tree are printed.
///
/// Parsing the text gives the same tree, except for parentheses and locations, if every name in it is valid: see
/// [`is_name`](crate::is_name).
pub fn print(file: &File, mode: Dialect) -> String {
    let printer = Printer { mode, source: None };
    with_large_stack(|| layout_text(&decl::print_items(&printer, &file.items)))
}

/// Returns a source text in the standard format. Returns the errors instead if the text has any.
///
/// The result has the same tree and the same comments, and formatting it again changes nothing. Its line ends are those
/// of most lines of the text (`\n` or `\r\n`).
pub fn format(text: &str, mode: Dialect) -> Result<String, Vec<Diagnostic>> {
    if !text.contains(CRLF) {
        return format_lines(text, mode);
    }
    // On errors, parse again with the original line ends, so that the locations in the diagnostics are correct.
    let formatted =
        format_lines(&text.replace(CRLF, "\n"), mode).or_else(|_| format_lines(text, mode))?;
    let ends = text.matches('\n').count();
    match 2 * text.matches(CRLF).count() > ends {
        true => Ok(formatted.replace('\n', CRLF)),
        false => Ok(formatted),
    }
}

/// End of a line in files from Windows.
const CRLF: &str = "\r\n";

/// Formats a text whose line ends are `\n`. Returns the errors instead if the text has any.
fn format_lines(text: &str, mode: Dialect) -> Result<String, Vec<Diagnostic>> {
    let (parsed, tokens) = parse_with_tokens(FileId(0), text, mode);
    let is_error = |diagnostic: &Diagnostic| diagnostic.severity() == Severity::Error;
    let errors: Vec<Diagnostic> = parsed.diagnostics.into_iter().filter(is_error).collect();
    if !errors.is_empty() {
        return Err(errors);
    }
    let source = Source::new(text, &tokens, &parsed.comments.all);
    Ok(with_large_stack(|| {
        let printer = Printer {
            mode,
            source: Some(&source),
        };
        let plain = decl::print_items(&printer, &parsed.file.items);
        layout_text(&insert_comments(plain, &source))
    }))
}

fn layout_text(doc: &Doc) -> String {
    match doc.is_empty() {
        true => String::new(),
        false => lay_out(doc),
    }
}

/// Converter of syntax trees into documents for the layout.
struct Printer<'a> {
    mode: Dialect,
    /// Source text of the tree, whose comments and empty lines are preserved; `None` for a generated tree.
    source: Option<&'a Source<'a>>,
}

impl Printer<'_> {
    /// Returns whether an empty line precedes the source text at `span`. Comments at the end of the text before it are
    /// ignored.
    fn blank_before(&self, span: Span) -> bool {
        let before = self
            .source
            .and_then(|source| source.text.get(..span.start as usize));
        let before = before.filter(|_| !span.is_none()).unwrap_or("");
        let before = self.without_trailing_comments(before);
        let gap = &before[before.trim_end().len()..];
        gap.bytes().filter(|b| *b == b'\n').count() > 1
    }

    /// Returns `text`, which is a start of the source, without the comments at the end of its last line.
    fn without_trailing_comments<'t>(&self, mut text: &'t str) -> &'t str {
        let comments = self.source.map_or(&[][..], |source| source.comments);
        loop {
            let end = text.trim_end_matches([' ', '\t']).len();
            let before = comments.partition_point(|c| (c.span.start as usize) < end);
            match comments[..before].last() {
                Some(last) if last.span.end as usize == end => {
                    text = &text[..last.span.start as usize];
                }
                _ => return text,
            }
        }
    }

    /// Extends `span` to the start of the token before it: a keyword that the tree does not store.
    fn with_keyword(&self, span: Span) -> Span {
        let before = self.source.filter(|_| !span.is_none());
        let before = before.and_then(|source| source.token_before(span.start));
        before.map_or(span, |word| Span {
            start: word.start,
            ..span
        })
    }

    /// Returns the document with a mark of its source offset, the start of `span`. The mark is left out if the source
    /// has no comments to align.
    fn mark_offset(&self, span: Span, doc: Doc) -> Doc {
        match self.source {
            Some(source) if !span.is_none() && !source.comments.is_empty() => {
                concat([Doc::SourceOffset(span.start), doc])
            }
            _ => doc,
        }
    }
}
