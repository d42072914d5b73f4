//! Scheduled faults of an arm: `[[devices.NAME.faults]]`.

use super::quantity::Dimension::{Angle, Force, Time, Torque};
use super::reader::Reader;
use crate::fault::{Fault, Trouble};
use nalgebra::Vector6;

/// Reads the keys of one kind of fault; the number is the number of axes.
type ReadTrouble = fn(&mut Reader<'_>, usize) -> Option<Trouble>;

/// Values of the key `trouble`.
const TROUBLES: &[(&str, ReadTrouble)] = &[
    ("joint-failure", |reader, axes| {
        let axis = required(reader, "axis", |reader| reader.index("axis", axes as u64))?;
        Some(Trouble::JointFailure(usize::try_from(axis).ok()?))
    }),
    ("emergency-stop", |_, _| Some(Trouble::EmergencyStop)),
    ("lost-samples", |_, _| Some(Trouble::LostSamples)),
    ("lost-set-points", |_, _| Some(Trouble::LostSetPoints)),
    ("latency", |reader, _| {
        required(reader, "delay", |reader| reader.magnitude("delay", Time)).map(Trouble::Latency)
    }),
    ("noise", |reader, _| {
        required(reader, "deviation", |reader| {
            reader.magnitude("deviation", Angle)
        })
        .map(Trouble::Noise)
    }),
    ("contact", |reader, _| {
        let force = reader
            .reals("force", Force, 3)
            .unwrap_or_else(|| vec![0.0; 3]);
        let torque = reader
            .reals("torque", Torque, 3)
            .unwrap_or_else(|| vec![0.0; 3]);
        let both = force.into_iter().chain(torque);
        Some(Trouble::Contact(Vector6::from_iterator(both)))
    }),
];

pub(super) fn read(reader: &mut Reader<'_>, axes: usize) -> Vec<Fault> {
    reader
        .tables("faults")
        .into_iter()
        .filter_map(|fault| read_one(fault, axes))
        .collect()
}

fn read_one(mut reader: Reader<'_>, axes: usize) -> Option<Fault> {
    let words: Vec<&'static str> = TROUBLES.iter().map(|(word, _)| *word).collect();
    let from = reader.magnitude("at", Time).unwrap_or(0.0);
    let until = reader
        .magnitude("for", Time)
        .map_or(f64::INFINITY, |duration| from + duration);
    let word = required(&mut reader, "trouble", |reader| {
        reader.word("trouble", &words)
    });
    let read = TROUBLES
        .iter()
        .find(|(known, _)| Some(*known) == word)
        .map(|(_, read)| read)?;
    let trouble = read(&mut reader, axes);
    reader.finish();
    Some(Fault {
        from,
        until,
        trouble: trouble?,
    })
}

/// Reads a required key. Reports an error if the key is missing.
fn required<'a, T>(
    reader: &mut Reader<'a>,
    key: &'static str,
    read: impl FnOnce(&mut Reader<'a>) -> Option<T>,
) -> Option<T> {
    let value = read(reader);
    if value.is_none() && !reader.has(key) {
        reader.fault_at(key, format!("`{key}` is missing"), None);
    }
    value
}
