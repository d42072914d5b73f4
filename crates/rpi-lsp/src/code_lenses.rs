//! Code lenses: lines above declarations that run commands, tasks and tests, show nets, and count references.
//!
//! The commands are those of the editor, because the server runs no programs: `rpi.run`, `rpi.runTest` and `rpi.showNet`
//! with the path of the file and the name of the declaration, `rpi.showReferences` with the arguments of the editor
//! command that lists locations.

use lsp_types::{CodeLens, CodeLensParams, Command, Position};
use rpi_diag::FileId;
use rpi_driver::Inspection;
use rpi_sema::query::{Def, DefKind};
use serde_json::{Value, json};

use crate::programs::Declaration;
use crate::uri;
use crate::workspace::Workspace;
use crate::{locations::LocationMap, references};

/// Kinds of definitions with a lens: the title of the lens, and the command of the editor.
const ACTIONS: &[(DefKind, &str, &str)] = &[
    (DefKind::Command, "Run", "rpi.run"),
    (DefKind::Command, "Show net", "rpi.showNet"),
    (DefKind::Task, "Run", "rpi.run"),
    (DefKind::Test, "Run test", "rpi.runTest"),
    (DefKind::Node, "Show net", "rpi.showNet"),
];

/// Handles `textDocument/codeLens`: returns the lenses of the declarations at the top level of a document. Those that
/// count references are resolved later. Returns `None` if the document is not open.
pub(crate) fn code_lenses(world: &mut Workspace, params: CodeLensParams) -> Option<Vec<CodeLens>> {
    let seen = world.analysis(&params.text_document.uri)?;
    if !world.settings.code_lenses {
        return Some(Vec::new());
    }
    let places = world.locations(&seen);
    let path = uri::to_path(&params.text_document.uri);
    let file = path.display().to_string();
    let mut lenses = Vec::new();
    for (_, def) in seen.index().defs_in(FileId(0)) {
        if !is_top_level(&seen, def) || def.kind == DefKind::Module {
            continue;
        }
        let range = places.range(def.span);
        let actions = ACTIONS.iter().filter(|(kind, ..)| *kind == def.kind);
        lenses.extend(actions.map(|(_, title, command)| CodeLens {
            range,
            command: Some(Command {
                title: (*title).to_owned(),
                command: (*command).to_owned(),
                arguments: Some(vec![json!(file), json!(def.name.as_str())]),
            }),
            data: None,
        }));
        if def.kind != DefKind::Test {
            lenses.push(references_lens(
                &places,
                def,
                params.text_document.uri.as_str(),
            ));
        }
    }
    Some(lenses)
}

fn is_top_level(seen: &Inspection, def: &Def) -> bool {
    let parent = def.parent.map(|parent| seen.index().def(parent).kind);
    parent == Some(DefKind::Module)
}

fn references_lens(places: &LocationMap<'_>, def: &Def, uri: &str) -> CodeLens {
    CodeLens {
        range: places.range(def.span),
        command: None,
        data: Some(json!({ "uri": uri })),
    }
}

/// Handles `codeLens/resolve`: counts the references of the declaration at the lens in the whole project.
pub(crate) fn resolve(world: &mut Workspace, mut lens: CodeLens) -> CodeLens {
    let uri = lens.data.as_ref().and_then(|data| data.get("uri"));
    let Some(uri) = uri.and_then(Value::as_str).and_then(|uri| uri.parse().ok()) else {
        return lens;
    };
    let position = lens.range.start;
    lens.command = references_command(world, &uri, position);
    lens
}

fn references_command(
    world: &mut Workspace,
    uri: &lsp_types::Uri,
    position: Position,
) -> Option<Command> {
    let seen = world.analysis(uri)?;
    let offset = world.locations(&seen).offset(position);
    let name = seen.index().reference_at(FileId(0), offset)?;
    let declaration = Declaration::new(&seen, seen.index().def(name.def));
    let found = references::locations(world, &uri::to_path(uri), &declaration, false);
    let count = match found.len() {
        0 => "no references".to_owned(),
        1 => "1 reference".to_owned(),
        many => format!("{many} references"),
    };
    Some(Command {
        title: count,
        command: "rpi.showReferences".to_owned(),
        arguments: Some(vec![json!(uri.as_str()), json!(position), json!(found)]),
    })
}
