//! What came out of a replay.

use serde::Serialize;

/// What came out of a replay.
#[derive(Clone, PartialEq, Debug, Default, Serialize)]
pub struct Report {
    /// The net.
    pub net: String,
    /// Number of cycles replayed.
    pub cycles: u64,
    /// Values that were recorded and computed, and absences.
    pub compared: Agreed,
    /// Of these, how many differ, and no documented difference explains it.
    pub differing: u64,
    /// Values taken from the trace because they came from outside.
    pub taken: u64,
    /// Values not compared because something they depend on is not in the trace in that cycle.
    pub unknown: u64,
    /// Angles near gimbal lock or written a full turn apart, taken over as they were written.
    pub rewritten: u64,
    /// Values taken from the trace because a documented difference explains them.
    pub explained: Vec<Explained>,
    /// The largest deviation of a value that agrees.
    pub worst: Option<Worst>,
    /// The first value that differs, and what led to it.
    pub first: Option<Divergence>,
    /// All ports with differing values, in order of their first one.
    pub ports: Vec<PortTally>,
    /// Ports of the trace that the net does not have.
    pub unmatched: Vec<String>,
    /// What was added to the numbers in the trace's generated names so that they are the net's; mostly 0.
    pub renumbered: i64,
    /// The fault that ended the net, if one did.
    pub fault: Option<Fault>,
}

/// How much was compared.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Serialize)]
pub struct Agreed {
    /// Values that were present in the trace.
    pub values: u64,
    /// Absences in the trace.
    pub absences: u64,
}

/// An entry of the table of differences and what it explains.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct Explained {
    /// The entry.
    pub entry: &'static str,
    /// Why the systems differ.
    pub why: &'static str,
    /// How many values it explains.
    pub values: u64,
    /// The ports, in order of their first such value.
    pub ports: Vec<String>,
}

/// A value that agrees, but not to the bit.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Worst {
    /// The cycle, from 1.
    pub cycle: u64,
    /// The port's path.
    pub port: String,
    /// How far apart.
    pub deviation: f64,
    /// What was computed.
    pub computed: String,
    /// What was recorded.
    pub recorded: String,
}

/// A value that differs.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Divergence {
    /// The cycle, from 1.
    pub cycle: u64,
    /// The port and the ports that it was computed from, each with what it is off by: the first link is the differing
    /// port itself, each next one an input of the one before, back to where values begin to differ.
    pub path: Vec<Link>,
}

/// A port on the way to a divergence.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Link {
    /// The port's path.
    pub port: String,
    /// The primitive's registered name.
    pub primitive: String,
    /// What was computed; `null` for an absent value.
    pub computed: String,
    /// What was recorded, if it was.
    pub recorded: Option<String>,
    /// How far apart, if both are there.
    pub deviation: Option<f64>,
    /// The cycle in which this port first was off, by however little.
    pub since: Option<u64>,
    /// What it read: in-port, where from, value.
    pub inputs: Vec<(String, String, String)>,
}

/// How often a port differs.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct PortTally {
    /// The port's path.
    pub port: String,
    /// The primitive's registered name.
    pub primitive: String,
    /// How many of its values differ.
    pub values: u64,
    /// The first cycle in which it does.
    pub first_cycle: u64,
    /// The largest deviation; none if it was there in one run and absent in the other.
    pub worst: Option<f64>,
}

/// A fault that ended a net.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct Fault {
    /// The cycle, from 1.
    pub cycle: u64,
    /// What happened.
    pub code: String,
    /// The node to which it happened.
    pub place: String,
}

impl Report {
    /// True if nothing differs.
    #[must_use]
    pub fn agrees(&self) -> bool {
        self.differing == 0 && self.unmatched.is_empty()
    }
}
