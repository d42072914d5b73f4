//! Occurrences of a declaration that are not references in the syntax tree: declarations that are linked by having the
//! same name, and links in doc comments.

use rpi_diag::{FileId, Span};
use rpi_driver::{Inspection, doc_blocks, doc_links as links_in};
use rpi_sema::query::{Def, DefId, DefKind};
use rpi_syntax::ast::{Statement, StatementKind, Visitor, Walker};

/// Returns the definitions that must keep the same name as `def` for the program to keep its meaning:
///
/// - a result of a command is declared by each statement that ends the command with it;
/// - a command takes over (`given`) the flow that its predecessor exports under the same name;
/// - a parameter of a command or task that is run directly gets the value of the constant of the same name.
pub(super) fn linked_defs(seen: &Inspection, def: DefId) -> Vec<DefId> {
    let index = seen.index();
    let own = index.def(def);
    let same_name = |other: &Def| other.name == own.name;
    let all = seen.sources.files().flat_map(|file| index.defs_in(file));
    let all: Vec<(DefId, &Def)> = all
        .filter(|(id, other)| *id != def && same_name(other))
        .collect();
    let exported = exported_flows(seen, &own.name);
    let is_exported =
        |id: DefId, def: &Def| def.kind == DefKind::TakenOver || exported.contains(&id);
    let has_successor = own.kind == DefKind::TakenOver
        || all
            .iter()
            .any(|(_, other)| other.kind == DefKind::TakenOver);
    let is_linked = |id: DefId, other: &Def| match own.kind {
        DefKind::Result => other.kind == DefKind::Result && other.parent == own.parent,
        DefKind::Const => is_root_parameter(seen, other) && is_top_level(seen, own),
        DefKind::Param if is_root_parameter(seen, own) => {
            other.kind == DefKind::Const && is_top_level(seen, other)
        }
        _ => has_successor && is_exported(def, own) && is_exported(id, other),
    };
    let linked = all.into_iter().filter(|(id, other)| is_linked(*id, other));
    linked.map(|(id, _)| id).collect()
}

fn is_top_level(seen: &Inspection, def: &Def) -> bool {
    let parent = def.parent.map(|parent| seen.index().def(parent).kind);
    parent == Some(DefKind::Module) && def.span.file == FileId(0)
}

fn is_root_parameter(seen: &Inspection, def: &Def) -> bool {
    let parent = def.parent.map(|parent| seen.index().def(parent).kind);
    def.kind == DefKind::Param && matches!(parent, Some(DefKind::Command | DefKind::Task))
}

/// Returns the flows with a name that commands of the main module export.
fn exported_flows(seen: &Inspection, name: &str) -> Vec<DefId> {
    let mut exports = Exports {
        name,
        spans: Vec::new(),
    };
    for item in seen.items() {
        Walker::new(&mut exports).item(item);
    }
    let index = seen.index();
    let at = |span: &Span| index.reference_at(span.file, span.start);
    exports
        .spans
        .iter()
        .filter_map(at)
        .map(|found| found.def)
        .collect()
}

/// Collector of the places of a name at the end of exported paths.
struct Exports<'n> {
    name: &'n str,
    spans: Vec<Span>,
}

impl<'a> Visitor<'a> for Exports<'_> {
    fn visits_expressions(&self) -> bool {
        false
    }

    fn visit_statement(&mut self, statement: &'a Statement) {
        if let StatementKind::Export(flows) = &statement.kind {
            let last = flows.iter().filter_map(|flow| flow.parts.last());
            let here = last.filter(|part| part.name == *self.name);
            self.spans.extend(here.map(|part| part.span));
        }
    }
}

/// Returns the ranges of the name of a definition in the doc comments of the root file that link to it.
pub(super) fn doc_links(seen: &Inspection, def: DefId) -> Vec<Span> {
    let file = FileId(0);
    let text = seen.sources.text(file);
    let name = &seen.index().def(def).name;
    let mut found = Vec::new();
    if !text.contains("[`") {
        return found;
    }
    for line in doc_blocks(text, seen.mode()).into_iter().flatten() {
        for (range, path) in links_in(&text[line.clone()]) {
            let mut part_start = line.start + range.start;
            for part in path.split('.') {
                let upto = &text[line.start + range.start..part_start + part.len()];
                let start = u32::try_from(part_start).unwrap_or(u32::MAX);
                let target = seen.index().resolve_path(file, start, upto);
                if target == Some(def) && part.ends_with(name.as_str()) {
                    let end = u32::try_from(part_start + part.len()).unwrap_or(u32::MAX);
                    let length = u32::try_from(name.len()).unwrap_or(0);
                    found.push(Span::new(file, end - length, end));
                }
                part_start += part.len() + 1;
            }
        }
    }
    found
}
