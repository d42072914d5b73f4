//! The flat image of a command: memory, steps, and the tables that tie them to the outside.
//!
//! Memory is one run of 64-bit cells in four regions (see [`Layout`]). Cell [`FALSE`] is always 0 and cell [`TRUE`]
//! always 1, so that a presence is always a cell: a flow that can never be absent names [`TRUE`].
//! [`Image::steps`] are run in order in every cycle, then [`Image::commit`]; a [`Step::Skip`] jumps over what is inactive.
//! An image comes from a compiler, a file or an enemy: nothing may be relied on before [`crate::verify()`] has passed it.

use crate::desc::{Answer, CommandFlow};
use crate::ty::Type;
use alloc::string::String;
use alloc::vec::Vec;

/// The cell that is always 0: false, and the presence of a flow that is never present.
pub const FALSE: u32 = 0;
/// The cell that is always 1: true, and the presence of a flow that is always present.
pub const TRUE: u32 = 1;
/// Largest memory of one command, in cells (64 MiB): loading one, whatever it says of itself, takes less than 200 MB.
pub const MAX_CELLS: u32 = 1 << 23;

/// A compiled command.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Image {
    /// The command's name.
    pub name: String,
    /// Period in nanoseconds; windows and clocks were laid out for it.
    pub period_ns: u64,
    /// Length of a tick, nanoseconds, which values of the type `time` count; the period is a whole multiple of it.
    pub tick_ns: u64,
    /// Where the regions of the memory end.
    pub layout: Layout,
    /// Cells that do not start as 0, ascending.
    pub init: Vec<(u32, u64)>,
    /// The primitives that [`Step::Run`] names.
    pub prims: Vec<PrimUse>,
    /// Operand words.
    pub code: Vec<u32>,
    /// The evaluation phase.
    pub steps: Vec<Step>,
    /// The commit phase: skips and copies only.
    pub commit: Vec<Step>,
    /// Fragments, parents first; the first is the root.
    pub fragments: Vec<Fragment>,
    /// What is read from devices before evaluation.
    pub sensors: Vec<Sensor>,
    /// What [`Step::Actuate`] names.
    pub actuators: Vec<Actuator>,
    /// What [`Step::Call`] names.
    pub functions: Vec<Function>,
    /// What is set from outside between cycles.
    pub inputs: Vec<InputPort>,
    /// What is published after a cycle.
    pub exports: Vec<Export>,
    /// What the core provides before evaluation.
    pub flows: Vec<Flow>,
    /// How the command ends.
    pub end: End,
    /// Where nodes come from, for messages.
    pub places: Vec<Place>,
    /// Which place a fault belongs to: (first output cell of the primitive, index into `places`), ascending.
    pub origins: Vec<(u32, u32)>,
    /// Every port that can be looked at, in net order; empty unless lowered to be observed.
    pub probes: Vec<Probe>,
    /// For each step the place whose node it computes, or `u32::MAX`; empty unless lowered to be observed.
    pub trace: Vec<u32>,
}

/// Ends of the memory regions, ascending: constants, external cells, state, values.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Layout {
    /// Constants are the cells before it. Never written.
    pub constants: u32,
    /// External cells (sensors, inputs, flows of the core) follow up to here. Written between evaluations only.
    pub external: u32,
    /// State follows up to here: what is kept from cycle to cycle, and all that a reset restores.
    pub state: u32,
    /// Values follow up to here: written by exactly one step before they are read.
    pub cells: u32,
}

/// A primitive that the image uses.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct PrimUse {
    /// Registered name.
    pub name: String,
    /// [`crate::hash::signature`] of the declaration that the image was made for.
    pub signature: u64,
}

/// Which code of a primitive runs.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum Form {
    /// All ports are present for sure; no presence words.
    Total,
    /// Each port has a presence word.
    Optional,
}

/// One step: a row of work, or a jump.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Step {
    /// Runs a row of equal primitives on `code[at..at + len]`.
    Run {
        /// Index into [`Image::prims`].
        prim: u16,
        /// Which code.
        form: Form,
        /// First operand word.
        at: u32,
        /// Number of operand words: a multiple of the group size.
        len: u32,
    },
    /// Copies single cells: `code[at..at + len]` holds pairs (from, to).
    Copy {
        /// First word.
        at: u32,
        /// Number of words.
        len: u32,
    },
    /// Jumps to step `to` unless the cell is true.
    Skip {
        /// A Boolean cell.
        unless: u32,
        /// A later step of the same list.
        to: u32,
    },
    /// Gives a fragment and all below it its initial state unless the cell is true.
    Reset {
        /// A Boolean cell.
        unless: u32,
        /// Index into [`Image::fragments`].
        fragment: u32,
    },
    /// Checks and stages a set-point.
    Actuate {
        /// Index into [`Image::actuators`].
        actuator: u32,
    },
    /// Calls a function of a device.
    Call {
        /// Index into [`Image::functions`].
        function: u32,
    },
}

/// A run of cells.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Cells {
    /// First cell.
    pub at: u32,
    /// Number of cells.
    pub len: u32,
}

impl Cells {
    /// The cell after the last; saturates.
    #[must_use]
    pub const fn end(self) -> u32 {
        self.at.saturating_add(self.len)
    }

    /// As a range of indices.
    #[must_use]
    pub const fn range(self) -> core::ops::Range<usize> {
        self.at as usize..self.end() as usize
    }
}

/// A flow in memory.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Signal {
    /// First cell.
    pub at: u32,
    /// Its presence: a Boolean cell.
    pub present: u32,
    /// Its type.
    pub ty: Type,
}

impl Signal {
    /// Its value cells.
    #[must_use]
    pub const fn cells(self) -> Cells {
        Cells {
            at: self.at,
            len: self.ty.cells(),
        }
    }
}

/// A fragment as far as it matters at run time.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Fragment {
    /// Path from the root, `outer/inner`; empty for the root.
    pub path: String,
    /// The enclosing fragment; none for the root.
    pub parent: Option<u32>,
    /// True while it is active, provided that its parent is.
    pub active: u32,
    /// All state of it and of the fragments below it.
    pub state: Cells,
}

/// A port of a device, by name.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct DevicePort {
    /// The device, as the cell description names it.
    pub device: String,
    /// The port of the device.
    pub port: String,
    /// Which of several equal ones; 0 where there is one.
    pub index: u32,
    /// Type of the value; of the result for functions.
    pub ty: Type,
}

/// A sensor port, read before evaluation into external cells.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Sensor {
    /// What is read.
    pub port: DevicePort,
    /// Where to. A present cell of [`TRUE`] makes a missing sample a fault.
    pub value: Signal,
}

/// An actuator port, set by [`Step::Actuate`].
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Actuator {
    /// What is set.
    pub port: DevicePort,
    /// The set-point: these cells one after the other.
    pub inputs: Vec<Cells>,
    /// The device's answers and the value cells that they go to.
    pub answers: Vec<(Answer, u32)>,
}

impl Actuator {
    /// The cell by which its node is found among the places.
    #[must_use]
    pub fn cell(&self) -> u32 {
        let answer = self.answers.first().map(|answer| answer.1);
        let input = self.inputs.first().map(|input| input.at);
        answer.or(input).unwrap_or(0)
    }
}

/// A function of a device, called by [`Step::Call`].
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Function {
    /// What is called.
    pub port: DevicePort,
    /// The arguments: these cells one after the other.
    pub arguments: Vec<Cells>,
    /// Where the result goes: into these cells one after the other.
    pub results: Vec<Cells>,
    /// Where it is told whether there was a result. [`TRUE`] makes a missing one not-a-number.
    pub present: u32,
}

/// A flow that is set from outside between cycles.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct InputPort {
    /// Its key.
    pub key: String,
    /// Where it is put.
    pub value: Signal,
    /// Where the logical time of the last update goes, if somebody reads it.
    pub updated: Option<Signal>,
}

/// A flow that is published after a cycle.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Export {
    /// Its key.
    pub key: String,
    /// The flow.
    pub value: Signal,
}

/// A flow that the core provides.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Flow {
    /// Which.
    pub flow: CommandFlow,
    /// Where it is put.
    pub value: Signal,
}

/// How a command ends.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum End {
    /// By named results, in text order.
    Results(Vec<EndResult>),
    /// By ports: a true `terminate` ends it, `fail` is its error number (0: none). Absent means false and 0.
    Ports {
        /// Ends the command.
        terminate: Option<Signal>,
        /// Its error number.
        fail: Option<Signal>,
    },
}

impl Default for End {
    fn default() -> Self {
        End::Results(Vec::new())
    }
}

/// A named result.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct EndResult {
    /// Its name.
    pub name: String,
    /// Its kind.
    pub kind: EndKind,
    /// The Boolean that asks for it; absent means false.
    pub condition: Signal,
}

/// Kinds of results.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum EndKind {
    /// Everything at rest.
    Finish,
    /// Maybe in motion, only into a successor.
    Yield,
    /// With an error.
    Fail,
}

/// Where a node comes from.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Place {
    /// Path through the fragments to the node, `outer/inner/node`.
    pub path: String,
    /// The flow's name as its author knows it, if it has one.
    pub flow: Option<String>,
    /// Where it stands in a source text, if there is one.
    pub text: Option<TextRange>,
}

impl Place {
    fn text_len(&self) -> usize {
        self.path.len() + self.flow.as_ref().map_or(0, String::len)
    }
}

/// A range of bytes in a source text; the compiler that made the image knows the files.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct TextRange {
    /// Number of the file.
    pub file: u32,
    /// First byte.
    pub start: u32,
    /// Byte after the last.
    pub end: u32,
}

/// A port that can be looked at.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Probe {
    /// Index into [`Image::places`]: the node.
    pub place: u32,
    /// Registered name of the port.
    pub port: String,
    /// Where it is; its presence counts only while its fragment and all that enclose it are active.
    pub value: Signal,
    /// Index into [`Image::fragments`].
    pub fragment: u32,
}

impl Image {
    /// The place to which a fault at `cell` belongs.
    #[must_use]
    pub fn place_of(&self, cell: u32) -> Option<&Place> {
        let found = self.origins.binary_search_by_key(&cell, |o| o.0).ok()?;
        self.places.get(self.origins.get(found)?.1 as usize)
    }

    /// The place of the first node that sets this device.
    #[must_use]
    pub fn place_of_device(&self, device: &str) -> Option<&Place> {
        let mut actuators = self.actuators.iter();
        let actuator = actuators.find(|a| a.port.device == device)?;
        self.place_of(actuator.cell())
    }

    /// About how many bytes of memory it takes: its lists and the texts in them.
    #[must_use]
    pub fn footprint(&self) -> usize {
        let ports = self.sensors.iter().map(|s| &s.port);
        let ports = ports.chain(self.actuators.iter().map(|a| &a.port));
        let ports = ports.chain(self.functions.iter().map(|f| &f.port));
        let texts = ports.map(|p| p.device.len() + p.port.len()).sum::<usize>()
            + self.prims.iter().map(|p| p.name.len()).sum::<usize>()
            + self.fragments.iter().map(|f| f.path.len()).sum::<usize>()
            + self.inputs.iter().map(|i| i.key.len()).sum::<usize>()
            + self.exports.iter().map(|e| e.key.len()).sum::<usize>()
            + self.probes.iter().map(|p| p.port.len()).sum::<usize>()
            + self.places.iter().map(Place::text_len).sum::<usize>();
        let parts = self.actuators.iter().map(|a| size_of_val(&*a.inputs));
        let arguments = self.functions.iter();
        let arguments = arguments.map(|f| size_of_val(&*f.arguments) + size_of_val(&*f.results));
        let lists = size_of_val(&*self.init)
            + size_of_val(&*self.prims)
            + size_of_val(&*self.code)
            + size_of_val(&*self.steps)
            + size_of_val(&*self.commit)
            + size_of_val(&*self.fragments)
            + size_of_val(&*self.sensors)
            + size_of_val(&*self.actuators)
            + size_of_val(&*self.functions)
            + size_of_val(&*self.inputs)
            + size_of_val(&*self.exports)
            + size_of_val(&*self.flows)
            + size_of_val(&*self.places)
            + size_of_val(&*self.origins)
            + size_of_val(&*self.probes)
            + size_of_val(&*self.trace);
        size_of_val(self) + texts + lists + parts.chain(arguments).sum::<usize>()
    }

    /// `path.port` of a probe.
    #[must_use]
    pub fn probe_name(&self, probe: &Probe) -> String {
        let path = self
            .places
            .get(probe.place as usize)
            .map_or("", |p| p.path.as_str());
        alloc::format!("{path}.{}", probe.port)
    }
}
