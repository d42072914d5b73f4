//! Values of all ports of a net over the cycles before a question.

use std::collections::{BTreeMap, VecDeque};

use rpi_core::Instance;
use rpi_image::image::{Image, Signal};
use rpi_net::{Net, NodeId, PortRef};
use rpi_runtime::run::fault_text;

/// Maximum memory for the values, in 64-bit words: 256 MiB.
const MAX_WORDS: usize = 1 << 25;

/// Values of the ports in one cycle.
struct Frame {
    /// Number of the cycle of the command, counted from 0.
    cycle: u64,
    /// Value of each probe in the layout of [`History::places`], and whether it is present.
    words: Box<[u64]>,
    present: Box<[bool]>,
    /// For each fragment of the image, whether it was active.
    active: Box<[bool]>,
    /// Fault that ended the command in this cycle: the slot of the value that could not be computed, and the reason.
    fault: Option<(u32, &'static str)>,
}

/// Values of all ports of a command in its last cycles, as far as they fit into memory.
pub struct History {
    /// For each port, its probe: an index into `places`.
    probes: BTreeMap<(u32, u8), usize>,
    /// For each probe, its place in memory, its fragment, and where its value begins in a frame.
    places: Vec<(Signal, u32, usize)>,
    words: usize,
    frames: VecDeque<Frame>,
}

impl History {
    /// Creates an empty history of a command with this image, in which all ports of `net` can be observed.
    #[must_use]
    pub fn new(net: &Net, image: &Image) -> History {
        let mut history = History {
            probes: BTreeMap::new(),
            places: Vec::new(),
            words: 0,
            frames: VecDeque::new(),
        };
        for probe in &image.debug.probes {
            let outputs = net.node(NodeId(probe.location)).desc().outputs;
            let port = outputs.iter().position(|output| output.name == probe.port);
            let Some(port) = port.and_then(|port| u8::try_from(port).ok()) else {
                continue;
            };
            history
                .probes
                .insert((probe.location, port), history.places.len());
            history
                .places
                .push((probe.value, probe.fragment, history.words));
            history.words += probe.value.ty.slots() as usize;
        }
        history
    }

    /// Adds the values of a cycle that has been evaluated, before its delays are stored. The oldest cycles are dropped if there is no room.
    pub fn add(&mut self, instance: &Instance) {
        let fragments = instance.image().fragments.len();
        let active = (0..).map(|k| instance.is_active(k));
        let active: Box<[bool]> = active.take(fragments).collect();
        let mut words = vec![0; self.words].into_boxed_slice();
        let mut present = vec![false; self.places.len()].into_boxed_slice();
        for (k, &(signal, fragment, at)) in self.places.iter().enumerate() {
            let value = instance.value(signal).filter(|_| active[fragment as usize]);
            if let Some(value) = value {
                present[k] = true;
                words[at..at + value.len()].copy_from_slice(value);
            }
        }
        let frame = self.words + self.places.len() / 8 + 8;
        if self.frames.len() >= (MAX_WORDS / frame).max(2) {
            self.frames.pop_front();
        }
        let fault = instance.fault();
        self.frames.push_back(Frame {
            cycle: instance.cycle(),
            words,
            present,
            active,
            fault: fault.map(|fault| (fault.slot, fault_text(fault.code))),
        });
    }

    /// Returns the number of the last cycle; `None` if there is none.
    #[must_use]
    pub fn last_cycle(&self) -> Option<u64> {
        self.frames.back().map(|frame| frame.cycle)
    }

    fn frame(&self, cycle: u64) -> Option<&Frame> {
        let first = self.frames.front()?.cycle;
        let index = usize::try_from(cycle.checked_sub(first)?).ok()?;
        self.frames.get(index).filter(|frame| frame.cycle == cycle)
    }

    /// Returns whether the values of a cycle are known.
    pub(super) fn knows(&self, cycle: u64) -> bool {
        self.frame(cycle).is_some()
    }

    /// Returns the value of a port in a cycle as memory words; `None` if the port was absent.
    pub(super) fn value(&self, port: PortRef, cycle: u64) -> Option<&[u64]> {
        let probe = *self.probes.get(&(port.node.0, port.port))?;
        let frame = self.frame(cycle)?;
        let (signal, _, at) = self.places[probe];
        frame.present[probe].then(|| &frame.words[at..at + signal.ty.slots() as usize])
    }

    /// Returns the reason why the value of a port could not be computed in a cycle; `None` if it was.
    pub(super) fn fault(&self, port: PortRef, cycle: u64) -> Option<&'static str> {
        let probe = *self.probes.get(&(port.node.0, port.port))?;
        let (slot, reason) = self.frame(cycle)?.fault?;
        (self.places[probe].0.start == slot).then_some(reason)
    }

    /// Returns whether a fragment, by its number in the image, was active in a cycle.
    pub(super) fn is_active(&self, fragment: u32, cycle: u64) -> bool {
        let frame = self.frame(cycle);
        frame.is_some_and(|frame| frame.active.get(fragment as usize) == Some(&true))
    }
}
