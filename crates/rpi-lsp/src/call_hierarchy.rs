//! Call hierarchy: which declarations use a node, fragment, command or task, and which ones it uses.

use std::collections::BTreeMap;

use lsp_types::{
    CallHierarchyIncomingCall, CallHierarchyIncomingCallsParams, CallHierarchyItem,
    CallHierarchyOutgoingCall, CallHierarchyOutgoingCallsParams, CallHierarchyPrepareParams, Range,
};
use rpi_driver::Inspection;
use rpi_sema::query::{Def, DefId, DefKind};

use crate::navigation::name_at;
use crate::programs::Declaration;
use crate::symbols::symbol_kind;
use crate::uri;
use crate::workspace::Workspace;

/// Handles `textDocument/prepareCallHierarchy`: returns the declaration of the name at a position if it can be called or
/// run; `None` otherwise.
pub(crate) fn prepare(
    world: &mut Workspace,
    params: CallHierarchyPrepareParams,
) -> Option<Vec<CallHierarchyItem>> {
    let (seen, name) = name_at(world, &params.text_document_position_params)?;
    let def = seen.index().def(name.def);
    is_called(def.kind).then_some(())?;
    Some(vec![item(world, &seen, def)?])
}

/// Handles `callHierarchy/incomingCalls`: returns the declarations of the project that use the item.
pub(crate) fn incoming(
    world: &mut Workspace,
    params: CallHierarchyIncomingCallsParams,
) -> Option<Vec<CallHierarchyIncomingCall>> {
    let (near, declaration) = declaration_of(world, &params.item)?;
    let mut found: Vec<CallHierarchyIncomingCall> = Vec::new();
    world.for_programs_with(&near, &declaration, &mut |world, _, seen, def| {
        for (caller, ranges) in callers(world, seen, def) {
            let known = found.iter_mut().find(|one| one.from == caller);
            match known {
                Some(known) => {
                    let new = ranges.iter().filter(|r| !known.from_ranges.contains(r));
                    let new: Vec<Range> = new.copied().collect();
                    known.from_ranges.extend(new);
                }
                None => found.push(CallHierarchyIncomingCall {
                    from: caller,
                    from_ranges: ranges,
                }),
            }
        }
    });
    Some(found)
}

/// Handles `callHierarchy/outgoingCalls`: returns the declarations that the item uses.
pub(crate) fn outgoing(
    world: &mut Workspace,
    params: CallHierarchyOutgoingCallsParams,
) -> Option<Vec<CallHierarchyOutgoingCall>> {
    let (near, declaration) = declaration_of(world, &params.item)?;
    let seen = world.inspect_path(&near)?;
    let id = declaration.find_in(&seen)?;
    let index = seen.index();
    let def = index.def(id);
    let mut called: BTreeMap<DefId, Vec<Range>> = BTreeMap::new();
    let places = world.locations(&seen);
    for name in index.references_in(def.full_span) {
        let is_own = name.span == def.span;
        if !is_own && is_called(index.def(name.def).kind) {
            let ranges = called.entry(name.def).or_default();
            ranges.push(places.range(name.span));
        }
    }
    let calls = called.into_iter().filter_map(|(id, from_ranges)| {
        let to = item(world, &seen, index.def(id))?;
        Some(CallHierarchyOutgoingCall { to, from_ranges })
    });
    Some(calls.collect())
}

fn is_called(kind: DefKind) -> bool {
    kind.is_callable() || matches!(kind, DefKind::Command | DefKind::Task)
}

fn item(world: &Workspace, seen: &Inspection, def: &Def) -> Option<CallHierarchyItem> {
    let places = world.locations(seen);
    let location = places.location(world, def.span)?;
    Some(CallHierarchyItem {
        name: def.name.to_string(),
        kind: symbol_kind(def.kind)?,
        tags: None,
        detail: Some(def.kind.description().to_owned()),
        uri: location.uri,
        range: places.range(def.full_span.merge(def.span)),
        selection_range: location.range,
        data: None,
    })
}

/// Returns a file of the project and the declaration of an item that the client has received before.
fn declaration_of(
    world: &mut Workspace,
    item: &CallHierarchyItem,
) -> Option<(std::path::PathBuf, Declaration)> {
    let path = uri::to_path(&item.uri);
    let seen = world.inspect_path(&path)?;
    let start = world.locations(&seen).offset(item.selection_range.start);
    let name = seen.index().reference_at(rpi_diag::FileId(0), start)?;
    Some((path, Declaration::new(&seen, seen.index().def(name.def))))
}

/// Returns the declarations of a program that use a definition, each with the ranges of the uses.
fn callers(
    world: &Workspace,
    seen: &Inspection,
    def: DefId,
) -> Vec<(CallHierarchyItem, Vec<Range>)> {
    let index = seen.index();
    let own = index.def(def).span;
    let places = world.locations(seen);
    let mut all: Vec<(CallHierarchyItem, Vec<Range>)> = Vec::new();
    for span in index.references(def).filter(|span| *span != own) {
        let around = index.defs_in(span.file).map(|(_, def)| def);
        let mut around = around.filter(|def| def.full_span.contains(span));
        let caller = around.find(|def| is_called(def.kind) || def.kind == DefKind::Test);
        let Some(caller) = caller.and_then(|caller| item(world, seen, caller)) else {
            continue;
        };
        let range = places.range(span);
        match all.iter_mut().find(|(known, _)| *known == caller) {
            Some((_, ranges)) => ranges.push(range),
            None => all.push((caller, vec![range])),
        }
    }
    all
}
