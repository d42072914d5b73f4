//! Memory layout: constants, external values, state by fragment, values.

use crate::flat_net::FlatNet;
use crate::registers::{Region, Register, Registers};
use rpi_image::image::{Layout, SlotRange};
use rpi_net::{FragmentId, Net};

/// Assignment of memory slots to all registers of a net.
pub(super) struct MemoryLayout {
    at: Vec<u32>,
    pub(super) layout: Layout,
    /// For each fragment, the range of memory slots that holds its state and that of all fragments inside it.
    pub(super) states: Vec<SlotRange>,
}

impl MemoryLayout {
    pub(super) fn new(net: &Net, flat: &FlatNet) -> Self {
        let slots = &flat.registers;
        let mut layouts = MemoryLayout {
            at: vec![0; slots.len()],
            layout: Layout::default(),
            states: Vec::new(),
        };
        let mut own = vec![SlotRange::default(); net.fragments.len()];
        let mut end = 0u32;
        for slot in order(slots, &ranks(net)) {
            layouts.at[slot.index()] = end;
            let start = end;
            end = end.saturating_add(slots.size(slot));
            let l = &mut layouts.layout;
            match slots.region(slot) {
                Region::Constant => (l.constants, l.external, l.state) = (end, end, end),
                Region::External => (l.external, l.state) = (end, end),
                Region::State(f) => {
                    l.state = end;
                    extend_range(
                        &mut own[f.index()],
                        SlotRange {
                            start,
                            len: end - start,
                        },
                    );
                }
                Region::Value => {}
            }
            l.end = end;
        }
        layouts.states = with_descendants(net, own);
        layouts
    }

    /// Returns the index of the first memory slot of a register.
    pub(super) fn slot(&self, slot: Register) -> u32 {
        self.at[slot.index()]
    }

    /// Returns the initial contents of memory that are not zero, as slot index and bits, in ascending order of slots.
    pub(super) fn init(&self, flat: &FlatNet) -> Vec<(u32, u64)> {
        let cells = flat
            .registers
            .initial_contents()
            .map(|(slot, k, bits)| (self.slot(slot) + k, bits));
        let mut init: Vec<(u32, u64)> = cells.collect();
        init.sort_unstable();
        init
    }
}

/// Returns all registers in the order in which they lie in memory: constants, external values, state by fragment, other
/// values. `ranks` gives the order of the fragments.
fn order(slots: &Registers, ranks: &[(u32, u32)]) -> Vec<Register> {
    let all = (0..).take(slots.len()).map(Register);
    let of = |region: Region| all.clone().filter(move |s| slots.region(*s) == region);
    let rank = |s: &Register| match slots.region(*s) {
        Region::State(f) => Some(ranks[f.index()].0),
        Region::Constant | Region::External | Region::Value => None,
    };
    let mut order = Vec::with_capacity(slots.len());
    order.extend(of(Region::Constant).chain(of(Region::External)));
    let first = order.len();
    order.extend(all.clone().filter(|s| rank(s).is_some()));
    order[first..].sort_by_key(rank);
    order.extend(of(Region::Value));
    order
}

/// Returns, for each fragment, its position in a depth-first traversal of the fragments and the position after its last
/// descendant.
fn ranks(net: &Net) -> Vec<(u32, u32)> {
    let mut size = vec![1u32; net.fragments.len()];
    for id in net.fragment_ids().rev() {
        if let Some(parent) = net.fragment(id).parent {
            size[parent.index()] += size[id.index()];
        }
    }
    let mut next = vec![0u32; net.fragments.len()];
    let mut ranks = vec![(0, 0); net.fragments.len()];
    for id in net.fragment_ids() {
        let rank = match net.fragment(id).parent {
            None => 0,
            Some(parent) => {
                let rank = next[parent.index()];
                next[parent.index()] += size[id.index()];
                rank
            }
        };
        next[id.index()] = rank + 1;
        ranks[id.index()] = (rank, rank + size[id.index()]);
    }
    ranks
}

/// Returns, for each fragment, the smallest range of memory slots that contains its own state and that of all fragments
/// inside it. It contains no other state, because the registers lie in depth-first order. `own` is the range of each
/// fragment's own state.
fn with_descendants(net: &Net, own: Vec<SlotRange>) -> Vec<SlotRange> {
    let mut all = own;
    for k in (1..all.len()).rev() {
        let child = all[k];
        if let Some(FragmentId(parent)) = net.fragments[k].parent {
            extend_range(&mut all[parent as usize], child);
        }
    }
    all
}

/// Extends the range `all` to the smallest range that contains both. An empty range contributes no slots.
fn extend_range(all: &mut SlotRange, more: SlotRange) {
    if all.len == 0 {
        *all = more;
    } else if more.len > 0 {
        let (at, end) = (all.start.min(more.start), all.end().max(more.end()));
        *all = SlotRange {
            start: at,
            len: end - at,
        };
    }
}
