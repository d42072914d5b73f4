//! Places for values before they have cell numbers.

use rpi_image::Value;
use rpi_net::FragmentId;
use std::collections::BTreeMap;

/// A place for one value: some cells side by side.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub(crate) struct Slot(pub(crate) u32);

impl Slot {
    /// Always 0: false, never present.
    pub(crate) const FALSE: Slot = Slot(0);
    /// Always 1: true, always present.
    pub(crate) const TRUE: Slot = Slot(1);

    pub(crate) const fn index(self) -> usize {
        self.0 as usize
    }
}

/// In which region of the memory a slot will lie.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) enum Region {
    Constant,
    External,
    /// Reset together with this fragment.
    State(FragmentId),
    Value,
}

/// All slots.
#[derive(Clone, Debug)]
pub(crate) struct Slots {
    cells: Vec<u32>,
    regions: Vec<Region>,
    /// Initial contents that are not zero.
    pub(crate) init: Vec<(Slot, Vec<u64>)>,
    constants: BTreeMap<Vec<u64>, Slot>,
}

impl Slots {
    /// The two Booleans.
    pub(crate) fn new() -> Self {
        let mut slots = Slots {
            cells: Vec::new(),
            regions: Vec::new(),
            init: Vec::new(),
            constants: BTreeMap::new(),
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

    /// A new slot.
    pub(crate) fn add(&mut self, region: Region, cells: u32) -> Slot {
        let slot = Slot(u32::try_from(self.cells.len()).expect("fewer than 2^32 slots"));
        self.cells.push(cells);
        self.regions.push(region);
        slot
    }

    /// A new slot that does not start as zero.
    pub(crate) fn add_with(&mut self, region: Region, content: &[u64]) -> Slot {
        let cells = u32::try_from(content.len()).expect("fewer than 2^32 cells");
        let slot = self.add(region, cells);
        if content.iter().any(|&bits| bits != 0) {
            self.init.push((slot, content.to_vec()));
        }
        slot
    }

    /// The slot of a constant; equal constants share one.
    pub(crate) fn constant(&mut self, content: &[u64]) -> Slot {
        if let Some(slot) = self.constants.get(content) {
            return *slot;
        }
        let slot = self.add_with(Region::Constant, content);
        self.constants.insert(content.to_vec(), slot);
        slot
    }

    /// The slot of a constant value; texts have none and give [`Slot::FALSE`].
    pub(crate) fn value(&mut self, value: &Value) -> Slot {
        match value {
            Value::Cells { cells, .. } => self.constant(cells),
            Value::Str(_) => Slot::FALSE,
        }
    }
}
