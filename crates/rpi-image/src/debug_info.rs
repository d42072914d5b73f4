//! Debug information of an image: source locations for messages, and ports for observers.

use crate::image::Signal;
use alloc::string::String;
use alloc::vec::Vec;

/// Debug information of an image: source locations of the nodes, and ports that observers can read. The evaluation of a
/// cycle does not use it.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct DebugInfo {
    /// Source locations of nodes of the net, for messages. The other tables of the debug information index this list.
    pub locations: Vec<SourceLocation>,
    /// Map from slots to source locations, to find the node that raised a fault: pairs of the first output slot of a
    /// primitive and an index into `locations`, in ascending order of slots.
    pub origins: Vec<(u32, u32)>,
    /// All ports whose values an observer can read, in the order of the nodes of the net. Empty unless the image was
    /// compiled with observable ports.
    pub probes: Vec<Probe>,
    /// For each step of [`Image::steps`](crate::image::Image::steps), the source location of the node it belongs to: an
    /// index into `locations`, or `u32::MAX` if there is none. Empty unless the image was compiled with observable
    /// ports.
    pub step_locations: Vec<u32>,
}

impl DebugInfo {
    /// Returns the total length in bytes of the paths, flow names and port names of the debug information.
    pub(crate) fn text_len(&self) -> usize {
        let ports = self.probes.iter().map(|p| p.port.len());
        let locations = self.locations.iter().map(SourceLocation::text_len);
        ports.sum::<usize>() + locations.sum::<usize>()
    }

    /// Returns the memory of all lists in bytes, without the texts that their entries refer to.
    pub(crate) fn list_bytes(&self) -> usize {
        size_of_val(&*self.locations)
            + size_of_val(&*self.origins)
            + size_of_val(&*self.probes)
            + size_of_val(&*self.step_locations)
    }
}

/// Place of a node of the net: its path in the net, the flow that it computes, and its range in the source text.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct SourceLocation {
    /// Path from the root fragment through the enclosing fragments to the node, for example `outer/inner/node`.
    pub path: String,
    /// Name of the flow in the source that the node computes; `None` if the node belongs to no named flow.
    pub flow: Option<String>,
    /// Range of the source text that the node was compiled from; `None` if there is none, as in an imported net.
    pub range: Option<TextRange>,
}

/// Range of bytes in a source file. The compiler that made the image maps file numbers to files.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct TextRange {
    /// Number of the source file, as the compiler assigned it.
    pub file: u32,
    /// Offset of the first byte of the range from the start of the file.
    pub start: u32,
    /// Offset of the byte after the range from the start of the file.
    pub end: u32,
}

/// Port of a node whose value an observer can read while the image runs, with its location in memory.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Probe {
    /// Node that has the port: an index into [`DebugInfo::locations`].
    pub location: u32,
    /// Name of the port as declared by the primitive, for example `outValue`.
    pub port: String,
    /// Slots of the value and of its presence. The presence is valid only in cycles in which the fragment of the node
    /// and all fragments around it are active.
    pub value: Signal,
    /// Fragment that contains the node: an index into [`Image::fragments`](crate::image::Image::fragments).
    pub fragment: u32,
}

impl SourceLocation {
    fn text_len(&self) -> usize {
        self.path.len() + self.flow.as_ref().map_or(0, String::len)
    }
}
