//! Virtual registers: storage for values before memory slots are assigned.

use rpi_image::Value;
use rpi_net::FragmentId;
use rustc_hash::FxHashMap;
use std::collections::BTreeMap;

/// A virtual register: storage for one value, in one or more adjacent memory slots.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub(crate) struct Slot(pub(crate) u32);

impl Slot {
    /// The constant 0: false, or never present.
    pub(crate) const FALSE: Slot = Slot(0);
    /// The constant 1: true, or always present.
    pub(crate) const TRUE: Slot = Slot(1);

    pub(crate) const fn index(self) -> usize {
        self.0 as usize
    }
}

/// Memory region of a register.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) enum Region {
    Constant,
    External,
    /// Reset together with this fragment.
    State(FragmentId),
    Value,
}

/// All virtual registers of a net.
#[derive(Clone, Debug)]
pub(crate) struct Slots {
    cells: Vec<u32>,
    regions: Vec<Region>,
    /// For each register of one memory slot, its initial content.
    bits: Vec<u64>,
    /// Initial contents of larger registers that are not all zero.
    wide: BTreeMap<Slot, Vec<u64>>,
    /// Constants of one memory slot by content. Most constants are of this kind.
    constants: FxHashMap<u64, Slot>,
    /// Larger constants by content.
    wide_constants: FxHashMap<Vec<u64>, Slot>,
}

impl Slots {
    /// The registers of the two Booleans, with capacity for `room` registers.
    pub(crate) fn new(room: usize) -> Self {
        let mut slots = Slots {
            cells: Vec::with_capacity(room),
            regions: Vec::with_capacity(room),
            bits: Vec::with_capacity(room),
            wide: BTreeMap::new(),
            constants: FxHashMap::default(),
            wide_constants: FxHashMap::default(),
        };
        slots.constant(&[0]);
        slots.constant(&[1]);
        slots
    }

    pub(crate) fn len(&self) -> usize {
        self.cells.len()
    }

    pub(crate) fn cells(&self, slot: Slot) -> u32 {
        self.cells[slot.index()]
    }

    pub(crate) fn region(&self, slot: Slot) -> Region {
        self.regions[slot.index()]
    }

    /// Adds a register with initial content 0.
    pub(crate) fn add(&mut self, region: Region, cells: u32) -> Slot {
        let slot = Slot(u32::try_from(self.cells.len()).expect("fewer than 2^32 slots"));
        self.cells.push(cells);
        self.regions.push(region);
        self.bits.push(0);
        slot
    }

    /// Adds a register with this initial content.
    pub(crate) fn add_with(&mut self, region: Region, content: &[u64]) -> Slot {
        let cells = u32::try_from(content.len()).expect("fewer than 2^32 cells");
        let slot = self.add(region, cells);
        self.start(slot, content);
        slot
    }

    /// Sets the initial content of a register.
    pub(crate) fn start(&mut self, slot: Slot, content: &[u64]) {
        if let [bits] = content {
            self.bits[slot.index()] = *bits;
        } else if content.iter().any(|&bits| bits != 0) {
            self.wide.insert(slot, content.to_vec());
        }
    }

    /// The register of a constant; equal constants share one.
    pub(crate) fn constant(&mut self, content: &[u64]) -> Slot {
        let known = match content {
            [bits] => self.constants.get(bits),
            _ => self.wide_constants.get(content),
        };
        if let Some(slot) = known {
            return *slot;
        }
        let slot = self.add_with(Region::Constant, content);
        match content {
            [bits] => _ = self.constants.insert(*bits, slot),
            _ => _ = self.wide_constants.insert(content.to_vec(), slot),
        }
        slot
    }

    /// The register of a constant value; [`Slot::FALSE`] for strings, which have no memory.
    pub(crate) fn value(&mut self, value: &Value) -> Slot {
        match value {
            Value::Cells { cells, .. } => self.constant(cells),
            Value::Str(_) => Slot::FALSE,
        }
    }

    /// Appends the initial content of a register to `into`.
    pub(crate) fn content(&self, slot: Slot, into: &mut Vec<u64>) {
        match (self.cells(slot), self.wide.get(&slot)) {
            (1, _) => into.push(self.bits[slot.index()]),
            (_, Some(content)) => into.extend(content),
            (cells, None) => into.extend(std::iter::repeat_n(0, cells as usize)),
        }
    }

    /// All initial contents that are not zero: register, offset in it, bits.
    pub(crate) fn contents(&self) -> impl Iterator<Item = (Slot, u32, u64)> + '_ {
        let single = (0..).zip(&self.bits).map(|(k, bits)| (Slot(k), 0, *bits));
        let wide = self.wide.iter();
        let wide = wide.flat_map(|(slot, all)| (0..).zip(all).map(|(k, bits)| (*slot, k, *bits)));
        single.chain(wide).filter(|c| c.2 != 0)
    }
}
