//! Report of a trace replay.

use serde::Serialize;

/// Report of a trace replay.
#[derive(Clone, PartialEq, Debug, Default, Serialize)]
pub struct CompareReport {
    /// Name of the net.
    pub net: String,
    /// Number of replayed cycles.
    pub cycles: u64,
    /// Number of compared values and absences.
    pub compared: ComparedCounts,
    /// Number of deviating values that no documented difference explains.
    pub differing: u64,
    /// Number of input values taken from the trace instead of being computed.
    pub taken: u64,
    /// Number of values not compared because they depend on a value that the trace does not have in that cycle.
    pub unknown: u64,
    /// Number of angles taken from the trace because they were equal in another notation (near gimbal lock or a full
    /// turn apart).
    pub rewritten: u64,
    /// Values taken from the trace because a documented difference explains them.
    pub explained: Vec<ExplainedDifference>,
    /// Largest deviation within the tolerance.
    pub worst: Option<LargestDeviation>,
    /// First deviating value and the path that led to it.
    pub first: Option<Divergence>,
    /// All ports with deviating values, in order of their first deviation.
    pub ports: Vec<PortDeviations>,
    /// Ports of the trace that do not exist in the net.
    pub unmatched: Vec<String>,
    /// Offset that was added to the numbers in the generated names of the trace; usually 0.
    pub renumbered: i64,
    /// Fault that ended the net, if any.
    pub fault: Option<ReplayFault>,
}

/// Number of compared values, present and absent.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Serialize)]
pub struct ComparedCounts {
    /// Number of values that were present in the trace.
    pub values: u64,
    /// Number of absences in the trace.
    pub absences: u64,
}

/// A documented difference between the systems and the values that it explains.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct ExplainedDifference {
    /// Name of the documented difference.
    pub entry: &'static str,
    /// Cause of the difference.
    pub why: &'static str,
    /// Number of explained values.
    pub values: u64,
    /// Ports with explained values, in order of their first one.
    pub ports: Vec<String>,
}

/// The largest deviation within the tolerance.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct LargestDeviation {
    /// Cycle of the replay with this deviation, counted from 1.
    pub cycle: u64,
    /// Path of the port.
    pub port: String,
    /// Absolute difference of the computed and the recorded value, in the unit of the port.
    pub deviation: f64,
    /// Value that the replay computed, as a literal.
    pub computed: String,
    /// Value in the trace, as a literal.
    pub recorded: String,
}

/// First deviating value of a replay.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Divergence {
    /// Cycle of the first deviating value, counted from 1.
    pub cycle: u64,
    /// Path from the deviating port backwards: each link is an input of the previous one. The last link is the port at
    /// which the deviation begins.
    pub path: Vec<DivergenceLink>,
}

/// Port on the path of deviating ports that leads to a divergence, with its values.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct DivergenceLink {
    /// Path of the port.
    pub port: String,
    /// Registered name of the primitive.
    pub primitive: String,
    /// Computed value; `null` if absent.
    pub computed: String,
    /// Recorded value, if any.
    pub recorded: Option<String>,
    /// Difference of the computed and the recorded value, in the unit of the port; `None` if one of them is absent.
    pub deviation: Option<f64>,
    /// First cycle in which the port deviated by any amount.
    pub since: Option<u64>,
    /// Inputs of the node: in-port, source, value.
    pub inputs: Vec<(String, String, String)>,
}

/// Deviations of one port from the trace: number, first cycle and largest one.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct PortDeviations {
    /// Path of the port.
    pub port: String,
    /// Registered name of the primitive.
    pub primitive: String,
    /// Number of deviating values.
    pub values: u64,
    /// First cycle with a deviation.
    pub first_cycle: u64,
    /// Largest difference from the recorded value, in the unit of the port; `None` if only the presence differed.
    pub worst: Option<f64>,
}

/// Fault that ended a net during a replay.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct ReplayFault {
    /// Cycle of the fault, counted from 1.
    pub cycle: u64,
    /// Name of the fault code.
    pub code: String,
    /// Path of the node that raised the fault.
    pub place: String,
}

impl CompareReport {
    /// Returns true if no value deviates and the net has all ports of the trace.
    #[must_use]
    pub fn agrees(&self) -> bool {
        self.differing == 0 && self.unmatched.is_empty()
    }
}
