//! Nets and their programs, run on simulated devices: the same set-points, the same values, the same end.

use std::collections::BTreeMap;
use std::path::Path;

use rpi_core::{Machine, Moment, Verdict};
use rpi_driver::lower_to_run;
use rpi_image::image::{End, EndKind};
use rpi_net::Net;

use crate::bank::{Noting, PERIOD_NS, SetPoints};
use crate::trip::Trip;

/// How long a net runs: longer than most motions in them.
const CYCLES: usize = 200;

/// What a net did in a cycle.
#[derive(Debug)]
struct Did {
    told: SetPoints,
    /// What it published, by key; an absent value is missing.
    published: BTreeMap<String, Vec<u64>>,
    /// Whether it ended, and with an error.
    ended: Option<bool>,
}

impl Did {
    /// Whether both are the same to rounding: rotations go through text as angles.
    fn is_like(&self, other: &Did) -> bool {
        self.ended == other.ended
            && alike(&self.told, &other.told)
            && alike(&self.published, &other.published)
    }
}

fn alike(a: &BTreeMap<String, Vec<u64>>, b: &BTreeMap<String, Vec<u64>>) -> bool {
    let near = |(a, b): (&u64, &u64)| {
        let [x, y] = [a, b].map(|bits| f64::from_bits(*bits));
        a == b || (x - y).abs() <= 1e-9 * x.abs().max(1.0)
    };
    let same = |(a, b): (&Vec<u64>, &Vec<u64>)| a.len() == b.len() && a.iter().zip(b).all(near);
    a.keys().eq(b.keys()) && a.values().zip(b.values()).all(same)
}

/// A net and its program do the same, and nothing goes wrong that the net does not report itself. Whether an arm was
/// told to move.
pub(crate) fn does_the_same(path: &Path) -> Result<bool, String> {
    let trip = Trip::of(path)?;
    let before = run(&trip.old)?;
    let mut after = run(&trip.new)?;
    let keys: Vec<String> = before
        .iter()
        .flat_map(|did| did.published.keys())
        .cloned()
        .collect();
    for did in &mut after {
        did.published.retain(|key, _| keys.contains(key));
    }
    let mut pairs = before.iter().zip(&after).enumerate();
    match pairs.find(|(_, (a, b))| !a.is_like(b)) {
        Some((cycle, (a, b))) => Err(format!("cycle {cycle}: {a:?} became {b:?}")),
        None if before.len() != after.len() => Err("one goes on after the other".to_owned()),
        None => Ok(before.iter().any(|did| !did.told.is_empty())),
    }
}

fn run(net: &Net) -> Result<Vec<Did>, String> {
    let image = lower_to_run(net, PERIOD_NS)?;
    let mut bank = Noting::new();
    let mut machine = Machine::load(image, &mut bank).map_err(|faults| format!("{faults:?}"))?;
    let mut all = Vec::new();
    for _ in 0..CYCLES {
        let moment = Moment::default();
        machine.read(&mut bank, &moment);
        machine.evaluate(&mut bank);
        let published = published(&machine);
        machine.commit();
        machine.hand_over(&mut bank);
        let ended = ended(&machine)?;
        all.push(Did {
            told: bank.step(),
            published,
            ended,
        });
        if ended.is_some() {
            break;
        }
    }
    Ok(all)
}

fn published(machine: &Machine) -> BTreeMap<String, Vec<u64>> {
    let exports = machine.image().exports.iter();
    let present = exports.filter_map(|e| Some((e.key.clone(), machine.value(e.value)?.to_vec())));
    present.collect()
}

/// Whether it has ended, and with an error.
fn ended(machine: &Machine) -> Result<Option<bool>, String> {
    match machine.verdict(&[]) {
        None => Ok(None),
        Some(Verdict::Terminate(error)) => Ok(Some(error != 0)),
        Some(Verdict::Result(k)) => match &machine.image().end {
            End::Results(results) => Ok(Some(results[k].kind == EndKind::Fail)),
            End::Ports { .. } => Err("a result of none".to_owned()),
        },
        Some(Verdict::Fault(fault)) => {
            let place = machine
                .image()
                .place_of(fault.cell)
                .map(|place| &place.path);
            Err(format!("{:?} at {place:?}", fault.code))
        }
    }
}
