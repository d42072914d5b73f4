//! Memory layout: constants, external values, state by fragment, values.

use crate::flat::Flat;
use crate::slots::{Region, Slot, Slots};
use rpi_image::image::{Cells, Layout};
use rpi_net::{FragmentId, Net};

/// Memory slots of all registers.
pub(super) struct Layouts {
    at: Vec<u32>,
    pub(super) layout: Layout,
    /// For each fragment, the state of itself and of all fragments inside it.
    pub(super) states: Vec<Cells>,
}

impl Layouts {
    pub(super) fn new(net: &Net, flat: &Flat) -> Self {
        let slots = &flat.slots;
        let mut layouts = Layouts {
            at: vec![0; slots.len()],
            layout: Layout::default(),
            states: Vec::new(),
        };
        let mut own = vec![Cells::default(); net.fragments.len()];
        let mut end = 0u32;
        for slot in order(slots, &ranks(net)) {
            layouts.at[slot.index()] = end;
            let start = end;
            end = end.saturating_add(slots.cells(slot));
            let l = &mut layouts.layout;
            match slots.region(slot) {
                Region::Constant => (l.constants, l.external, l.state) = (end, end, end),
                Region::External => (l.external, l.state) = (end, end),
                Region::State(f) => {
                    l.state = end;
                    join(
                        &mut own[f.index()],
                        Cells {
                            at: start,
                            len: end - start,
                        },
                    );
                }
                Region::Value => {}
            }
            l.cells = end;
        }
        layouts.states = with_children(net, own);
        layouts
    }

    /// First memory slot of a register.
    pub(super) fn cell(&self, slot: Slot) -> u32 {
        self.at[slot.index()]
    }

    /// Initial contents, in ascending order of slots.
    pub(super) fn init(&self, flat: &Flat) -> Vec<(u32, u64)> {
        let cells = flat
            .slots
            .contents()
            .map(|(slot, k, bits)| (self.cell(slot) + k, bits));
        let mut init: Vec<(u32, u64)> = cells.collect();
        init.sort_unstable();
        init
    }
}

/// All registers in memory order: constants, external values, state by fragment, values.
fn order(slots: &Slots, ranks: &[(u32, u32)]) -> Vec<Slot> {
    let all = (0..).take(slots.len()).map(Slot);
    let of = |region: Region| all.clone().filter(move |s| slots.region(*s) == region);
    let rank = |s: &Slot| match slots.region(*s) {
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

/// For each fragment, its position in a depth-first traversal and the position after its last descendant.
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

/// State of each fragment including all fragments inside it. The depth-first order makes it contiguous.
fn with_children(net: &Net, own: Vec<Cells>) -> Vec<Cells> {
    let mut all = own;
    for k in (1..all.len()).rev() {
        let child = all[k];
        if let Some(FragmentId(parent)) = net.fragments[k].parent {
            join(&mut all[parent as usize], child);
        }
    }
    all
}

/// Extends a range to the smallest one that contains both.
fn join(all: &mut Cells, more: Cells) {
    if all.len == 0 {
        *all = more;
    } else if more.len > 0 {
        let (at, end) = (all.at.min(more.at), all.end().max(more.end()));
        *all = Cells { at, len: end - at };
    }
}
