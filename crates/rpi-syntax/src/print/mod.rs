//! From tree to text, in the one style of the language.
//!
//! | file | idea |
//! |---|---|
//! | `layout.rs` | documents, and how they are broken into lines |
//! | `gaps.rs` | between which tokens the comments of a source stand |
//! | `pieces.rs`, `align.rs`, `weave.rs` | how comments get into a document |
//! | `list.rs` | lists in brackets and lists of lines, with the empty lines between them |
//! | `parens.rs` | where parentheses must stand |
//! | `head.rs` | declarations without their bodies |
//! | `expr.rs`, `call.rs`, `ty.rs`, `decl.rs`, `body.rs`, `contract.rs`, `task.rs` | the forms of the language |

mod align;
mod blocks;
mod body;
mod call;
mod contract;
mod decl;
mod expr;
mod gaps;
mod head;
mod layout;
mod list;
mod parens;
mod pieces;
mod task;
mod ty;
mod weave;

use crate::ast::File;
use crate::parse::parse_with_tokens;
use crate::{Mode, with_stack};
use gaps::Source;
use layout::{Doc, concat, lay_out};
use rpi_diag::{FileId, Finding, Severity, Span};
use weave::weave;

pub use head::head;

/// Writes a tree that has no text, in the style of the language; doc comments in it are kept.
///
/// Reading the result gives the same tree, parentheses and places aside, as long as every name in it
/// is one: see [`is_name`](crate::is_name).
pub fn print(file: &File, mode: Mode) -> String {
    with_stack(|| written(&Printer { mode, source: None }.items(&file.items)))
}

/// Formats a text. The errors in it if there are any, for then nothing is changed.
///
/// The result has the same tree and the same comments, and formatting it again changes nothing. Its lines end as most lines
/// of the text do.
pub fn format(text: &str, mode: Mode) -> Result<String, Vec<Finding>> {
    if !text.contains(CRLF) {
        return format_lines(text, mode);
    }
    // Places in findings are those of the text as it is.
    let formatted =
        format_lines(&text.replace(CRLF, "\n"), mode).or_else(|_| format_lines(text, mode))?;
    let ends = text.matches('\n').count();
    match 2 * text.matches(CRLF).count() > ends {
        true => Ok(formatted.replace('\n', CRLF)),
        false => Ok(formatted),
    }
}

/// How lines end elsewhere.
const CRLF: &str = "\r\n";

fn format_lines(text: &str, mode: Mode) -> Result<String, Vec<Finding>> {
    let (parsed, tokens) = parse_with_tokens(FileId(0), text, mode);
    let is_error = |finding: &Finding| finding.severity() == Severity::Error;
    let errors: Vec<Finding> = parsed.findings.into_iter().filter(is_error).collect();
    if !errors.is_empty() {
        return Err(errors);
    }
    let source = Source::new(text, &tokens, &parsed.comments.all);
    Ok(with_stack(|| {
        let mut printer = Printer {
            mode,
            source: Some(&source),
        };
        let plain = printer.items(&parsed.file.items);
        written(&weave(plain, &source))
    }))
}

fn written(doc: &Doc) -> String {
    match doc.is_nothing() {
        true => String::new(),
        false => lay_out(doc),
    }
}

/// Turns nodes into documents.
struct Printer<'a> {
    mode: Mode,
    /// What was read, if anything was: doc comments are taken from there, and empty lines between declarations.
    source: Option<&'a Source<'a>>,
}

impl Printer<'_> {
    /// Whether an empty line stands directly before what begins at `span`.
    fn blank_before(&self, span: Span) -> bool {
        let before = self
            .source
            .and_then(|source| source.text.get(..span.start as usize));
        let before = before.filter(|_| !span.is_none()).unwrap_or("");
        let before = self.without_comments_behind(before);
        let gap = &before[before.trim_end().len()..];
        gap.bytes().filter(|b| *b == b'\n').count() > 1
    }

    /// A text up to the comments at its end, as far as they stand on its last line.
    fn without_comments_behind<'t>(&self, mut text: &'t str) -> &'t str {
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

    /// What begins with the word before `span`, which has no place of its own.
    fn with_word(&self, span: Span) -> Span {
        let before = self.source.filter(|_| !span.is_none());
        let before = before.and_then(|source| source.token_before(span.start));
        before.map_or(span, |word| Span {
            start: word.start,
            ..span
        })
    }

    /// What a part becomes that begins at `span`: where there are comments, with its place for them to be found by.
    fn part(&self, span: Span, doc: Doc) -> Doc {
        match self.source {
            Some(source) if !span.is_none() && !source.comments.is_empty() => {
                concat([Doc::At(span.start), doc])
            }
            _ => doc,
        }
    }
}
