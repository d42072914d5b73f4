//! Report of a trace replay.

use serde::Serialize;

/// Report on the replay of a net against a trace: counts of agreeing and deviating values, and the first deviation.
#[derive(Clone, PartialEq, Debug, Default, Serialize)]
pub struct CompareReport {
    /// Name of the net that was replayed.
    pub net: String,
    /// Number of replayed cycles.
    pub cycles: u64,
    /// Numbers of compared values and absences.
    pub compared: ComparedCounts,
    /// Number of deviating values that no documented difference explains.
    pub differing: u64,
    /// Number of values that were taken from the trace as inputs instead of being computed.
    pub taken: u64,
    /// Number of recorded values that were not compared, because the computed ones depend on values that the trace does
    /// not have in that cycle.
    pub unknown: u64,
    /// Number of computed angles that were replaced by the recorded ones because they were equal in another notation
    /// (near gimbal lock or a full turn apart).
    pub rewritten: u64,
    /// Documented differences to the reference system (the control core of the Robotics API), with the number of
    /// deviating values that each explains.
    pub explained: Vec<ExplainedDifference>,
    /// Largest deviation within the tolerance; `None` if all values are equal.
    pub worst: Option<LargestDeviation>,
    /// First deviating value that is not explained, and the path of ports that led to it; `None` if there is none.
    pub first: Option<Divergence>,
    /// All ports with unexplained deviating values, in order of their first deviation.
    pub ports: Vec<PortDeviations>,
    /// Names of the trace's ports that do not exist in the net.
    pub unmatched: Vec<String>,
    /// Offset that was added to the numbers in the generated names of the trace so that they match the net; usually 0.
    pub renumbered: i64,
    /// Fault that ended the net, so that later cycles are not compared; `None` if there was none.
    pub fault: Option<ReplayFault>,
}

/// Numbers of compared values, present and absent.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Serialize)]
pub struct ComparedCounts {
    /// Number of compared values that were present in the trace.
    pub values: u64,
    /// Number of compared values that were absent in the trace.
    pub absences: u64,
}

/// A documented difference to the reference system (the control core of the Robotics API), and the number of deviating
/// values that it explains.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct ExplainedDifference {
    /// Name of the documented difference, such as `sine-is-cosine`.
    pub entry: &'static str,
    /// Cause of the difference: what the reference system computes.
    pub why: &'static str,
    /// Number of deviating values that the difference explains.
    pub values: u64,
    /// Names of the ports with explained values, in order of their first one.
    pub ports: Vec<String>,
}

/// The largest deviation of a computed value from the recorded one that is within the tolerance.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct LargestDeviation {
    /// Cycle of the replay with this deviation, counted from 1.
    pub cycle: u64,
    /// Full name of the port, `path.port`.
    pub port: String,
    /// Difference of the computed and the recorded value: absolute for values up to 1, relative for larger ones.
    pub deviation: f64,
    /// Value that the replay computed, as a literal.
    pub computed: String,
    /// Value in the trace, as a literal.
    pub recorded: String,
}

/// First deviating value of a replay, with the path of ports that led to it.
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
    /// Full name of the port, `path.port`.
    pub port: String,
    /// Name of the primitive of the port's node; empty for a port that only shows the value of another port.
    pub primitive: String,
    /// Value that the net computed, as a literal; `null` if absent.
    pub computed: String,
    /// Value in the trace, as a literal; `None` if the trace has none.
    pub recorded: Option<String>,
    /// Difference of the computed and the recorded value: absolute for values up to 1, relative for larger ones. `None`
    /// if one of them is missing.
    pub deviation: Option<f64>,
    /// First cycle in which the port deviated from the trace by any amount, counted from 1; `None` if it did not.
    pub since: Option<u64>,
    /// Inputs of the port's node: name of the in-port, name of its source, and value as text.
    pub inputs: Vec<(String, String, String)>,
}

/// Deviations of one port from the trace: number, first cycle and largest one.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct PortDeviations {
    /// Full name of the port, `path.port`.
    pub port: String,
    /// Name of the primitive of the port's node; empty for a port that only shows the value of another port.
    pub primitive: String,
    /// Number of values at the port that deviate without an explanation.
    pub values: u64,
    /// First cycle with a deviation, counted from 1.
    pub first_cycle: u64,
    /// Largest difference from the recorded value: absolute for values up to 1, relative for larger ones. `None` if
    /// only the presence differed.
    pub worst: Option<f64>,
}

/// Fault that ended a net during a replay.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct ReplayFault {
    /// Cycle of the fault, counted from 1.
    pub cycle: u64,
    /// Name of the kind of fault, such as `DivisionByZero`.
    pub code: String,
    /// Path of the node that raised the fault; empty if it is unknown.
    pub place: String,
}

impl CompareReport {
    /// Returns true if no value deviates without an explanation, the net has all ports of the trace, and no fault ended
    /// the comparison before the end of the trace.
    #[must_use]
    pub fn agrees(&self) -> bool {
        self.differing == 0 && self.unmatched.is_empty() && self.fault.is_none()
    }
}
