//! Table of all primitives.

use crate::c_code::CCode;
use crate::catalogue;
use crate::context::Context;
use core::cmp::Ordering;
use rpi_image::{PrimDesc, SizeArgs};

/// Code that runs one primitive on each group of operand words.
///
/// Words of a group, in order: inputs, parameters, outputs, state. A single value is its first slot. An array is its
/// first slot and its length; a matrix is its first slot, rows and columns. In the `optional` form, each input and
/// output ends with a presence slot, even if it is always present. Parameters that replace an in-port are inputs; text
/// parameters have no word. State is one word (fixed size) or two (first slot, length).
pub type RunFn = fn(&mut Context<'_>, &[u32]);

/// Entry of the registry of primitives (basic operations of nets): declaration and code of a primitive.
#[derive(Clone, Copy, Debug)]
pub struct Prim {
    /// Declaration of the primitive: name, ports, parameters and state.
    pub desc: PrimDesc,
    /// Code for ports that are all present; `None` if the core implements the primitive itself.
    pub total: Option<RunFn>,
    /// Code for ports that may be absent; `None` if the core implements the primitive itself.
    pub optional: Option<RunFn>,
    /// Function that writes the initial content of the state; `None` if it is zero.
    pub init: Option<fn(&SizeArgs<'_>, &mut [u64])>,
    /// The same code as C text; `None` if the core implements the primitive itself.
    pub c: Option<CCode>,
}

/// Index of a primitive in [`registry`].
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct PrimId(pub u16);

impl PrimId {
    /// Returns the declaration and the code of the primitive.
    #[must_use]
    pub fn prim(self) -> &'static Prim {
        &registry()[usize::from(self.0)]
    }

    /// Returns the declaration of the primitive.
    #[must_use]
    pub fn desc(self) -> &'static PrimDesc {
        &self.prim().desc
    }

    /// Returns the primitive with this registered name; `None` if there is none. As a `const fn`, it lets constants
    /// check names at compile time.
    #[must_use]
    pub const fn from_name(name: &str) -> Option<PrimId> {
        let all = registry();
        // A loop, because `slice::binary_search_by` is not a `const fn`.
        let (mut from, mut to) = (0, all.len());
        while from < to {
            let middle = usize::midpoint(from, to);
            match catalogue::compare_names(all[middle].desc.name, name) {
                Ordering::Less => from = middle + 1,
                Ordering::Equal => return Some(PrimId(middle as u16)),
                Ordering::Greater => to = middle,
            }
        }
        None
    }
}

/// Returns all primitives, sorted by registered name.
#[must_use]
pub const fn registry() -> &'static [Prim] {
    &catalogue::SORTED
}
