//! References to the parts of a net, and the sources of in-ports.

use rpi_image::Value;

/// Index of a node in [`crate::Net::nodes`].
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct NodeId(pub u32);

impl NodeId {
    /// Returns the index of the node in a table with one entry per node.
    #[must_use]
    pub const fn index(self) -> usize {
        self.0 as usize
    }
}

/// Index of a fragment in [`crate::Net::fragments`]; 0 is the root fragment.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct FragmentId(pub u32);

impl FragmentId {
    /// Root fragment of a command; always active.
    pub const ROOT: FragmentId = FragmentId(0);

    /// Returns the index of the fragment in a table with one entry per fragment.
    #[must_use]
    pub const fn index(self) -> usize {
        self.0 as usize
    }
}

/// Reference to an out-port of a node.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct PortRef {
    /// Node to which the port belongs.
    pub node: NodeId,
    /// Index of the port among the outputs of the node's [`rpi_image::PrimDesc`].
    pub port: u8,
}

/// Source of the value of an in-port: an out-port of a node, a constant or nothing.
#[derive(Clone, PartialEq, Debug)]
pub enum Input {
    /// The in-port has no source. Allowed if its declaration has [`rpi_image::Fallback::AbsentValue`].
    Unconnected,
    /// Constant: a literal operand, or the value of a parameter that replaces an unconnected in-port.
    Const(Box<Value>),
    /// Out-port of a node in any fragment. For a node in a fragment that does not enclose the reader, the value may be
    /// absent.
    ///
    /// Links cross the borders of fragments freely. Ports on a border are derived from the links, or named in
    /// [`crate::Fragment::outputs`].
    Port(PortRef),
}
