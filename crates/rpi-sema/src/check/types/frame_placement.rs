//! Placement of frames: no frame is placed in itself, and frames of one name have the same placement in all modules.
//!
//! Types refer to frames by name. Two declarations of one name with different placements would make incompatible poses
//! compatible.

use crate::check::Checker;
use crate::check::types::consts;
use crate::hash::FastMap;
use crate::program::{DeclId, DeclKind, Lookup, NameSpace};
use rpi_diag::{Code, Diagnostic};
use rpi_syntax::ast::FrameDecl;
use std::collections::BTreeMap;

/// Reports frames that are placed in one another in a cycle, and frames of one name with different placements.
pub(crate) fn check_frame_placement(checker: &mut Checker<'_>) {
    let ids = (0..).map(DeclId).take(checker.program.decls.len());
    let frames: Vec<DeclId> = ids
        .filter(|id| frame_decl(checker, *id).is_some())
        .collect();
    report_frame_cycles(checker, &frames);
    report_conflicting_placements(checker, &frames);
}

fn frame_decl<'a>(checker: &Checker<'a>, id: DeclId) -> Option<&'a FrameDecl> {
    match checker.program.decl(id).kind {
        DeclKind::Frame(frame) => Some(frame),
        _ => None,
    }
}

/// Returns the declared frame in which a frame is placed; `None` if it is placed in no frame or in the frame of a
/// device.
fn enclosing_frame(checker: &Checker<'_>, id: DeclId) -> Option<DeclId> {
    let parent = frame_decl(checker, id)?.parent.as_ref()?;
    let [name] = &parent.parts[..] else {
        return None;
    };
    let module = checker.program.decl(id).module;
    match checker
        .program
        .lookup_in(NameSpace::Value, module, &name.name)
    {
        Lookup::Found(found) if frame_decl(checker, found).is_some() => Some(found),
        _ => None,
    }
}

fn report_frame_cycles(checker: &mut Checker<'_>, frames: &[DeclId]) {
    // For each visited frame the frame at which that search started.
    let mut seen: FastMap<DeclId, DeclId> = FastMap::default();
    for start in frames {
        let (mut way, mut next) = (Vec::new(), Some(*start));
        while let Some(id) = next.filter(|id| !seen.contains_key(id)) {
            seen.insert(id, *start);
            way.push(id);
            next = enclosing_frame(checker, id);
        }
        let Some(end) = next.filter(|id| seen.get(id) == Some(start)) else {
            continue;
        };
        let from = way.iter().position(|id| *id == end).unwrap_or(0);
        checker.diagnostics.push(frame_cycle(checker, &way[from..]));
    }
}

fn frame_cycle(checker: &Checker<'_>, ring: &[DeclId]) -> Diagnostic {
    let name = |k: usize| &checker.program.decl(ring[k % ring.len()]).name;
    let mut way = format!("`{}`", name(0));
    for k in 1..=ring.len() {
        way.push_str(&format!(" in `{}`", name(k)));
    }
    let message = format!("the frame `{}` is placed in itself: {way}", name(0));
    let mut diagnostic = Diagnostic::new(Code::RPI1007, message);
    for (k, id) in ring.iter().enumerate() {
        let (span, text) = (
            checker.program.decl(*id).span,
            format!("`{}` is placed in `{}`", name(k), name(k + 1)),
        );
        diagnostic = match k {
            0 => diagnostic.primary(span, text),
            _ => diagnostic.secondary(span, text),
        };
    }
    diagnostic.help("break the cycle: place one of these frames elsewhere")
}

fn report_conflicting_placements(checker: &mut Checker<'_>, frames: &[DeclId]) {
    let mut first: BTreeMap<&str, DeclId> = BTreeMap::new();
    for id in frames {
        let decl = checker.program.decl(*id);
        // A declaration without a placement does not contradict one with a placement.
        if frame_decl(checker, *id).is_none_or(|frame| frame.parent.is_none()) {
            continue;
        }
        let known = *first.entry(decl.name.as_str()).or_insert(*id);
        let before = checker.program.decl(known);
        // In one module this is a duplicate name, which is reported elsewhere.
        if before.module == decl.module {
            continue;
        }
        if let Some([one, other]) = differing_placements(checker, [known, *id]) {
            let message = format!("the frame `{}` is in two places", decl.name);
            let diagnostic = Diagnostic::new(Code::RPI1002, message)
                .primary(before.span, format!("here it is {one}"))
                .secondary(decl.span, format!("in a used module it is {other}"))
                .help("frames are identified by name: rename one of them");
            checker.diagnostics.push(diagnostic);
        }
    }
}

/// Returns descriptions of the placements of two frames of the same name; `None` if the placements are equal.
fn differing_placements(checker: &mut Checker<'_>, frames: [DeclId; 2]) -> Option<[String; 2]> {
    let parents = frames.map(|id| {
        let parent = frame_decl(checker, id).and_then(|frame| frame.parent.as_ref());
        parent.map_or_else(String::new, |parent| {
            let parts: Vec<&str> = parent.parts.iter().map(|p| p.name.as_str()).collect();
            parts.join(".")
        })
    });
    if parents[0] != parents[1] {
        return Some(parents.map(|parent| format!("placed in `{parent}`")));
    }
    let poses =
        frames.map(|id| consts::check_constant(checker, id).map(|constant| constant.leaves));
    match poses {
        [Some(a), Some(b)] if a != b => Some(["at one pose", "at another pose"].map(str::to_owned)),
        _ => None,
    }
}
