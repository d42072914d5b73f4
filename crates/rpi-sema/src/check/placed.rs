//! Placement of frames: no frame is placed in itself, and frames of one name have the same placement in all modules.
//!
//! Types refer to frames by name. Two declarations of one name with different placements would make incompatible poses
//! compatible.

use super::Checker;
use crate::hash::Map;
use crate::program::{DeclId, DeclKind, Lookup, Space};
use rpi_diag::{Code, Finding};
use rpi_syntax::ast::FrameDecl;
use std::collections::BTreeMap;

impl<'a> Checker<'a> {
    /// Reports errors in the placement of all frames of a program.
    pub(super) fn frames_are_placed(&mut self) {
        let ids = (0..).map(DeclId).take(self.program.decls.len());
        let frames: Vec<DeclId> = ids.filter(|id| self.frame_decl(*id).is_some()).collect();
        self.frames_in_circles(&frames);
        self.frames_in_two_places(&frames);
    }

    fn frame_decl(&self, id: DeclId) -> Option<&'a FrameDecl> {
        match self.program.decl(id).kind {
            DeclKind::Frame(frame) => Some(frame),
            _ => None,
        }
    }

    /// Returns the declared frame in which a frame is placed.
    fn placed_in(&self, id: DeclId) -> Option<DeclId> {
        let parent = self.frame_decl(id)?.parent.as_ref()?;
        let [name] = &parent.parts[..] else {
            return None;
        };
        let module = self.program.decl(id).module;
        match self.program.lookup_in(Space::Value, module, &name.name) {
            Lookup::Found(found) if self.frame_decl(found).is_some() => Some(found),
            _ => None,
        }
    }

    fn frames_in_circles(&mut self, frames: &[DeclId]) {
        // For each visited frame the frame at which that search started.
        let mut seen: Map<DeclId, DeclId> = Map::default();
        for start in frames {
            let (mut way, mut next) = (Vec::new(), Some(*start));
            while let Some(id) = next.filter(|id| !seen.contains_key(id)) {
                seen.insert(id, *start);
                way.push(id);
                next = self.placed_in(id);
            }
            let Some(end) = next.filter(|id| seen.get(id) == Some(start)) else {
                continue;
            };
            let from = way.iter().position(|id| *id == end).unwrap_or(0);
            self.findings.push(self.placed_in_itself(&way[from..]));
        }
    }

    fn placed_in_itself(&self, ring: &[DeclId]) -> Finding {
        let name = |k: usize| &self.program.decl(ring[k % ring.len()]).name;
        let mut way = format!("`{}`", name(0));
        for k in 1..=ring.len() {
            way.push_str(&format!(" in `{}`", name(k)));
        }
        let message = format!("the frame `{}` is placed in itself: {way}", name(0));
        let mut finding = Finding::new(Code::RPI1007, message);
        for (k, id) in ring.iter().enumerate() {
            let (span, text) = (
                self.program.decl(*id).span,
                format!("`{}` is placed in `{}`", name(k), name(k + 1)),
            );
            finding = match k {
                0 => finding.at(span, text),
                _ => finding.also(span, text),
            };
        }
        finding.help("break the cycle: place one of these frames elsewhere")
    }

    fn frames_in_two_places(&mut self, frames: &[DeclId]) {
        let mut first: BTreeMap<&str, DeclId> = BTreeMap::new();
        for id in frames {
            let decl = self.program.decl(*id);
            // A declaration without a placement does not contradict one with a placement.
            if self
                .frame_decl(*id)
                .is_none_or(|frame| frame.parent.is_none())
            {
                continue;
            }
            let known = *first.entry(decl.name.as_str()).or_insert(*id);
            let before = self.program.decl(known);
            // In one module this is a duplicate name, which is reported elsewhere.
            if before.module == decl.module {
                continue;
            }
            if let Some([one, other]) = self.other_place([known, *id]) {
                let message = format!("the frame `{}` is in two places", decl.name);
                let finding = Finding::new(Code::RPI1002, message)
                    .at(before.span, format!("here it is {one}"))
                    .also(decl.span, format!("in a used module it is {other}"))
                    .help("frames are identified by name: rename one of them");
                self.findings.push(finding);
            }
        }
    }

    /// Returns the placements of two frames of one name if they differ.
    fn other_place(&mut self, frames: [DeclId; 2]) -> Option<[String; 2]> {
        let parents = frames.map(|id| {
            let parent = self.frame_decl(id).and_then(|frame| frame.parent.as_ref());
            parent.map_or_else(String::new, |parent| {
                let parts: Vec<&str> = parent.parts.iter().map(|p| p.name.as_str()).collect();
                parts.join(".")
            })
        });
        if parents[0] != parents[1] {
            return Some(parents.map(|parent| format!("placed in `{parent}`")));
        }
        let poses = frames.map(|id| self.constant(id).map(|constant| constant.leaves));
        match poses {
            [Some(a), Some(b)] if a != b => {
                Some(["at one pose", "at another pose"].map(str::to_owned))
            }
            _ => None,
        }
    }
}
