//! Debug information of an image: source locations for messages, and ports for observers.

use crate::image::Signal;
use alloc::string::String;
use alloc::vec::Vec;

/// Source locations and observable ports of an image. A cycle does not use them.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct DebugInfo {
    /// Source locations of nodes, for messages.
    pub locations: Vec<SourceLocation>,
    /// Map from slots to source locations, for faults: (first output slot of the primitive, index into `locations`), in
    /// ascending order of slots.
    pub origins: Vec<(u32, u32)>,
    /// All observable ports, in the order of the nodes of the net. Empty unless the image was lowered for observation.
    pub probes: Vec<Probe>,
    /// Source location of the node of each step, as an index into `locations`; `u32::MAX` if there is none. Empty
    /// unless the image was lowered for observation.
    pub step_locations: Vec<u32>,
}

impl DebugInfo {
    /// Length of all texts, in bytes.
    pub(crate) fn text_len(&self) -> usize {
        let ports = self.probes.iter().map(|p| p.port.len());
        let locations = self.locations.iter().map(SourceLocation::text_len);
        ports.sum::<usize>() + locations.sum::<usize>()
    }

    /// Memory of all lists without their texts, in bytes.
    pub(crate) fn list_bytes(&self) -> usize {
        size_of_val(&*self.locations)
            + size_of_val(&*self.origins)
            + size_of_val(&*self.probes)
            + size_of_val(&*self.step_locations)
    }
}

/// Source location of a node.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct SourceLocation {
    /// Path through the fragments to the node, for example `outer/inner/node`.
    pub path: String,
    /// Name of the flow in the source, if it has one.
    pub flow: Option<String>,
    /// Location in the source text, if there is one.
    pub range: Option<TextRange>,
}

/// Range of bytes in a source file. The compiler that made the image maps file numbers to files.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct TextRange {
    /// Number of the file.
    pub file: u32,
    /// Offset of the first byte.
    pub start: u32,
    /// Offset after the last byte.
    pub end: u32,
}

/// Port of a node whose value can be read while the image runs, with its location in memory.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Probe {
    /// Node: an index into [`DebugInfo::locations`].
    pub location: u32,
    /// Name of the port as declared by the primitive.
    pub port: String,
    /// Location of the value. The presence is valid only while the fragment and all enclosing fragments are active.
    pub value: Signal,
    /// Enclosing fragment: an index into [`Image::fragments`](crate::image::Image::fragments).
    pub fragment: u32,
}

impl SourceLocation {
    fn text_len(&self) -> usize {
        self.path.len() + self.flow.as_ref().map_or(0, String::len)
    }
}
