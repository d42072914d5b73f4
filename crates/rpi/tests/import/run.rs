//! Nets and their programs, run on simulated devices: the same set-points, the same values, the same end.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use rpi_core::{CycleContext, Instance, Verdict};
use rpi_driver::{AnalysedNet, lower_for_execution};
use rpi_image::image::{CommandEnd, CommandEndKind};

use crate::bank::{RecordingBank, SetPoints, TWO_ARMS};
use crate::round_trip::RoundTrip;

/// Number of cycles of a run, longer than most motions of the nets.
const CYCLES: usize = 200;
/// Period of the recorded nets in ns.
const PERIOD_NS: u64 = 25_000_000;

/// Memory slots of a position and of a pose.
const POSITION: usize = 3;
const POSE: usize = 7;

/// Observable behaviour of a net in a cycle.
#[derive(Debug)]
struct CycleBehaviour {
    set_points: SetPoints,
    /// Exported values by key; an absent value is missing.
    published: BTreeMap<String, Vec<u64>>,
    /// Whether the net has ended, and if so, whether with an error.
    ended: Option<bool>,
}

impl CycleBehaviour {
    /// Compares up to rounding: the text form of rotations uses angles.
    fn is_like(&self, other: &CycleBehaviour) -> bool {
        self.ended == other.ended
            && alike(&self.set_points, &other.set_points)
            && alike(&self.published, &other.published)
    }
}

fn alike(a: &BTreeMap<String, Vec<u64>>, b: &BTreeMap<String, Vec<u64>>) -> bool {
    let near = |(a, b): (&u64, &u64)| {
        let [x, y] = [a, b].map(|bits| f64::from_bits(*bits));
        a == b || (x - y).abs() <= 1e-9 * x.abs().max(1.0)
    };
    // A quaternion and its negative are the same rotation.
    let other = |(a, b): (&u64, &u64)| near((a, &(-f64::from_bits(*b)).to_bits()));
    let is_pose = |a: &Vec<u64>| a.len() == POSE;
    let turned = |a: &Vec<u64>, b: &Vec<u64>| {
        let (at, to) = (a.split_at(POSITION), b.split_at(POSITION));
        at.0.iter().zip(to.0).all(near) && at.1.iter().zip(to.1).all(other)
    };
    let same = |(a, b): (&Vec<u64>, &Vec<u64>)| {
        a.len() == b.len() && (a.iter().zip(b).all(near) || is_pose(a) && turned(a, b))
    };
    a.keys().eq(b.keys()) && a.values().zip(b.values()).all(same)
}

/// Checks that a net and its program behave alike, without errors except those that the net reports itself. Returns
/// whether an arm had a set-point.
pub(crate) fn behaves_alike(path: &Path) -> Result<bool, String> {
    let trip = RoundTrip::from_file(path)?;
    compare_nets(&trip.old, &trip.new, TWO_ARMS, PERIOD_NS)
}

/// Checks that two nets behave alike in a cell; the second one may export more. Returns whether a device had a
/// set-point.
pub(crate) fn compare_nets(
    old: &AnalysedNet,
    new: &AnalysedNet,
    cell: &str,
    period_ns: u64,
) -> Result<bool, String> {
    let before = run(old, cell, period_ns)?;
    let mut after = run(new, cell, period_ns)?;
    let keys = before.iter().flat_map(|did| did.published.keys());
    let keys: BTreeSet<String> = keys.cloned().collect();
    for did in &mut after {
        did.published.retain(|key, _| keys.contains(key));
    }
    let mut pairs = before.iter().zip(&after).enumerate();
    match pairs.find(|(_, (a, b))| !a.is_like(b)) {
        Some((cycle, (a, b))) => Err(format!("cycle {cycle}: {a:?} became {b:?}")),
        None if before.len() != after.len() => Err("one goes on after the other".to_owned()),
        None => Ok(before.iter().any(|did| !did.set_points.is_empty())),
    }
}

fn run(net: &AnalysedNet, cell: &str, period_ns: u64) -> Result<Vec<CycleBehaviour>, String> {
    let image = lower_for_execution(net, period_ns).map_err(|e| e.to_string())?;
    let mut bank = RecordingBank::new(cell, period_ns);
    let mut machine = Instance::load(image, &mut bank).map_err(|faults| format!("{faults:?}"))?;
    let mut all = Vec::new();
    for _ in 0..CYCLES {
        machine.read(&mut bank, &CycleContext::default());
        machine.evaluate(&mut bank);
        let published = published(&machine);
        machine.commit();
        machine.hand_over(&mut bank);
        let ended = ended(&machine)?;
        all.push(CycleBehaviour {
            set_points: bank.step(),
            published,
            ended,
        });
        if ended.is_some() {
            break;
        }
    }
    Ok(all)
}

fn published(machine: &Instance) -> BTreeMap<String, Vec<u64>> {
    let exports = machine.image().exports.iter();
    let present = exports.filter_map(|e| Some((e.key.clone(), machine.value(e.value)?.to_vec())));
    present.collect()
}

/// Returns whether the run has ended, and if so, whether with an error.
fn ended(machine: &Instance) -> Result<Option<bool>, String> {
    match machine.verdict(&[]) {
        None => Ok(None),
        Some(Verdict::Terminate(error)) => Ok(Some(error != 0)),
        Some(Verdict::Result(k)) => match &machine.image().end {
            CommandEnd::Results(results) => Ok(Some(results[k].kind == CommandEndKind::Fail)),
            CommandEnd::Ports { .. } => Err("a result of none".to_owned()),
        },
        Some(Verdict::Fault(fault)) => {
            let place = machine
                .image()
                .location_of(fault.slot)
                .map(|place| &place.path);
            Err(format!("{:?} at {place:?}", fault.code))
        }
    }
}
