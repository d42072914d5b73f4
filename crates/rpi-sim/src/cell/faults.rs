//! Scheduled faults of an arm: `[[devices.NAME.faults]]`.

use super::quantity::Dimension::{Angle, Force, Time, Torque};
use super::reader::TableReader;
use crate::fault::{FaultKind, ScheduledFault};
use nalgebra::Vector6;

/// Function that reads the keys of one kind of simulated fault; the number is the number of axes of the arm.
type ReadFaultKind = fn(&mut TableReader<'_>, usize) -> Option<FaultKind>;

/// Kinds of simulated faults, by the value of the key `trouble`, each with the function that reads its other keys.
const FAULT_KINDS: &[(&str, ReadFaultKind)] = &[
    ("joint-failure", |reader, axes| {
        let axis = reader.index("axis", axes as u64);
        reader.require("axis", &format!("the range is 0 to {}", axes.max(1) - 1));
        let axis = axis?;
        Some(FaultKind::JointFailure(usize::try_from(axis).ok()?))
    }),
    ("emergency-stop", |_, _| Some(FaultKind::EmergencyStop)),
    ("lost-samples", |_, _| Some(FaultKind::LostSamples)),
    ("lost-set-points", |_, _| Some(FaultKind::LostSetPoints)),
    ("latency", |reader, _| {
        let delay = reader.magnitude("delay", Time);
        reader.require(
            "delay",
            "expected a time in s, or a string such as \"5 ms\"",
        );
        delay.map(FaultKind::Latency)
    }),
    ("noise", |reader, _| {
        let deviation = reader.magnitude("deviation", Angle);
        let help = "expected an angle in rad, or a string such as \"0.1 deg\"";
        reader.require("deviation", help);
        deviation.map(FaultKind::Noise)
    }),
    ("contact", |reader, _| {
        let force = reader
            .reals("force", Force, 3)
            .unwrap_or_else(|| vec![0.0; 3]);
        let torque = reader
            .reals("torque", Torque, 3)
            .unwrap_or_else(|| vec![0.0; 3]);
        let both = force.into_iter().chain(torque);
        Some(FaultKind::Contact(Vector6::from_iterator(both)))
    }),
];

pub(super) fn read(reader: &mut TableReader<'_>, axes: usize) -> Vec<ScheduledFault> {
    reader
        .tables("faults")
        .into_iter()
        .filter_map(|fault| read_one(fault, axes))
        .collect()
}

fn read_one(mut reader: TableReader<'_>, axes: usize) -> Option<ScheduledFault> {
    let words: Vec<&'static str> = FAULT_KINDS.iter().map(|(word, _)| *word).collect();
    let from = reader.magnitude("at", Time).unwrap_or(0.0);
    let until = reader
        .magnitude("for", Time)
        .map_or(f64::INFINITY, |duration| from + duration);
    let known = reader.variant("trouble", &words, |reader, word| {
        let (_, read) = FAULT_KINDS.iter().find(|(known, _)| *known == word)?;
        // A valid word with invalid keys is `Some(None)`: then, the other keys are still checked.
        Some(read(reader, axes))
    });
    let help = format!("expected one of {}", words.join(", "));
    reader.require("trouble", &help);
    let kind = known?;
    reader.finish();
    Some(ScheduledFault {
        from,
        until,
        kind: kind?,
    })
}
