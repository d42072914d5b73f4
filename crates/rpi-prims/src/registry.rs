//! The table of all primitives.

use crate::catalogue;
use crate::cx::Cx;
use core::cmp::Ordering;
use rpi_image::{PrimDesc, SizeArgs};

/// Runs a row of equal primitives: `operands` holds one group of words per primitive.
///
/// Words of a group, in this order: inputs, parameters, outputs, state. A single value takes its first cell, an array
/// its first cell and its length, a matrix its first cell, rows and columns. In the `optional` form a presence cell
/// follows at the end of each input and output (also of those that happen to be always present). Parameters that stand
/// in for an in-port are inputs; text parameters take no word. State takes one word (fixed size) or two (first cell,
/// length).
pub type RunFn = fn(&mut Cx<'_>, &[u32]);

/// A primitive: what is known of it, and its code.
#[derive(Clone, Copy, Debug)]
pub struct Prim {
    /// Its declaration.
    pub desc: PrimDesc,
    /// Code for the case that all inputs are present and all outputs will be.
    pub total: Option<RunFn>,
    /// Code that reads and writes presence.
    pub optional: Option<RunFn>,
    /// Fills the state's initial content where it is not zero.
    pub init: Option<fn(&SizeArgs<'_>, &mut [u64])>,
}

/// Index of a primitive in [`registry`].
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct PrimId(pub u16);

impl PrimId {
    /// The primitive's declaration and code.
    #[must_use]
    pub fn prim(self) -> &'static Prim {
        &registry()[usize::from(self.0)]
    }

    /// The primitive's declaration.
    #[must_use]
    pub fn desc(self) -> &'static PrimDesc {
        &self.prim().desc
    }

    /// The primitive of this registered name. In a constant, the compiler refuses a name that is not registered.
    #[must_use]
    pub const fn of(name: &str) -> Option<PrimId> {
        let all = registry();
        let (mut from, mut to) = (0, all.len());
        while from < to {
            let middle = usize::midpoint(from, to);
            match catalogue::order(all[middle].desc.name, name) {
                Ordering::Less => from = middle + 1,
                Ordering::Equal => return Some(PrimId(middle as u16)),
                Ordering::Greater => to = middle,
            }
        }
        None
    }
}

/// All primitives, sorted by registered name.
#[must_use]
pub const fn registry() -> &'static [Prim] {
    &catalogue::SORTED
}
