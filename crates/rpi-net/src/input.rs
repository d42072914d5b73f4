//! References to the parts of a net, and the sources of in-ports.

use rpi_image::Value;

/// Index of a node in [`crate::Net::nodes`].
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct NodeId(pub u32);

impl NodeId {
    /// Index of the node in a table with one entry per node.
    #[must_use]
    pub const fn index(self) -> usize {
        self.0 as usize
    }
}

/// Index of a fragment in [`crate::Net::fragments`]; 0 is the root.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct FragmentId(pub u32);

impl FragmentId {
    /// Root fragment of a command; always active.
    pub const ROOT: FragmentId = FragmentId(0);

    /// Index of the fragment in a table with one entry per fragment.
    #[must_use]
    pub const fn index(self) -> usize {
        self.0 as usize
    }
}

/// Reference to an out-port of a node.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct PortRef {
    /// Node that owns the port.
    pub node: NodeId,
    /// Index of the port in the outputs of the node's [`rpi_image::PrimDesc`].
    pub port: u8,
}

/// What an in-port reads: an out-port, a constant or nothing.
#[derive(Clone, PartialEq, Debug)]
pub enum Input {
    /// No source. Allowed for an in-port whose declaration has [`rpi_image::Fallback::AbsentValue`].
    Unconnected,
    /// Constant: a parameter that replaces an unconnected port, or a literal operand.
    Const(Box<Value>),
    /// Out-port of a node in the same fragment, an enclosing one, or any other one (then the value may be absent).
    /// Links cross fragment borders freely; the ports on a border are derived, or named in [`crate::Fragment::outputs`].
    Port(PortRef),
}
