//! Where frames are placed: none in itself, and one name at one place, whichever modules declare it.
//!
//! Types know frames by their names. Two declarations of one name that say different things would let poses meet that do
//! not.

use super::Checker;
use crate::hash::Map;
use crate::program::{DeclId, DeclKind, Lookup, Space};
use rpi_diag::{Code, Finding};
use rpi_syntax::ast::FrameDecl;
use std::collections::BTreeMap;

impl<'a> Checker<'a> {
    /// Reports what is wrong with the places of all frames of a program.
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

    /// The declared frame that a frame is placed in.
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
        // The frame from which each was come to.
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
        finding.help("one of them is placed in none of the others")
    }

    fn frames_in_two_places(&mut self, frames: &[DeclId]) {
        let mut first: BTreeMap<&str, DeclId> = BTreeMap::new();
        for id in frames {
            let decl = self.program.decl(*id);
            // One without a place says nothing against one that has a place.
            if self
                .frame_decl(*id)
                .is_none_or(|frame| frame.parent.is_none())
            {
                continue;
            }
            let known = *first.entry(decl.name.as_str()).or_insert(*id);
            let before = self.program.decl(known);
            if before.module == decl.module {
                continue;
            }
            if let Some([one, other]) = self.other_place([known, *id]) {
                let message = format!("the frame `{}` is in two places", decl.name);
                let finding = Finding::new(Code::RPI1002, message)
                    .at(before.span, format!("here it is {one}"))
                    .also(decl.span, format!("in a module that is used it is {other}"))
                    .help("poses meet by the names of frames: give one of them another name");
                self.findings.push(finding);
            }
        }
    }

    /// Where two frames of one name are, if that is not the same.
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
                Some(["at one pose", "at another one"].map(str::to_owned))
            }
            _ => None,
        }
    }
}
