//! Differences between recorded values of the reference system and computed values, with their causes.
//!
//! The reference system has faults that are not imitated. [`DIFFERENCES`] has one entry per fault: the affected
//! out-ports, the condition, the fault and the correct behaviour in words, and the test of the correct behaviour. `rpi
//! replay` accepts a recorded value only if an entry explains it. The documentation of differences is generated from
//! the same table. An entry should explain as few values as possible: if a fault can be computed, the recorded value
//! must equal its result.

mod fault_models;
mod table;

use crate::value_types::FlowType;
use rpi_image::{PrimDesc, Value};

pub use table::DIFFERENCES;

/// Known fault of the reference system that this project does not imitate, and how to recognise it in a recording.
#[derive(Clone, Copy, Debug)]
pub struct Difference {
    /// Short name of the fault.
    pub name: &'static str,
    /// Registered names of the affected primitives; one `*` matches any text.
    pub types: &'static [&'static str],
    /// Names of the affected out-ports; one `*` matches any text.
    pub ports: &'static [&'static str],
    /// Condition under which the fault explains a recorded value.
    pub condition: Condition,
    /// Behaviour of the reference system, in words.
    pub fault: &'static str,
    /// Correct behaviour, in words.
    pub correct: &'static str,
    /// Name of the test of this project that checks the correct behaviour.
    pub test: &'static str,
}

/// Condition under which a known fault of the reference system explains a recorded value.
#[derive(Clone, Copy, Debug)]
pub enum Condition {
    /// The recorded value equals the result of the fault model for the recorded inputs.
    FaultModel(fn(&DifferenceCase<'_>) -> Option<FaultyValue>),
    /// The fault affects every value, in a way that cannot be computed.
    Always,
    /// No value is recorded, although there should be one.
    NothingRecorded,
    /// No value is recorded, although there should be one, because not all in-ports are connected.
    NotAllConnected,
    /// The recorded value is partly a later one: the reference system passed on a reference to an object that its
    /// producer continues to modify. Each part of the recorded value equals that part of the computed value or of a
    /// current input.
    AliasedSource,
    /// An input is an object that its producer continues to modify (see [`Condition::AliasedSource`]). It may have
    /// changed between its use and its recording, so any recorded value is accepted.
    ReadsAliased,
    /// No value is recorded, and the enclosing fragment was inactive in the previous cycle.
    FirstCycleAfterPause,
    /// The recorded text is not a value of the type of the port (an array with an absent element, or another type).
    OtherType,
}

/// Maximum number of slots of a value that is no array or matrix.
const MAX_SLOTS: usize = 8;

/// Value that a fault model computes, as 64-bit slots.
#[derive(Clone, Copy, Debug)]
pub struct FaultyValue {
    cells: [u64; MAX_SLOTS],
    len: usize,
}

impl FaultyValue {
    /// Creates the result of a fault model from a value.
    fn value<T: FlowType>(value: T) -> FaultyValue {
        let mut cells = [0; MAX_SLOTS];
        value.store(&mut cells, 0);
        FaultyValue {
            cells,
            len: T::SLOTS,
        }
    }

    /// Returns the slots of the faulty value.
    #[must_use]
    pub fn cells(&self) -> &[u64] {
        &self.cells[..self.len]
    }
}

/// Content of a port in a cycle of a recording of the reference system.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Recorded<'a> {
    /// No value was recorded for the port in the cycle.
    Absent,
    /// Present value, as the content of its 64-bit slots.
    Value(&'a [u64]),
    /// Text that is not a value of the type of the port.
    Other,
}

/// Computed value that differs from the recorded one, with all facts by which a known fault may explain it.
#[derive(Clone, Copy, Debug)]
pub struct DifferenceCase<'a> {
    /// Declaration of the primitive that computes the value.
    pub desc: &'a PrimDesc,
    /// Index of the out-port of the primitive.
    pub port: usize,
    /// Period of the command, in s.
    pub dt: f64,
    /// Values of the in-ports in this cycle, by index: those recorded at their sources, or those of the parameters that
    /// replace them. `None` if absent.
    pub inputs: &'a [Option<&'a [u64]>],
    /// Registered names of the primitives that the in-ports read; `None` for an in-port that is not connected.
    pub sources: &'a [Option<&'a str>],
    /// Values, recorded in this cycle, of the primitives from which the first in-port gets its object, directly or
    /// through primitives that pass it on.
    pub origins: &'a [&'a [u64]],
    /// Values of the parameters, in the order of the declaration.
    pub params: &'a [Value],
    /// Slots of the value that this project computes in the cycle; `None` if the flow is absent.
    pub computed: Option<&'a [u64]>,
    /// Value that the reference system recorded in the same cycle.
    pub recorded: Recorded<'a>,
    /// True if the enclosing fragment was inactive in the previous cycle.
    pub after_pause: bool,
    /// True if an in-port reads, directly or through primitives that [pass objects on](outputs_alias), a value that
    /// [`Condition::AliasedSource`] explains in this cycle.
    pub reads_aliased: bool,
}

impl DifferenceCase<'_> {
    /// Returns the value of the in-port with index `k`; `None` if it is absent or has fewer slots than the type.
    fn input<T: FlowType>(&self, k: usize) -> Option<T> {
        let cells = self.inputs.get(k).copied().flatten()?;
        (cells.len() >= T::SLOTS).then(|| T::load(cells, 0))
    }
}

/// In-ports that recorded nets connect although the primitive does not have them: name of the primitive and of the
/// in-port.
pub const IGNORED_IN_PORTS: &[(&str, &str)] = &[("Core::IntArrayIsNull", "inNull")];

/// Returns true if a primitive of the reference system outputs the object that it reads, not a copy.
#[must_use]
pub fn outputs_alias(name: &str) -> bool {
    const HAND_ON: [&str; 7] = [
        "World::*SetNull",
        "World::*Conditional",
        "World::*Pre",
        "World::*AtTime",
        "World::FrameToPosRot",
        "World::FrameFromPosRot",
        "World::TwistToVelocities",
    ];
    HAND_ON.iter().any(|pattern| matches(pattern, name))
}

/// Returns true if a known fault of the reference system affects an out-port, so that recorded values may be accepted
/// although they differ from the computed ones.
#[must_use]
pub fn has_difference(desc: &PrimDesc, port: usize) -> bool {
    DIFFERENCES.iter().any(|entry| entry.applies_to(desc, port))
}

/// Returns the known fault of the reference system that explains a difference; `None` if there is none. `same` returns
/// true if two values of the port are equal within the tolerance.
#[must_use]
pub fn explain(
    case: &DifferenceCase<'_>,
    same: impl Fn(&[u64], &[u64]) -> bool,
) -> Option<&'static Difference> {
    let mut entries = DIFFERENCES
        .iter()
        .filter(|entry| entry.applies_to(case.desc, case.port));
    entries.find(|entry| entry.condition.holds(case, &same))
}

impl Difference {
    /// Returns true if the known fault affects the out-port with index `port` of a primitive.
    #[must_use]
    pub fn applies_to(&self, desc: &PrimDesc, port: usize) -> bool {
        let Some(port) = desc.outputs.get(port).map(|out| out.name) else {
            return false;
        };
        let types = self.types.iter().any(|pattern| matches(pattern, desc.name));
        types && self.ports.iter().any(|pattern| matches(pattern, port))
    }
}

impl Condition {
    fn holds(self, case: &DifferenceCase<'_>, same: &impl Fn(&[u64], &[u64]) -> bool) -> bool {
        match (self, case.recorded) {
            (Condition::FaultModel(wrong), Recorded::Value(recorded)) => {
                wrong(case).is_some_and(|wrong| same(wrong.cells(), recorded))
            }
            (Condition::Always, Recorded::Value(_)) => case.computed.is_some(),
            (Condition::NothingRecorded, Recorded::Absent) => true,
            (Condition::NotAllConnected, Recorded::Absent) => case.sources.contains(&None),
            (Condition::AliasedSource, Recorded::Value(recorded)) => {
                fault_models::aliased(case, recorded, same)
            }
            (Condition::ReadsAliased, _) => case.reads_aliased,
            (Condition::FirstCycleAfterPause, Recorded::Absent) => case.after_pause,
            (Condition::OtherType, Recorded::Other) => true,
            _ => false,
        }
    }
}

/// Returns true if a name matches a pattern in which one `*` matches any text.
fn matches(pattern: &str, name: &str) -> bool {
    match pattern.split_once('*') {
        None => pattern == name,
        Some((start, end)) => {
            name.len() >= start.len() + end.len() && name.starts_with(start) && name.ends_with(end)
        }
    }
}
