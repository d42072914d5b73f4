//! The flat image of a command: memory layout, steps, and tables of sensors, actuators, inputs and exports.
//!
//! Memory is one array of 64-bit slots in four regions (see [`Layout`]). Slot [`FALSE`] is always 0 and slot [`TRUE`]
//! is always 1, so every presence is a slot: the presence of a flow that is never absent is [`TRUE`]. Each cycle runs
//! [`Image::steps`] in order, then [`Image::commit`]. A [`Step::Skip`] jumps over inactive fragments. An image may come
//! from an untrusted file: nothing about it may be assumed before [`crate::verify()`] has accepted it.

pub use crate::debug_info::{DebugInfo, Probe, SourceLocation, TextRange};
use crate::desc::{CommandFlow, DeviceResponse};
use crate::external::ExternalFunction;
use crate::types::Type;
use alloc::string::String;
use alloc::vec::Vec;

/// Index of the slot that always holds 0: the constant false, and the presence of a flow that is never present.
pub const FALSE: u32 = 0;
/// Index of the slot that always holds 1: the constant true, and the presence of a flow that is always present.
pub const TRUE: u32 = 1;
/// Maximum memory of one command, in slots of 8 bytes (64 MiB). With this limit, loading any image takes at most 200
/// MB.
pub const MAX_SLOTS: u32 = 1 << 23;

/// Compiled command: memory layout, steps with their operands, and tables of the ports, flows and results.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Image {
    /// Name of the command.
    pub name: String,
    /// Period of the command, the time between two of its cycles, in ns. The sizes of states (such as windows in
    /// seconds) and the clocks are computed for this period.
    pub period_ns: u64,
    /// Length of a tick, the smallest time step of the core, in ns. The period is a whole multiple of it.
    pub tick_ns: u64,
    /// Ends of the four memory regions of the command.
    pub layout: Layout,
    /// Initial contents of the slots that do not start as 0: pairs of a slot index and its 64 bits, in ascending order
    /// of slots.
    pub init: Vec<(u32, u64)>,
    /// Primitives that the steps of the image call. [`Step::Run`] indexes this list.
    pub prims_used: Vec<PrimUse>,
    /// Operand words of all steps: indices of slots, and sizes. The steps refer to ranges of this list.
    pub code: Vec<u32>,
    /// Steps of the evaluation phase, in which a cycle computes its values, in order of execution.
    pub steps: Vec<Step>,
    /// Steps of the commit phase, which stores the state for the next cycle. Only [`Step::Skip`] and [`Step::Copy`]
    /// occur.
    pub commit: Vec<Step>,
    /// Fragments (parts of the net that are active only in some cycles), each after the fragment that encloses it. The
    /// first one is the root.
    pub fragments: Vec<Fragment>,
    /// Sensor ports, which the core reads before the evaluation phase.
    pub sensors: Vec<SensorPort>,
    /// Actuator ports used by [`Step::Actuate`].
    pub actuators: Vec<ActuatorPort>,
    /// Device functions used by [`Step::Call`].
    pub functions: Vec<DeviceFunction>,
    /// Flows that the host of the command sets between two cycles.
    pub inputs: Vec<InputPort>,
    /// Flows that the core publishes after each cycle.
    pub exports: Vec<Export>,
    /// Flows that the core provides before the evaluation phase, such as the time.
    pub flows: Vec<CoreFlow>,
    /// Conditions that end the command: named results, or ports of an imported net.
    pub end: CommandEnd,
    /// Source locations and observable ports. The evaluation of a cycle does not use them.
    pub debug: DebugInfo,
}

/// Ends of the four memory regions, as slot indices. The regions follow one another in the order of the fields:
/// constants, external slots, state, values.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Layout {
    /// Slot after the constants. The constants start at slot 0, and no step writes them.
    pub constants: u32,
    /// Slot after the external slots (samples of sensors, inputs, flows of the core). The core writes them before the
    /// evaluation phase; no step writes them.
    pub external: u32,
    /// Slot after the state. The state is preserved from one cycle to the next, and a reset of a fragment restores its
    /// initial content.
    pub state: u32,
    /// Slot after the values, which is the number of slots of the memory. At most one step writes a value slot, and it
    /// comes before every step that reads the slot.
    pub end: u32,
}

/// Primitive that an image calls, with a hash of the declaration for which the image was compiled.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct PrimUse {
    /// Name under which the primitive is registered, such as `Core::DoubleAdd`.
    pub name: String,
    /// Hash of the name, ports, parameters and state size of the primitive for which the image was compiled
    /// ([`crate::hash::prim_signature`]). The core rejects an image whose hash differs from that of its own primitive.
    pub signature: u64,
}

/// Variant of the code of a primitive: with or without support for absent values.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum Form {
    /// Variant for ports that are always present. Its operands contain no presence slots.
    Total,
    /// Variant for ports that may be absent. The operand of each port ends with the index of its presence slot.
    Optional,
}

/// Instruction of an image: a call of primitives, a copy, a jump or a device access.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Step {
    /// Calls a primitive once for each group of operand words in a range of [`Image::code`]. A group holds the operands
    /// of one call.
    Run {
        /// Primitive to call: an index into [`Image::prims_used`].
        prim: u16,
        /// Variant of the code of the primitive that the step calls.
        form: Form,
        /// Index of the first operand word in [`Image::code`].
        start: u32,
        /// Number of operand words: the number of calls times the number of words per call.
        len: u32,
    },
    /// Copies single slots. The operand words are pairs of indices: source slot, destination slot.
    Copy {
        /// Index of the first operand word in [`Image::code`].
        at: u32,
        /// Number of operand words: twice the number of copied slots.
        len: u32,
    },
    /// Jumps to step `target` if the Boolean slot `unless` is false; else continues with the next step.
    Skip {
        /// Index of the Boolean slot. The step jumps if the slot is false.
        unless: u32,
        /// Index of the step to jump to: a later step in the same list of steps.
        target: u32,
    },
    /// Restores the initial state of a fragment and of all fragments in it if the Boolean slot `unless` is false.
    Reset {
        /// Index of the Boolean slot. The step does nothing if the slot is true.
        unless: u32,
        /// Fragment to reset: an index into [`Image::fragments`].
        fragment: u32,
    },
    /// Checks a set-point and stores it until the write phase, which hands it over to the device.
    Actuate {
        /// Actuator port that receives the set-point: an index into [`Image::actuators`].
        actuator: u32,
    },
    /// Calls a function of a device, such as inverse kinematics.
    Call {
        /// Device function to call: an index into [`Image::functions`].
        function: u32,
    },
}

/// Adjacent slots of the memory of an image: index of the first one, and their number.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct SlotRange {
    /// Index of the first slot of the range.
    pub start: u32,
    /// Number of slots in the range.
    pub len: u32,
}

impl SlotRange {
    /// Returns the index of the slot after the range; at most `u32::MAX`.
    #[must_use]
    pub const fn end(self) -> u32 {
        self.start.saturating_add(self.len)
    }

    /// Returns the range as indices into the slots of the memory.
    #[must_use]
    pub const fn range(self) -> core::ops::Range<usize> {
        self.start as usize..self.end() as usize
    }
}

/// Location of a flow in memory: the slots of its value and the slot of its presence.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Signal {
    /// Index of the first slot that holds the value.
    pub start: u32,
    /// Index of the Boolean slot that is 1 while the flow has a value, else 0. It is [`TRUE`] for a flow that always
    /// has a value.
    pub present: u32,
    /// Type of the values of the flow. It gives the number of slots from `start` on.
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

/// Part of the net that runs only while it is active. An inactive fragment preserves its state.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Fragment {
    /// Path of the fragment from the root through the fragments around it, for example `outer/inner`; empty for the
    /// root.
    pub path: String,
    /// Index of the fragment that directly encloses this one, in [`Image::fragments`]; `None` for the root.
    pub parent: Option<u32>,
    /// Index of the Boolean slot that is true while the fragment is active. The fragment runs only if the enclosing
    /// fragments are active, too.
    pub active: u32,
    /// Slots of the state of the fragment, including the states of all fragments in it.
    pub state: SlotRange,
}

/// Port of a device, identified by the names of the device and of the port.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct DevicePort {
    /// Name of the device in the cell description.
    pub device: String,
    /// Name of the port within the device, such as `joint.position`.
    pub port: String,
    /// Index of the port if the device has several ports of this name, such as the number of an axis from 0; else 0.
    pub index: u32,
    /// Type of the value at the port; for a function, type of the result.
    pub ty: Type,
}

/// Sensor port of a device, read into external slots before the evaluation phase of each cycle.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct SensorPort {
    /// Device and port, such as `arm.position`, from which the core reads the value in each cycle.
    pub port: DevicePort,
    /// Slots that receive the sample. If the presence slot is [`TRUE`], a cycle without a sample raises a fault.
    pub value: Signal,
}

/// Actuator port of a device, to which [`Step::Actuate`] hands a set-point.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct ActuatorPort {
    /// Port of the device that the set-point drives.
    pub port: DevicePort,
    /// Slots of the set-point: the concatenation of these ranges.
    pub inputs: Vec<SlotRange>,
    /// Responses of the device to the set-point, each with the index of the slot that receives it.
    pub responses: Vec<(DeviceResponse, u32)>,
}

impl ActuatorPort {
    /// Returns the slot by which [`Image::location_of`] finds the source location of the actuator node: the slot of the
    /// first response, else the first slot of the set-point, else 0.
    #[must_use]
    pub fn origin_slot(&self) -> u32 {
        let answer = self.responses.first().map(|answer| answer.1);
        let input = self.inputs.first().map(|input| input.start);
        answer.or(input).unwrap_or(0)
    }
}

/// Function of a device that [`Step::Call`] calls.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct DeviceFunction {
    /// Device and name of the function, such as the planning of a motion by the arm.
    pub port: DevicePort,
    /// Slots of the arguments: the concatenation of these ranges.
    pub arguments: Vec<SlotRange>,
    /// Slots that receive the result: the concatenation of these ranges.
    pub results: Vec<SlotRange>,
    /// Index of the Boolean slot that becomes true if the device returns a result. If it is [`TRUE`], the result must
    /// be present and becomes NaN if the device returns none.
    pub present: u32,
    /// Upper bound of the work of the device for one call, in elementary operations (the addition of two reals is 1).
    pub work: u32,
    /// Signature in C if the function is not one of a device, but defined outside of the program. The arguments and
    /// results then have one range for each kind of values that occurs.
    pub external: Option<ExternalFunction>,
}

/// Flow that the host of the command sets between two cycles.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct InputPort {
    /// Name under which the host sets the flow.
    pub key: String,
    /// Unit of the values, such as `m/s`; empty if they have none.
    pub unit: String,
    /// Slots to which the core writes the value before each cycle.
    pub value: Signal,
    /// Slots that receive the logical time of the last update by the host; `None` if the program does not use the time.
    pub last_updated: Option<Signal>,
}

/// Flow that the core publishes after each cycle.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Export {
    /// Name under which the host reads the exported flow.
    pub key: String,
    /// Unit of the values, such as `m/s`; empty if they have none.
    pub unit: String,
    /// Slots of the value and presence of the flow that the core publishes.
    pub value: Signal,
}

/// Flow whose value the core provides to a command in each cycle, such as `time` or `cancel`.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct CoreFlow {
    /// Flow that the core provides, such as `time`, `cancel` or `takeover`.
    pub kind: CommandFlow,
    /// Slots to which the core writes the value of the flow before each cycle.
    pub value: Signal,
}

/// Conditions that end a command: named results in a program, ports in an imported net.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum CommandEnd {
    /// The command ends with a result whose condition is true. If several are true in a cycle, a `fail` result takes
    /// precedence, then the first one in source order.
    Results(Vec<NamedResult>),
    /// A true value at `terminate` ends the command. The value at `fail` is then its error number; 0 means no error. An
    /// absent value counts as false or 0.
    Ports {
        /// Boolean flow that ends the command if it is true; `None` if the net has no such port.
        terminate: Option<Signal>,
        /// Integer flow with the error number; `None` if the net has no such port.
        fail: Option<Signal>,
    },
}

impl Default for CommandEnd {
    fn default() -> Self {
        CommandEnd::Results(Vec::new())
    }
}

/// Named result of a command, with the condition that ends the command.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct NamedResult {
    /// Name of the result in the program.
    pub name: String,
    /// Whether the command finishes, fails or yields to its successor with this result.
    pub kind: CommandEndKind,
    /// Boolean flow that ends the command with this result if it is true. An absent value counts as false.
    pub condition: Signal,
}

/// Meaning of a result with which a command ends: normal end, takeover by a successor, or error.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum CommandEndKind {
    /// The command is done, and all its resources are at rest.
    Finish,
    /// The command is done, but its resources may be in motion: a successor must take over.
    Yield,
    /// The command ends with an error.
    Fail,
}

impl Image {
    /// Returns the source location of the node that raised a fault. `cell` is the first output slot of its primitive,
    /// as reported with the fault. Returns `None` for another slot.
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

    /// Returns the source location of the first node that hands a set-point to `device`; `None` if no node does.
    #[must_use]
    pub fn location_of_device(&self, device: &str) -> Option<&SourceLocation> {
        let mut actuators = self.actuators.iter();
        let actuator = actuators.find(|a| a.port.device == device)?;
        self.location_of(actuator.origin_slot())
    }

    /// Returns the approximate memory of the image in bytes, including its lists and texts.
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

    /// Returns the name of an observable port: the path of its node, a dot and the name of the port.
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
