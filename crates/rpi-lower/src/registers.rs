//! Virtual registers: storage for values before memory slots are assigned.

use rpi_image::Value;
use rpi_net::FragmentId;
use rustc_hash::FxHashMap;
use std::collections::BTreeMap;

/// Index of a virtual register: storage for one value, which is assigned one or more adjacent memory slots when the
/// image is written.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub(crate) struct Register(pub(crate) u32);

impl Register {
    /// Register of the constant 0; as a Boolean: false, as a presence: never present.
    pub(crate) const FALSE: Register = Register(0);
    /// Register of the constant 1; as a Boolean: true, as a presence: always present.
    pub(crate) const TRUE: Register = Register(1);

    pub(crate) const fn index(self) -> usize {
        self.0 as usize
    }
}

/// Region of the image's memory in which a register is placed.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) enum Region {
    Constant,
    External,
    /// State that lasts from cycle to cycle and is reset when this fragment is reset.
    State(FragmentId),
    Value,
}

/// Sizes, regions and initial contents of all virtual registers of a net, by register number.
#[derive(Clone, Debug)]
pub(crate) struct Registers {
    sizes: Vec<u32>,
    regions: Vec<Region>,
    /// For each register, its initial content if it has one memory slot; else 0.
    initial_bits: Vec<u64>,
    /// Initial contents of registers with more than one memory slot, unless all slots are zero.
    wide_initial: BTreeMap<Register, Vec<u64>>,
    /// Registers of the constants that have one memory slot, by content. Most constants are of this kind.
    constants: FxHashMap<u64, Register>,
    /// Registers of the constants that have no or several memory slots, by content.
    wide_constants: FxHashMap<Vec<u64>, Register>,
}

impl Registers {
    /// Creates a table with the registers of the constants 0 and 1, and capacity for `room` registers.
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

    /// Adds a register of `cells` memory slots with initial content 0, and returns it.
    pub(crate) fn add(&mut self, region: Region, cells: u32) -> Register {
        let slot = Register(u32::try_from(self.sizes.len()).expect("fewer than 2^32 slots"));
        self.sizes.push(cells);
        self.regions.push(region);
        self.initial_bits.push(0);
        slot
    }

    /// Adds a register with as many memory slots as `content` has, which contain these values when the image is loaded.
    /// Returns the register.
    pub(crate) fn add_with_initial(&mut self, region: Region, content: &[u64]) -> Register {
        let cells = u32::try_from(content.len()).expect("fewer than 2^32 cells");
        let slot = self.add(region, cells);
        self.set_initial(slot, content);
        slot
    }

    /// Sets the values that the memory slots of a register have when the image is loaded, one entry of `content` per
    /// slot. Without an entry a register contains zeros.
    pub(crate) fn set_initial(&mut self, slot: Register, content: &[u64]) {
        if let [bits] = content {
            self.initial_bits[slot.index()] = *bits;
        } else if content.iter().any(|&bits| bits != 0) {
            self.wide_initial.insert(slot, content.to_vec());
        } else {
            self.wide_initial.remove(&slot);
        }
    }

    /// Returns the register of a constant with these slot values. Equal constants share one register.
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

    /// Returns the register of a constant value; [`Register::FALSE`] for a text, which needs no memory at run time.
    pub(crate) fn value(&mut self, value: &Value) -> Register {
        match value {
            Value::Slots { cells, .. } => self.constant(cells),
            Value::Str(_) => Register::FALSE,
        }
    }

    /// Appends the initial content of a register, one entry per memory slot, to `into`.
    pub(crate) fn append_initial(&self, slot: Register, into: &mut Vec<u64>) {
        match (self.size(slot), self.wide_initial.get(&slot)) {
            (1, _) => into.push(self.initial_bits[slot.index()]),
            (_, Some(content)) => into.extend(content),
            (cells, None) => into.extend(std::iter::repeat_n(0, cells as usize)),
        }
    }

    /// Returns all initial contents that are not zero: register, index of the memory slot in the register, bits.
    pub(crate) fn initial_contents(&self) -> impl Iterator<Item = (Register, u32, u64)> + '_ {
        let single = (0..)
            .zip(&self.initial_bits)
            .map(|(k, bits)| (Register(k), 0, *bits));
        let wide = self.wide_initial.iter();
        let wide = wide.flat_map(|(slot, all)| (0..).zip(all).map(|(k, bits)| (*slot, k, *bits)));
        single.chain(wide).filter(|c| c.2 != 0)
    }
}
