//! Data flow lines: from the definition of a flow to its readers, through the borders of fragments.

use std::collections::BTreeMap;

use super::reads::{Read, Source};
use super::scene::{BoxId, Drawing, End, Link, Role, SceneId, Shape, ShapeId};

/// Definitions and reads of flows in a drawing, collected while the boxes are created. The lines follow from them.
#[derive(Default)]
pub(super) struct DefUse {
    definitions: BTreeMap<Source, Vec<BoxId>>,
    reads: Vec<(BoxId, Read)>,
    /// Ports at the borders of boxes that contain a scene: by inner scene, flow, and direction (true for a flow that
    /// enters).
    ports: BTreeMap<(SceneId, Source, bool), ShapeId>,
}

impl DefUse {
    /// Records that the box `place` defines the flow `key`.
    pub(super) fn defines(&mut self, place: BoxId, key: Source) {
        let all = self.definitions.entry(key).or_default();
        if !all.contains(&place) {
            all.push(place);
        }
    }

    /// Records that the box `place` reads values.
    pub(super) fn reads(&mut self, place: BoxId, reads: impl IntoIterator<Item = Read>) {
        self.reads
            .extend(reads.into_iter().map(|read| (place, read)));
    }

    /// Returns the flows and device ports that are read but not defined, each only once.
    pub(super) fn undefined(&self) -> Vec<Source> {
        let mut keys: Vec<Source> = Vec::new();
        for (_, read) in &self.reads {
            if !self.definitions.contains_key(&read.key) && !keys.contains(&read.key) {
                keys.push(read.key.clone());
            }
        }
        keys
    }

    /// Draws a line from each definition of a flow to each of its readers. `name` returns the text at a port for the
    /// flow.
    pub(super) fn draw(mut self, drawing: &mut Drawing, name: &dyn Fn(&Source) -> String) {
        for (reader, read) in std::mem::take(&mut self.reads) {
            for definer in self.definitions.get(&read.key).cloned().unwrap_or_default() {
                self.line(drawing, definer, reader, &read, name);
            }
        }
    }

    fn line(
        &mut self,
        drawing: &mut Drawing,
        definer: BoxId,
        reader: BoxId,
        read: &Read,
        name: &dyn Fn(&Source) -> String,
    ) {
        let (out, into) = (drawing.enclosing(definer), drawing.enclosing(reader));
        let common = out.iter().zip(&into).take_while(|(a, b)| a == b).count();
        // A box that reads its own content, such as a state whose transition reads flows of the state, gets no line.
        if common == into.len() && common < out.len() {
            return;
        }
        let common = common.min(out.len() - 1).min(into.len() - 1);
        let mut at = End {
            shape: definer.1,
            port: None,
        };
        for depth in (common + 1..out.len()).rev() {
            let port = self.port(drawing, out[depth].0, &read.key, false, name);
            let to = End {
                shape: port,
                port: None,
            };
            drawing.link(out[depth].0, line(at, to, false, read.optional));
            at = End {
                shape: out[depth - 1].1,
                port: Some(port),
            };
        }
        for (scene, shape) in into.iter().skip(common).copied() {
            let inner = (scene, shape) != reader;
            let next = drawing.scenes[scene].shapes[shape].inner.filter(|_| inner);
            let port = next.map(|inside| self.port(drawing, inside, &read.key, true, name));
            let delayed = read.delayed && !inner;
            let link = line(at, End { shape, port }, delayed, read.optional);
            drawing.link(scene, link);
            at = End {
                shape: port.unwrap_or_default(),
                port: None,
            };
        }
    }

    fn port(
        &mut self,
        drawing: &mut Drawing,
        scene: SceneId,
        key: &Source,
        inwards: bool,
        name: &dyn Fn(&Source) -> String,
    ) -> ShapeId {
        let role = if inwards { Role::Input } else { Role::Output };
        let entry = self.ports.entry((scene, key.clone(), inwards));
        *entry.or_insert_with(|| drawing.shape(scene, Shape::new(role, name(key))).1)
    }
}

fn line(from: End, to: End, delayed: bool, optional: bool) -> Link {
    Link {
        from,
        to,
        delayed,
        optional,
        label: String::new(),
    }
}
