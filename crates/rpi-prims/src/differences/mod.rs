//! Where a recorded value of the reference system may differ from ours, and why.
//!
//! The reference has faults that are not imitated. Each is one entry of [`DIFFERENCES`]: which out-ports it concerns, when it
//! shows, in words what happens there and what is right, and the test that holds what is right. `rpi replay` takes a
//! single value from the trace only where an entry explains it; the chapter on differences is generated from the same
//! table. An entry must explain as little as it can: where a fault can be computed, the recorded value must be what it
//! gives.

mod faults;
mod table;

use crate::flow::Flow;
use rpi_image::{PrimDesc, Value};

pub use table::DIFFERENCES;

/// A fault of the reference that is not imitated.
#[derive(Clone, Copy, Debug)]
pub struct Difference {
    /// Short name.
    pub name: &'static str,
    /// Registered names of the primitives; one `*` stands for any text.
    pub types: &'static [&'static str],
    /// Their out-ports; one `*` stands for any text.
    pub ports: &'static [&'static str],
    /// When it shows.
    pub when: When,
    /// What the reference does.
    pub fault: &'static str,
    /// What is right.
    pub right: &'static str,
    /// Name of the test of what is right.
    pub test: &'static str,
}

/// When a fault shows.
#[derive(Clone, Copy, Debug)]
pub enum When {
    /// The recorded value is what the fault makes of the recorded inputs.
    Gives(fn(&Case<'_>) -> Option<Wrong>),
    /// The fault enters every value in a way that is not known exactly.
    Always,
    /// Nothing was recorded where there is a value.
    NothingRecorded,
    /// Nothing was recorded where there is a value, because not all in-ports are connected.
    NotAllConnected,
    /// The reference kept a reference to an object that its producer goes on using: parts of the recorded value are those of
    /// the current value of what the primitive reads.
    AliasedSource,
    /// An input comes from such an object, which may have changed between being read and being recorded.
    ReadsAliased,
    /// The fragment was inactive in the previous cycle, and nothing was recorded.
    FirstCycleAfterPause,
    /// The recorded text is no value of the port's type (an array with an absent element, another type).
    OtherType,
}

/// Most cells of a single value.
const WIDEST: usize = 8;

/// The cells that a fault gives.
#[derive(Clone, Copy, Debug)]
pub struct Wrong {
    cells: [u64; WIDEST],
    len: usize,
}

impl Wrong {
    /// The cells of a value.
    fn value<T: Flow>(value: T) -> Wrong {
        let mut cells = [0; WIDEST];
        value.store(&mut cells, 0);
        Wrong {
            cells,
            len: T::CELLS,
        }
    }

    /// The cells.
    #[must_use]
    pub fn cells(&self) -> &[u64] {
        &self.cells[..self.len]
    }
}

/// What was recorded at a port in a cycle.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Recorded<'a> {
    /// Nothing.
    Absent,
    /// A value.
    Value(&'a [u64]),
    /// A text that is no value of the port's type.
    Other,
}

/// A computed value that differs from the recorded one, and what is known around it.
#[derive(Clone, Copy, Debug)]
pub struct Case<'a> {
    /// The primitive.
    pub desc: &'a PrimDesc,
    /// Index of the out-port.
    pub port: usize,
    /// Period in seconds.
    pub dt: f64,
    /// Values of the in-ports in this cycle: as recorded at their sources, or of the parameters that stand in.
    pub inputs: &'a [Option<&'a [u64]>],
    /// Registered names of the primitives that the in-ports read; `None` where nothing is connected.
    pub sources: &'a [Option<&'a str>],
    /// Values recorded in this cycle at the out-ports that the first in-port reads, directly or through primitives that
    /// [pass objects on](passes_on).
    pub origins: &'a [&'a [u64]],
    /// Parameters in the order of the declaration.
    pub params: &'a [Value],
    /// What we compute.
    pub computed: Option<&'a [u64]>,
    /// What was recorded.
    pub recorded: Recorded<'a>,
    /// True if the fragment around was inactive in the previous cycle.
    pub after_pause: bool,
    /// True if an in-port reads, directly or through primitives that [pass objects on](passes_on), a value that
    /// [`When::AliasedSource`] explains in this cycle.
    pub reads_aliased: bool,
}

impl Case<'_> {
    /// The value of an in-port, if it was present.
    fn input<T: Flow>(&self, k: usize) -> Option<T> {
        let cells = self.inputs.get(k).copied().flatten()?;
        (cells.len() >= T::CELLS).then(|| T::load(cells, 0))
    }
}

/// In-ports that recorded nets connect though the primitive has no use for them, with their types.
pub const EXTRA_IN_PORTS: &[(&str, &str)] = &[("Core::IntArrayIsNull", "inNull")];

/// True if a primitive of the reference hands on the object that it reads, instead of a value of its own.
#[must_use]
pub fn passes_on(name: &str) -> bool {
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

/// True if some entry speaks of an out-port: its recorded value may be taken over in some cycle.
#[must_use]
pub fn concerns(desc: &PrimDesc, port: usize) -> bool {
    DIFFERENCES.iter().any(|entry| entry.speaks_of(desc, port))
}

/// The entry that explains a difference. `same` tells whether two values of the port are equal within the tolerance.
#[must_use]
pub fn explain(
    case: &Case<'_>,
    same: impl Fn(&[u64], &[u64]) -> bool,
) -> Option<&'static Difference> {
    let mut entries = DIFFERENCES
        .iter()
        .filter(|entry| entry.speaks_of(case.desc, case.port));
    entries.find(|entry| entry.when.holds(case, &same))
}

impl Difference {
    /// True if it concerns an out-port.
    #[must_use]
    pub fn speaks_of(&self, desc: &PrimDesc, port: usize) -> bool {
        let Some(port) = desc.outputs.get(port).map(|out| out.name) else {
            return false;
        };
        let types = self.types.iter().any(|pattern| matches(pattern, desc.name));
        types && self.ports.iter().any(|pattern| matches(pattern, port))
    }
}

impl When {
    fn holds(self, case: &Case<'_>, same: &impl Fn(&[u64], &[u64]) -> bool) -> bool {
        match (self, case.recorded) {
            (When::Gives(wrong), Recorded::Value(recorded)) => {
                wrong(case).is_some_and(|wrong| same(wrong.cells(), recorded))
            }
            (When::Always, Recorded::Value(_)) => case.computed.is_some(),
            (When::NothingRecorded, Recorded::Absent) => true,
            (When::NotAllConnected, Recorded::Absent) => case.sources.contains(&None),
            (When::AliasedSource, Recorded::Value(recorded)) => {
                faults::aliased(case, recorded, same)
            }
            (When::ReadsAliased, _) => case.reads_aliased,
            (When::FirstCycleAfterPause, Recorded::Absent) => case.after_pause,
            (When::OtherType, Recorded::Other) => true,
            _ => false,
        }
    }
}

/// True if a name fits a pattern in which one `*` stands for any text.
fn matches(pattern: &str, name: &str) -> bool {
    match pattern.split_once('*') {
        None => pattern == name,
        Some((start, end)) => {
            name.len() >= start.len() + end.len() && name.starts_with(start) && name.ends_with(end)
        }
    }
}
