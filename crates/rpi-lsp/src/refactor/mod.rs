//! Refactorings: code actions that change a program and keep its meaning.
//!
//! Each refactoring checks the conditions under which it keeps the meaning, such as that the moved expression cannot
//! fault. In addition the changed program is checked before the action is offered: an action that would cause a
//! diagnostic is left out.

mod arguments;
mod cases;
mod code_context;
mod declare;
mod extract_flow;
mod extract_node;
mod inline_flow;
mod units;

use std::collections::BTreeMap;
use std::path::Path;

use lsp_types::CodeActionKind;
use rpi_diag::{Edit, FileId, Severity, Span};
use rpi_driver::{Inspection, inspect};

use crate::workspace::Workspace;
use code_context::CodeContext;

/// Refactoring that can be applied at the selection.
pub(crate) struct Refactoring {
    pub(crate) title: String,
    pub(crate) kind: CodeActionKind,
    pub(crate) edits: Vec<Edit>,
}

impl Refactoring {
    fn new(title: impl Into<String>, kind: CodeActionKind, edits: Vec<Edit>) -> Refactoring {
        Refactoring {
            title: title.into(),
            kind,
            edits,
        }
    }
}

/// Function that returns the refactorings of one kind at the selection.
type Finder = fn(&CodeContext<'_>) -> Vec<Refactoring>;

/// All kinds of refactorings.
const FINDERS: &[Finder] = &[
    extract_flow::extract_flow,
    extract_node::extract_node,
    inline_flow::inline_flow,
    arguments::name_arguments,
    cases::add_cases,
    declare::declare_type,
    units::convert_unit,
];

/// Returns the refactorings at a selection, a range of bytes in the root file of a program at `path`.
pub(crate) fn refactorings(
    world: &Workspace,
    path: &Path,
    seen: &Inspection,
    selection: Span,
) -> Vec<Refactoring> {
    let context = CodeContext::new(seen, selection);
    let all = FINDERS.iter().flat_map(|find| find(&context));
    all.filter(|one| is_clean(world, path, seen, one)).collect()
}

/// Returns whether the changed program has no diagnostic that the program did not have. A refactoring of a program with
/// errors may remove some.
fn is_clean(world: &Workspace, path: &Path, seen: &Inspection, one: &Refactoring) -> bool {
    let text = rpi_diag::apply(seen.sources.text(FileId(0)), one.edits.iter());
    let after = inspect(path, &text, &world.overlay());
    let counts = |seen: &Inspection| {
        let mut counts: BTreeMap<String, usize> = BTreeMap::new();
        let counted = seen
            .diagnostics
            .iter()
            .filter(|d| d.severity() != Severity::Note);
        for diagnostic in counted {
            *counts.entry(diagnostic.code.to_string()).or_default() += 1;
        }
        counts
    };
    let (old, new) = (counts(seen), counts(&after));
    new.iter()
        .all(|(code, count)| old.get(code).copied().unwrap_or(0) >= *count)
}

/// Returns an edit that replaces the text at `span`.
fn edit(span: Span, text: impl Into<String>) -> Edit {
    Edit {
        span,
        text: text.into(),
    }
}

/// Returns an edit that inserts text before a byte offset in the root file.
fn insertion(offset: u32, text: impl Into<String>) -> Edit {
    edit(Span::new(FileId(0), offset, offset), text)
}
