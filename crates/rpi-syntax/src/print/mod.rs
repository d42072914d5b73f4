//! From tree to text, in the one style of the language.
//!
//! | file | idea |
//! |---|---|
//! | `layout.rs` | documents, and how they are broken into lines |
//! | `trivia.rs` | comments |
//! | `list.rs` | lists in brackets and lists of lines, with their comments |
//! | `parens.rs` | where parentheses must stand |
//! | `head.rs` | declarations without their bodies |
//! | `expr.rs`, `call.rs`, `ty.rs`, `decl.rs`, `body.rs`, `contract.rs`, `task.rs` | the forms of the language |

mod blocks;
mod body;
mod call;
mod contract;
mod decl;
mod expr;
mod head;
mod layout;
mod list;
mod parens;
mod task;
mod trivia;
mod ty;

use crate::ast::File;
use crate::{Mode, parse, with_stack};
use layout::lay_out;
use rpi_diag::{FileId, Finding, Severity};
use trivia::Trivia;

pub use head::head;

/// Writes a tree that has no text, in the style of the language; doc comments in it are kept.
///
/// Reading the result gives the same tree, parentheses and places aside, as long as every name in it
/// is one: see [`is_name`](crate::is_name).
pub fn print(file: &File, mode: Mode) -> String {
    with_stack(|| Printer::new(mode, None).file(file))
}

/// Formats a text. The errors in it if there are any, for then nothing is changed.
///
/// The result has the same tree and the same comments, and formatting it again changes nothing.
pub fn format(text: &str, mode: Mode) -> Result<String, Vec<Finding>> {
    let parsed = parse(FileId(0), text, mode);
    let is_error = |finding: &Finding| finding.severity() == Severity::Error;
    let errors: Vec<Finding> = parsed.findings.into_iter().filter(is_error).collect();
    if !errors.is_empty() {
        return Err(errors);
    }
    let trivia = Trivia::new(text, &parsed.comments.all);
    Ok(with_stack(|| {
        Printer::new(mode, Some(trivia)).file(&parsed.file)
    }))
}

/// Turns nodes into documents, and places the comments on the way.
struct Printer<'a> {
    mode: Mode,
    trivia: Trivia<'a>,
    /// Whether doc comments come from the tree, as there is no text to take them from.
    docs_from_tree: bool,
}

impl<'a> Printer<'a> {
    fn new(mode: Mode, trivia: Option<Trivia<'a>>) -> Printer<'a> {
        Printer {
            mode,
            docs_from_tree: trivia.is_none(),
            trivia: trivia.unwrap_or_else(|| Trivia::new("", &[])),
        }
    }

    fn file(mut self, file: &File) -> String {
        let items = self.items(&file.items);
        match items.is_nothing() {
            true => String::new(),
            false => lay_out(&items),
        }
    }
}
