//! Virtual registers: storage for values before memory slots are assigned.

use rpi_image::Value;
use rpi_net::FragmentId;
use rustc_hash::FxHashMap;
use std::collections::BTreeMap;

/// A virtual register: storage for one value, in one or more adjacent memory slots.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub(crate) struct Register(pub(crate) u32);

impl Register {
    /// The constant 0: false, or never present.
    pub(crate) const FALSE: Register = Register(0);
    /// The constant 1: true, or always present.
    pub(crate) const TRUE: Register = Register(1);

    pub(crate) const fn index(self) -> usize {
        self.0 as usize
    }
}

/// Memory region of a register.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) enum Region {
    Constant,
    External,
    /// State that is reset together with this fragment.
    State(FragmentId),
    Value,
}

/// All virtual registers of a net.
#[derive(Clone, Debug)]
pub(crate) struct Registers {
    sizes: Vec<u32>,
    regions: Vec<Region>,
    /// For each register of one memory slot, its initial content.
    initial_bits: Vec<u64>,
    /// Initial contents of larger registers that are not all zero.
    wide_initial: BTreeMap<Register, Vec<u64>>,
    /// Constants of one memory slot by content. Most constants are of this kind.
    constants: FxHashMap<u64, Register>,
    /// Larger constants by content.
    wide_constants: FxHashMap<Vec<u64>, Register>,
}

impl Registers {
    /// The table with the registers of the two Boolean constants, and capacity for `room` registers.
    pub(crate) fn new(room: usize) -> Self {
        let mut slots = Registers {
            sizes: Vec::with_capacity(room),
            regions: Vec::with_capacity(room),
            initial_bits: Vec::with_capacity(room),
            wide_initial: BTreeMap::new(),
            constants: FxHashMap::default(),
            wide_constants: FxHashMap::default(),
        };
        slots.constant(&[0]);
        slots.constant(&[1]);
        slots
    }

    pub(crate) fn len(&self) -> usize {
        self.sizes.len()
    }

    pub(crate) fn size(&self, slot: Register) -> u32 {
        self.sizes[slot.index()]
    }

    pub(crate) fn region(&self, slot: Register) -> Region {
        self.regions[slot.index()]
    }

    /// Adds a register with initial content 0.
    pub(crate) fn add(&mut self, region: Region, cells: u32) -> Register {
        let slot = Register(u32::try_from(self.sizes.len()).expect("fewer than 2^32 slots"));
        self.sizes.push(cells);
        self.regions.push(region);
        self.initial_bits.push(0);
        slot
    }

    /// Adds a register of a region that has these slot values when the image is loaded. Returns it.
    pub(crate) fn add_with_initial(&mut self, region: Region, content: &[u64]) -> Register {
        let cells = u32::try_from(content.len()).expect("fewer than 2^32 cells");
        let slot = self.add(region, cells);
        self.set_initial(slot, content);
        slot
    }

    /// Sets the slot values that a register has when the image is loaded.
    pub(crate) fn set_initial(&mut self, slot: Register, content: &[u64]) {
        if let [bits] = content {
            self.initial_bits[slot.index()] = *bits;
        } else if content.iter().any(|&bits| bits != 0) {
            self.wide_initial.insert(slot, content.to_vec());
        }
    }

    /// The register of a constant; equal constants share one.
    pub(crate) fn constant(&mut self, content: &[u64]) -> Register {
        let known = match content {
            [bits] => self.constants.get(bits),
            _ => self.wide_constants.get(content),
        };
        if let Some(slot) = known {
            return *slot;
        }
        let slot = self.add_with_initial(Region::Constant, content);
        match content {
            [bits] => _ = self.constants.insert(*bits, slot),
            _ => _ = self.wide_constants.insert(content.to_vec(), slot),
        }
        slot
    }

    /// The register of a constant value; [`Register::FALSE`] for strings, which have no memory.
    pub(crate) fn value(&mut self, value: &Value) -> Register {
        match value {
            Value::Slots { cells, .. } => self.constant(cells),
            Value::Str(_) => Register::FALSE,
        }
    }

    /// Appends the initial content of a register to `into`.
    pub(crate) fn append_initial(&self, slot: Register, into: &mut Vec<u64>) {
        match (self.size(slot), self.wide_initial.get(&slot)) {
            (1, _) => into.push(self.initial_bits[slot.index()]),
            (_, Some(content)) => into.extend(content),
            (cells, None) => into.extend(std::iter::repeat_n(0, cells as usize)),
        }
    }

    /// All initial contents that are not zero: register, offset in it, bits.
    pub(crate) fn initial_contents(&self) -> impl Iterator<Item = (Register, u32, u64)> + '_ {
        let single = (0..)
            .zip(&self.initial_bits)
            .map(|(k, bits)| (Register(k), 0, *bits));
        let wide = self.wide_initial.iter();
        let wide = wide.flat_map(|(slot, all)| (0..).zip(all).map(|(k, bits)| (*slot, k, *bits)));
        single.chain(wide).filter(|c| c.2 != 0)
    }
}
