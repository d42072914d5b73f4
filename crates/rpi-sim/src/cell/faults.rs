//! Scheduled faults of an arm: `[[devices.NAME.faults]]`.

use super::quantity::Dimension::{Angle, Force, Time, Torque};
use super::reader::TableReader;
use crate::fault::{FaultKind, ScheduledFault};
use nalgebra::Vector6;

/// Function that reads the keys of one kind of fault; the number is the number of axes.
type ReadFaultKind = fn(&mut TableReader<'_>, usize) -> Option<FaultKind>;

/// Kinds of faults by the value of the key `trouble`, each with the function that reads its other keys.
const FAULT_KINDS: &[(&str, ReadFaultKind)] = &[
    ("joint-failure", |reader, axes| {
        let axis = required(reader, "axis", |reader| reader.index("axis", axes as u64))?;
        Some(FaultKind::JointFailure(usize::try_from(axis).ok()?))
    }),
    ("emergency-stop", |_, _| Some(FaultKind::EmergencyStop)),
    ("lost-samples", |_, _| Some(FaultKind::LostSamples)),
    ("lost-set-points", |_, _| Some(FaultKind::LostSetPoints)),
    ("latency", |reader, _| {
        required(reader, "delay", |reader| reader.magnitude("delay", Time)).map(FaultKind::Latency)
    }),
    ("noise", |reader, _| {
        required(reader, "deviation", |reader| {
            reader.magnitude("deviation", Angle)
        })
        .map(FaultKind::Noise)
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
    let word = required(&mut reader, "trouble", |reader| {
        reader.keyword("trouble", &words)
    });
    let read = FAULT_KINDS
        .iter()
        .find(|(known, _)| Some(*known) == word)
        .map(|(_, read)| read)?;
    let error = read(&mut reader, axes);
    reader.finish();
    Some(ScheduledFault {
        from,
        until,
        kind: error?,
    })
}

/// Reads a required key. Reports an error if the key is missing.
fn required<'a, T>(
    reader: &mut TableReader<'a>,
    key: &'static str,
    read: impl FnOnce(&mut TableReader<'a>) -> Option<T>,
) -> Option<T> {
    let value = read(reader);
    if value.is_none() && !reader.has(key) {
        reader.error_at(key, format!("`{key}` is missing"), None);
    }
    value
}
