//! Declare the type: a flow gets a declaration with its inferred type.

use lsp_types::CodeActionKind;
use rpi_diag::FileId;
use rpi_sema::query::DefKind;
use rpi_syntax::{SourceTokenKind, source_tokens};

use super::code_context::CodeContext;
use super::{Refactoring, insertion};

/// Returns the refactoring that declares the flow at the selection with its inferred type, before the `let` of its body.
pub(super) fn declare_type(context: &CodeContext<'_>) -> Vec<Refactoring> {
    declaration(context).into_iter().collect()
}

fn declaration(context: &CodeContext<'_>) -> Option<Refactoring> {
    let seen = context.seen;
    let name = seen
        .index()
        .reference_at(FileId(0), context.selection.start)?;
    let def = seen.index().def(name.def);
    let is_inferred = def.kind == DefKind::Local && def.ty.is_none();
    (is_inferred && def.span.file == FileId(0)).then_some(())?;
    // A flow with several types has none that could be declared.
    let [ty] = seen.types_of(def) else {
        return None;
    };
    let start = body_start(context, def.span.start)?;
    let (line, indent) = context.line_start(start);
    let begins = start as usize == line as usize + indent.len();
    let declared = format!("var {}: {ty};", def.name);
    let (at, text) = match begins {
        true => (line, format!("{indent}{declared}\n")),
        false => (start, format!("{declared} ")),
    };
    Some(Refactoring::new(
        format!("declare `{}: {ty}`", def.name),
        CodeActionKind::REFACTOR_REWRITE,
        vec![insertion(at, text)],
    ))
}

/// Returns the byte offset of the `let` of the innermost body around an offset.
fn body_start(context: &CodeContext<'_>, offset: u32) -> Option<u32> {
    let mut open = Vec::new();
    for token in source_tokens(context.text, context.seen.mode()) {
        if token.range.start >= offset as usize {
            break;
        }
        let word = &context.text[token.range.clone()];
        match (token.kind, word) {
            (SourceTokenKind::KeywordOrSymbol, "let") => open.push(token.range.start),
            (SourceTokenKind::KeywordOrSymbol, "tel") => {
                open.pop();
            }
            _ => {}
        }
    }
    open.last().and_then(|start| u32::try_from(*start).ok())
}
