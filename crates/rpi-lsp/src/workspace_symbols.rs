//! Symbols of the whole project: the declarations of all programs, also of closed files.

use std::path::Path;

use lsp_types::{
    Location, OneOf, Range, WorkspaceSymbol, WorkspaceSymbolParams, WorkspaceSymbolResponse,
};
use rpi_diag::{FileId, Span};
use rpi_syntax::ast::{Ident, Item, ItemKind};
use rpi_syntax::{Dialect, parse};

use crate::line_index::LineIndex;
use crate::symbols::symbol_kind;
use crate::workspace::Workspace;
use rpi_sema::query::DefKind;

/// Maximum number of symbols in an answer.
const MAX_SYMBOLS: usize = 500;

/// Handles `workspace/symbol`: returns the declarations at the top level of all programs of the project whose names
/// match the query, best matches first.
pub(crate) fn symbols(
    world: &mut Workspace,
    params: WorkspaceSymbolParams,
) -> Option<WorkspaceSymbolResponse> {
    let mut found: Vec<(usize, WorkspaceSymbol)> = Vec::new();
    let near = world.open_paths().into_iter().next().unwrap_or_default();
    let programs = world.programs(&near);
    let all = programs.len();
    for (done, path) in programs.into_iter().enumerate() {
        if !world.goes_on(done, all) {
            return None;
        }
        let declared = declarations(world, &path);
        let ranked = declared.into_iter().filter_map(|symbol| {
            let rank = match_rank(&symbol.name, &params.query)?;
            Some((rank, symbol))
        });
        found.extend(ranked);
    }
    found.sort_by(|(a, one), (b, other)| (a, &one.name).cmp(&(b, &other.name)));
    found.truncate(MAX_SYMBOLS);
    let symbols = found.into_iter().map(|(_, symbol)| symbol);
    Some(WorkspaceSymbolResponse::Nested(symbols.collect()))
}

/// Returns how well a name matches a query, 0 for the best match: equal, a prefix, a part, a subsequence. Case is
/// ignored. Returns `None` for no match.
fn match_rank(name: &str, query: &str) -> Option<usize> {
    let (name, query) = (name.to_lowercase(), query.to_lowercase());
    let mut letters = name.chars();
    let mut is_subsequence = || query.chars().all(|letter| letters.any(|one| one == letter));
    let matches = [
        name == query,
        name.starts_with(&query),
        name.contains(&query),
    ];
    let rank = matches.iter().position(|fits| *fits);
    rank.or_else(|| is_subsequence().then_some(matches.len()))
}

/// Returns the declarations at the top level of a program file.
fn declarations(world: &Workspace, path: &Path) -> Vec<WorkspaceSymbol> {
    let (Some(text), Some(uri)) = (world.text(path), world.uri_of(path)) else {
        return Vec::new();
    };
    let mode = Dialect::from_path(&path.display().to_string());
    let parsed = parse(FileId(0), &text, mode);
    let lines = LineIndex::new(&text);
    let at = |offset: u32| lines.position(&text, offset as usize, world.client.encoding);
    let module = path
        .file_stem()
        .map(|stem| stem.to_string_lossy().into_owned());
    let symbol = |(name, kind): (&Ident, DefKind)| {
        let Span { start, end, .. } = name.span;
        Some(WorkspaceSymbol {
            name: name.name.to_string(),
            kind: symbol_kind(kind)?,
            tags: None,
            container_name: module.clone(),
            location: OneOf::Left(Location::new(uri.clone(), Range::new(at(start), at(end)))),
            data: None,
        })
    };
    let declared = parsed.file.items.iter().flat_map(declared_names);
    declared.filter_map(symbol).collect()
}

/// Returns the names that a declaration introduces, each with the kind of its definition.
fn declared_names(item: &Item) -> Vec<(&Ident, DefKind)> {
    match &item.kind {
        ItemKind::Const(defs) => {
            let names = defs.iter().flat_map(|def| &def.names);
            names.map(|name| (name, DefKind::Const)).collect()
        }
        ItemKind::Type(defs) => defs.iter().map(|def| (&def.name, DefKind::Type)).collect(),
        ItemKind::Node(node) => vec![(&node.signature.name, DefKind::Node)],
        ItemKind::Fragment(fragment) => vec![(&fragment.signature.name, DefKind::Fragment)],
        ItemKind::Primitive(primitive) => vec![(&primitive.signature.name, DefKind::Primitive)],
        ItemKind::Device(device) => vec![(&device.name, DefKind::Device)],
        ItemKind::Frame(frame) => frame.names.iter().map(|n| (n, DefKind::Frame)).collect(),
        ItemKind::Command(command) => vec![(&command.name, DefKind::Command)],
        ItemKind::Task(task) => vec![(&task.name, DefKind::Task)],
        ItemKind::Test(test) => vec![(&test.title, DefKind::Test)],
        ItemKind::Use(_) | ItemKind::Include(_) | ItemKind::Error(_) => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn better_matches_have_lower_ranks() {
        assert_eq!(match_rank("Move", "move"), Some(0));
        assert_eq!(match_rank("MoveTo", "move"), Some(1));
        assert_eq!(match_rank("FastMove", "move"), Some(2));
        assert_eq!(match_rank("MoreOverThere", "movt"), Some(3));
        assert_eq!(match_rank("Move", "vm"), None);
        assert_eq!(match_rank("Move", ""), Some(1));
    }
}
