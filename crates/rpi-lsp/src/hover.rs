//! Hover: description of the name, keyword or expression at a position.

use lsp_types::{Hover, HoverContents, HoverParams, MarkupContent, MarkupKind};
use rpi_diag::{FileId, Span};
use rpi_driver::Inspection;
use rpi_prims::PrimId;
use rpi_sema::query::{self, FlowType};
use rpi_syntax::{KEYWORDS, source_tokens};

use crate::description::{Description, describe};
use crate::primitive;
use crate::workspace::Workspace;

/// Handles `textDocument/hover`: returns the description of the name, keyword or expression at a position; `None` if
/// there is none.
pub(crate) fn hover(world: &mut Workspace, params: HoverParams) -> Option<Hover> {
    let at = params.text_document_position_params;
    let seen = world.analysis(&at.text_document.uri)?;
    let places = world.locations(&seen);
    let offset = places.offset(at.position);
    let (span, description) = describe_name(&seen, offset)
        .or_else(|| describe_builtin_at(&seen, offset))
        .or_else(|| describe_expression(&seen, offset))?;
    let faults = fault_text(&seen, span, offset);
    Some(Hover {
        contents: HoverContents::Markup(MarkupContent {
            kind: MarkupKind::Markdown,
            value: description.markdown() + &faults,
        }),
        range: Some(places.range(span)),
    })
}

/// Operators spelt as words that can raise a fault (run-time error): division, remainder, conversion to an integer.
const FAULTING_OPERATORS: &[&str] = &["div", "mod", "int"];

/// Returns a Markdown list of the faults (run-time errors) that the operation at `offset` can raise; empty if there are
/// none. `described` is the range of the text that the hover describes.
fn fault_text(seen: &Inspection, described: Span, offset: u32) -> String {
    let all = seen.faults_around(FileId(0), offset);
    let is_operator = FAULTING_OPERATORS.contains(&seen.sources.slice(described));
    let here = all.iter();
    let here = here.filter(|one| is_operator || described.contains(one.span));
    let lines = here.map(|one| format!("- {}\n", one.text()));
    let lines: String = lines.collect();
    match lines.is_empty() {
        true => lines,
        false => format!("\n\nPossible faults at run time:\n\n{lines}"),
    }
}

/// Returns the range of the name at a byte offset, and the description of its definition; `None` if there is no name
/// that the program declares.
fn describe_name(seen: &Inspection, offset: u32) -> Option<(Span, Description)> {
    let name = seen.index().reference_at(FileId(0), offset)?;
    let def = seen.index().def(name.def);
    Some((name.span, describe(seen, def, Some(name.span))))
}

/// Returns the range and the description of the keyword, primitive or predeclared name at a byte offset; `None` if
/// there is none.
pub(crate) fn describe_builtin_at(seen: &Inspection, offset: u32) -> Option<(Span, Description)> {
    let text = seen.sources.text(FileId(0));
    let at = offset as usize;
    let all = source_tokens(text, seen.mode());
    let piece = all
        .iter()
        .find(|piece| piece.range.start <= at && at < piece.range.end)?;
    let word = &text[piece.range.clone()];
    let end = u32::try_from(piece.range.end).unwrap_or(u32::MAX);
    let span = Span::new(FileId(0), u32::try_from(piece.range.start).ok()?, end);
    Some((span, describe_word(seen, word)?))
}

fn describe_word(seen: &Inspection, word: &str) -> Option<Description> {
    if let Some(prim) = PrimId::from_name(word) {
        return Some(describe_primitive(prim));
    }
    let keyword = KEYWORDS
        .iter()
        .find(|k| k.text == word && k.is_in(seen.mode()));
    let keyword = keyword.map(|keyword| Description {
        code: keyword.text.to_owned(),
        kind: "keyword".to_owned(),
        doc: keyword.doc.to_owned(),
    });
    keyword.or_else(|| describe_predeclared(&query::builtin(word)?).into())
}

/// Returns the description of a primitive: its signature and its documentation.
pub(crate) fn describe_primitive(prim: PrimId) -> Description {
    Description {
        code: primitive::signature(prim.desc()),
        kind: "primitive".to_owned(),
        doc: primitive::doc(prim.desc()),
    }
}

/// Returns the description of a predeclared flow or operator: its usage and its documentation.
pub(crate) fn describe_predeclared(builtin: &query::Builtin) -> Description {
    Description {
        code: builtin.usage.clone(),
        kind: "predeclared".to_owned(),
        doc: builtin.doc.trim().to_owned(),
    }
}

/// Returns the range of the innermost expression around a byte offset, and a description with its type; `None` if there
/// is none.
fn describe_expression(seen: &Inspection, offset: u32) -> Option<(Span, Description)> {
    let (span, types) = seen.type_around(FileId(0), offset)?;
    let code: Vec<String> = types.iter().map(FlowType::to_string).collect();
    let description = Description {
        code: code.join(" or "),
        kind: "type of this expression".to_owned(),
        doc: String::new(),
    };
    Some((span, description))
}
