//! Documentation of a completion item, which the client requests for the selected item only.

use lsp_types::{CompletionItem, Documentation, MarkupContent, MarkupKind};
use rpi_driver::Inspection;
use rpi_prims::PrimId;
use rpi_sema::query::{DefId, builtin};
use serde_json::Value;

use super::library::library_names;
use crate::description::describe;
use crate::hover::{describe_predeclared, describe_primitive};
use crate::workspace::Workspace;

/// Handles `completionItem/resolve`: adds the documentation to an item of the last completion.
pub(crate) fn resolve(world: &mut Workspace, mut item: CompletionItem) -> CompletionItem {
    let seen = world.completed.clone().and_then(|uri| world.analysis(&uri));
    let text = item
        .data
        .as_ref()
        .and_then(|data| documentation(seen.as_deref(), data, &item.label));
    item.documentation = text.map(|value| {
        let kind = MarkupKind::Markdown;
        Documentation::MarkupContent(MarkupContent { kind, value })
    });
    item
}

/// Returns the documentation of the name that the data of an item identifies, in Markdown; `None` if there is none, or
/// the text has changed since.
fn documentation(seen: Option<&Inspection>, data: &Value, label: &str) -> Option<String> {
    let key = data.get(1)?;
    match data.get(0)?.as_str()? {
        "def" => {
            let seen = seen?;
            let index = seen.index();
            let id = DefId(u32::try_from(key.as_u64()?).ok()?);
            let def = index.get(id).filter(|def| *def.name == *label)?;
            Some(describe(seen, def, None).markdown())
        }
        "library" => {
            let name = key.as_str()?;
            let offer = library_names().iter().find(|offer| offer.name == *name)?;
            let doc = offer.doc.as_deref().unwrap_or_default();
            Some(format!("```rpi\n{}\n```\n\n{doc}", offer.head))
        }
        "primitive" => {
            let prim = PrimId::from_name(key.as_str()?)?;
            Some(describe_primitive(prim).markdown())
        }
        _ => Some(describe_predeclared(&builtin(key.as_str()?)?).markdown()),
    }
}
