//! The flat image of a command: memory layout, steps, and tables of sensors, actuators, inputs and exports.
//!
//! Memory is one array of 64-bit slots in four regions (see [`Layout`]). Slot [`FALSE`] is always 0 and slot [`TRUE`]
//! is always 1, so every presence is a slot: the presence of a flow that is never absent is [`TRUE`]. Each cycle runs
//! [`Image::steps`] in order, then [`Image::commit`]. A [`Step::Skip`] jumps over inactive fragments. An image may come
//! from an untrusted file: nothing about it may be assumed before [`crate::verify()`] has accepted it.

pub use crate::debug_info::{DebugInfo, Probe, SourceLocation, TextRange};
use crate::desc::{CommandFlow, DeviceResponse};
use crate::types::Type;
use alloc::string::String;
use alloc::vec::Vec;

/// Slot that always holds 0: the constant false, and the presence of a flow that is never present.
pub const FALSE: u32 = 0;
/// Slot that always holds 1: the constant true, and the presence of a flow that is always present.
pub const TRUE: u32 = 1;
/// Upper bound of the memory of one command, in slots (64 MiB). It limits the memory used by loading any image to 200
/// MB.
pub const MAX_SLOTS: u32 = 1 << 23;

/// Compiled command: a flat list of steps with its slots, ports and results.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Image {
    /// Name of the command.
    pub name: String,
    /// Period, ns. State sizes (windows) and clocks are laid out for it.
    pub period_ns: u64,
    /// Length of a tick, ns: the unit of values of type `time`. The period is a whole multiple of it.
    pub tick_ns: u64,
    /// Ends of the memory regions of the command.
    pub layout: Layout,
    /// Initial contents of slots that do not start as 0: (slot, bits), in ascending order of slots.
    pub init: Vec<(u32, u64)>,
    /// Primitives that the steps of the image call.
    pub prims_used: Vec<PrimUse>,
    /// Operand words of all steps.
    pub code: Vec<u32>,
    /// Steps of the evaluation phase.
    pub steps: Vec<Step>,
    /// Steps of the commit phase: only [`Step::Skip`] and [`Step::Copy`].
    pub commit: Vec<Step>,
    /// Fragments, each after its parent. The first one is the root.
    pub fragments: Vec<Fragment>,
    /// Sensor ports, read before evaluation.
    pub sensors: Vec<SensorPort>,
    /// Actuator ports used by [`Step::Actuate`].
    pub actuators: Vec<ActuatorPort>,
    /// Device functions used by [`Step::Call`].
    pub functions: Vec<DeviceFunction>,
    /// Flows set from outside between cycles.
    pub inputs: Vec<InputPort>,
    /// Flows published after each cycle.
    pub exports: Vec<Export>,
    /// Flows provided by the core before evaluation.
    pub flows: Vec<CoreFlow>,
    /// Named results or ports by which the command ends.
    pub end: CommandEnd,
    /// Source locations and observable ports. A cycle does not use them.
    pub debug: DebugInfo,
}

/// Ends of the memory regions, in ascending order: constants, external slots, state, values.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Layout {
    /// End of the constants. The region starts at slot 0 and is never written.
    pub constants: u32,
    /// End of the external slots (sensors, inputs, flows of the core). They are written only between evaluations.
    pub external: u32,
    /// End of the state: the slots kept from cycle to cycle, which a reset restores.
    pub state: u32,
    /// End of the values, and number of slots. Each value is written by exactly one step before it is read.
    pub end: u32,
}

/// Primitive that an image calls, with the declaration it was compiled for.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct PrimUse {
    /// Registered name.
    pub name: String,
    /// Signature of the declaration for which the image was compiled ([`crate::hash::prim_signature`]).
    pub signature: u64,
}

/// Variant of the code of a primitive.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum Form {
    /// Code for ports that are always present; the operands hold no presence words.
    Total,
    /// Code for ports that may be absent; each port has a presence word.
    Optional,
}

/// Instruction of an image: a call of primitives, a copy, a jump or a device access.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Step {
    /// Calls a primitive once for each group of operand words in the range of [`Image::code`].
    Run {
        /// Index into [`Image::prims_used`].
        prim: u16,
        /// Variant of the code.
        form: Form,
        /// Index of the first operand word in [`Image::code`].
        start: u32,
        /// Number of operand words: a multiple of the words per group.
        len: u32,
    },
    /// Copies single slots. The operand words are pairs (source, destination).
    Copy {
        /// Index of the first operand word in [`Image::code`].
        at: u32,
        /// Number of operand words: twice the number of slots.
        len: u32,
    },
    /// Jumps to step `to` unless the Boolean slot `unless` is true.
    Skip {
        /// Slot of the Boolean; the step jumps if it is false.
        unless: u32,
        /// Index of a later step in the same list.
        target: u32,
    },
    /// Resets the state of a fragment and of all fragments in it, unless the Boolean slot `unless` is true.
    Reset {
        /// Slot of the Boolean; the step does nothing if it is true.
        unless: u32,
        /// Index into [`Image::fragments`].
        fragment: u32,
    },
    /// Checks a set-point and stages it for the write phase.
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

/// Adjacent slots of the memory of an image: index of the first one, and their number.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct SlotRange {
    /// First slot.
    pub start: u32,
    /// Number of slots.
    pub len: u32,
}

impl SlotRange {
    /// Returns the slot after the last one; saturates at `u32::MAX`.
    #[must_use]
    pub const fn end(self) -> u32 {
        self.start.saturating_add(self.len)
    }

    /// Returns the range as indices into the memory.
    #[must_use]
    pub const fn range(self) -> core::ops::Range<usize> {
        self.start as usize..self.end() as usize
    }
}

/// Location of a flow in memory.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Signal {
    /// First slot of the value.
    pub start: u32,
    /// Boolean slot of the presence.
    pub present: u32,
    /// Type of the flow's values, which decides the number of slots.
    pub ty: Type,
}

impl Signal {
    /// Returns the consecutive slots that hold the value, without the slot of its presence.
    #[must_use]
    pub const fn slots(self) -> SlotRange {
        SlotRange {
            start: self.start,
            len: self.ty.slots(),
        }
    }
}

/// Fragment: a part of the net that runs only while it is active.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Fragment {
    /// Path from the root, for example `outer/inner`; empty for the root.
    pub path: String,
    /// Index of the enclosing fragment; `None` for the root.
    pub parent: Option<u32>,
    /// Boolean slot: true while the fragment is active. The fragment runs only if its parent is active, too.
    pub active: u32,
    /// State of the fragment, including that of all fragments in it.
    pub state: SlotRange,
}

/// Device port, identified by name.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct DevicePort {
    /// Name of the device in the cell description.
    pub device: String,
    /// Name of the port within the device, such as `joint.position`.
    pub port: String,
    /// Index among several equal ports; 0 if there is only one.
    pub index: u32,
    /// Type of the value; for a function, type of the result.
    pub ty: Type,
}

/// Sensor port, read into external slots before evaluation.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct SensorPort {
    /// Port that is read.
    pub port: DevicePort,
    /// Destination of the sample. If its presence is [`TRUE`], a missing sample is a fault.
    pub value: Signal,
}

/// Actuator port, set by [`Step::Actuate`].
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct ActuatorPort {
    /// Port of the device that the set-point drives.
    pub port: DevicePort,
    /// Set-point: the concatenation of these slots.
    pub inputs: Vec<SlotRange>,
    /// Responses of the device, each with the value slot that receives it.
    pub responses: Vec<(DeviceResponse, u32)>,
}

impl ActuatorPort {
    /// Returns the slot by which [`Image::location_of`] finds the node: the first response, else the first input, else 0.
    #[must_use]
    pub fn origin_slot(&self) -> u32 {
        let answer = self.responses.first().map(|answer| answer.1);
        let input = self.inputs.first().map(|input| input.start);
        answer.or(input).unwrap_or(0)
    }
}

/// Function of a device, called by [`Step::Call`].
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct DeviceFunction {
    /// Port that is called.
    pub port: DevicePort,
    /// Arguments: the concatenation of these slots.
    pub arguments: Vec<SlotRange>,
    /// Destination of the result: the concatenation of these slots.
    pub results: Vec<SlotRange>,
    /// Boolean slot that receives the presence of the result. If it is [`TRUE`], a missing result becomes not-a-number.
    pub present: u32,
    /// Bound of the device's work for a call, in elementary operations (a real addition is 1).
    pub work: u32,
}

/// Flow set from outside between cycles.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct InputPort {
    /// Name under which the host sets the input.
    pub key: String,
    /// Destination of the value.
    pub value: Signal,
    /// Destination of the logical time of the last update; `None` if it is not used.
    pub last_updated: Option<Signal>,
}

/// Flow published after each cycle.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Export {
    /// Name under which the host reads the exported flow.
    pub key: String,
    /// Published flow.
    pub value: Signal,
}

/// Flow provided by the core.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct CoreFlow {
    /// Which flow it is, such as `time`, `cancel` or `takeover`.
    pub kind: CommandFlow,
    /// Destination of the value.
    pub value: Signal,
}

/// Way in which a command ends: by named results in programs, by ports in imported nets.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum CommandEnd {
    /// Named results, in source order.
    Results(Vec<NamedResult>),
    /// Ports: a true `terminate` ends the command, and a `fail` other than 0 is its error number. Absence means false
    /// and 0.
    Ports {
        /// Boolean that ends the command.
        terminate: Option<Signal>,
        /// Error number (int).
        fail: Option<Signal>,
    },
}

impl Default for CommandEnd {
    fn default() -> Self {
        CommandEnd::Results(Vec::new())
    }
}

/// Named result of a command.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct NamedResult {
    /// Name of the result.
    pub name: String,
    /// Kind of the result.
    pub kind: CommandEndKind,
    /// Boolean that ends the command with this result; absence means false.
    pub condition: Signal,
}

/// What it means that a command ends with a result.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum CommandEndKind {
    /// All resources are at rest.
    Finish,
    /// Resources may be in motion; a successor must take over.
    Yield,
    /// The command ends with an error.
    Fail,
}

impl Image {
    /// Returns the source location for a fault at `cell`, the first output slot of a primitive.
    #[must_use]
    pub fn location_of(&self, cell: u32) -> Option<&SourceLocation> {
        let found = self
            .debug
            .origins
            .binary_search_by_key(&cell, |o| o.0)
            .ok()?;
        self.debug
            .locations
            .get(self.debug.origins.get(found)?.1 as usize)
    }

    /// Returns the source location of the first node that sets a port of `device`.
    #[must_use]
    pub fn location_of_device(&self, device: &str) -> Option<&SourceLocation> {
        let mut actuators = self.actuators.iter();
        let actuator = actuators.find(|a| a.port.device == device)?;
        self.location_of(actuator.origin_slot())
    }

    /// Returns the approximate memory of the image, in bytes, including its lists and texts.
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        let ports = self.sensors.iter().map(|s| &s.port);
        let ports = ports.chain(self.actuators.iter().map(|a| &a.port));
        let ports = ports.chain(self.functions.iter().map(|f| &f.port));
        let texts = ports.map(|p| p.device.len() + p.port.len()).sum::<usize>()
            + self.prims_used.iter().map(|p| p.name.len()).sum::<usize>()
            + self.fragments.iter().map(|f| f.path.len()).sum::<usize>()
            + self.inputs.iter().map(|i| i.key.len()).sum::<usize>()
            + self.exports.iter().map(|e| e.key.len()).sum::<usize>()
            + self.debug.text_len();
        let parts = self.actuators.iter().map(|a| size_of_val(&*a.inputs));
        let arguments = self.functions.iter();
        let arguments = arguments.map(|f| size_of_val(&*f.arguments) + size_of_val(&*f.results));
        let lists = size_of_val(&*self.init)
            + size_of_val(&*self.prims_used)
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
            + self.debug.list_bytes();
        size_of_val(self) + texts + lists + parts.chain(arguments).sum::<usize>()
    }

    /// Returns the name of a probe, `path.port`.
    #[must_use]
    pub fn probe_name(&self, probe: &Probe) -> String {
        let path = self
            .debug
            .locations
            .get(probe.location as usize)
            .map_or("", |p| p.path.as_str());
        alloc::format!("{path}.{}", probe.port)
    }
}
