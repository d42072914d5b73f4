//! Time of each cycle of random takeovers, by what the cycle does: the first one, the next three, the entry, and the
//! motion along the path.
//!
//! `cargo bench -p rpi-motion` prints one table. Each takeover runs several times from the same state; the shortest time
//! of each cycle counts, because other programs on the machine only make it longer. `RPI_TAKEOVERS` sets the number of
//! takeovers of each arm (100).

#[path = "../tests/takeovers/random.rs"]
mod random;

use random::{KINDS, Random};
use rpi_kin::{ArmModel, Pose, models};
use rpi_motion::{Arm, Controls, JointState, MotionCore, Path, check_path};
use std::hint::black_box;
use std::time::Instant;

const PERIOD: f64 = 1e-3;

/// Bar of every cycle, µs.
const BAR: f64 = 200.0;

/// Bar of a cycle along a path of the tool that makes no plan, as a multiple of its inverse kinematics.
const BAR_OF_INVERSE: f64 = 2.5;

const ARMS: [&ArmModel; 4] = [
    &models::kuka_lbr::LWR_4_PLUS,
    &models::kuka_kr::KR_6_R900,
    &models::universal_robots::UR5E,
    &models::kuka_lbr::IIWA_7,
];

/// Number of measured cycles of a takeover.
const CYCLES: usize = 400;

/// Number of runs of each takeover.
const RUNS: usize = 7;

/// Groups of cycles: name, first cycle, and the cycle behind the last one.
const GROUPS: [(&str, usize, usize); 4] = [
    ("first cycle", 0, 1),
    ("cycles 2 to 4", 1, 4),
    ("entry, cycles 5 to 50", 4, 50),
    ("along the path, later cycles", 50, CYCLES),
];

/// A takeover that can be repeated: the core in motion, and the motion that takes over.
struct Takeover {
    core: MotionCore,
    state: JointState,
    path: Path,
    requested: rpi_kin::state_to_rest::Bounds,
}

fn random_motion(
    model: &'static ArmModel,
    arm: &Arm,
    state: &JointState,
    random: &mut Random,
) -> (Path, rpi_kin::state_to_rest::Bounds) {
    loop {
        let kind = KINDS[random.below(KINDS.len())];
        let path = random::path(model, arm, kind, &state.position, random);
        let requested = random::requested(kind, random, false);
        let usable = path.filter(|path| check_path(arm, *path, &state.position, requested).is_ok());
        if let Some(path) = usable {
            return (path, requested);
        }
    }
}

fn takeover(model: &'static ArmModel, random: &mut Random) -> Option<Takeover> {
    let arm = Arm::new(model, Pose::identity(), &[]);
    let mut core = MotionCore::new(arm, PERIOD);
    let state = JointState::at_rest(random::joints(model, random));
    let (first, bounds) = random_motion(model, &arm, &state, random);
    core.begin(first, &state, bounds).ok()?;
    for _ in 0..50 + random.below(800) {
        core.next_set_point(Controls::default()).ok()?;
    }
    let state = core.state();
    let (path, requested) = random_motion(model, &arm, &state, random);
    Some(Takeover {
        core,
        state,
        path,
        requested,
    })
}

/// Time that one reading of the clock takes, µs. It is part of each measured cycle.
fn clock_time() -> f64 {
    let read = |_| {
        let start = Instant::now();
        for _ in 0..64 {
            black_box(Instant::now());
        }
        start.elapsed().as_secs_f64() * 1e6 / 64.0
    };
    (0..RUNS).map(read).fold(f64::INFINITY, f64::min)
}

/// Shortest time of each cycle of a takeover over all runs, µs. The first one includes the begin of the motion.
fn times(takeover: &Takeover) -> Vec<f64> {
    let mut shortest = vec![f64::INFINITY; CYCLES];
    for _ in 0..RUNS {
        let mut core = takeover.core.clone();
        for (cycle, time) in shortest.iter_mut().enumerate() {
            let start = Instant::now();
            if cycle == 0 {
                let begun = core.begin(takeover.path, &takeover.state, takeover.requested);
                begun.expect("the check accepted it");
            }
            let at = core.next_set_point(Controls::default());
            let elapsed = start.elapsed().as_secs_f64() * 1e6;
            black_box(at).expect("the path was checked");
            *time = time.min(elapsed);
        }
    }
    shortest
}

/// Shortest mean time of the inverse kinematics of one pose of the tool along a path, µs; `None` on a joint line.
fn inverse_time(arm: &Arm, takeover: &Takeover) -> Option<f64> {
    let Path::Tool(path) = &takeover.path else {
        return None;
    };
    let hint = takeover.state.position;
    let angle = arm.arm_angle(&hint).unwrap_or(0.0);
    let poses: Vec<Pose> = (0..64)
        .map(|k| path.pose(path.length() * f64::from(k) / 640.0))
        .collect();
    let run = |_| {
        let start = Instant::now();
        for pose in &poses {
            let _ = black_box(arm.inverse(black_box(pose), &hint, angle));
        }
        start.elapsed().as_secs_f64() * 1e6 / poses.len() as f64
    };
    Some((0..RUNS).map(run).fold(f64::INFINITY, f64::min))
}

fn quantile(sorted: &[f64], share: f64) -> f64 {
    let last = sorted.len() - 1;
    sorted[(last as f64 * share).round() as usize]
}

fn row(name: &str, mut values: Vec<f64>, bar: f64) {
    values.sort_by(f64::total_cmp);
    let worst = quantile(&values, 1.0);
    let result = if worst <= bar { "ok" } else { "OVER" };
    println!(
        "{name:32} {:8.2} {:8.2} {worst:8.2} {bar:8.1}  {result}",
        quantile(&values, 0.5),
        quantile(&values, 0.99),
    );
}

fn main() {
    let count = std::env::var("RPI_TAKEOVERS").map_or(100, |text| text.parse().expect("a number"));
    println!(
        "{:32} {:>8} {:>8} {:>8} {:>8}",
        "time, us", "median", "p99", "worst", "bar"
    );
    let clock = clock_time();
    let mut ratios = Vec::new();
    for model in ARMS {
        let arm = Arm::new(model, Pose::identity(), &[]);
        let mut random = Random::new(81);
        let mut groups = [const { Vec::new() }; GROUPS.len()];
        for _ in 0..count {
            let Some(takeover) = takeover(model, &mut random) else {
                continue;
            };
            let times = times(&takeover);
            for (group, (_, from, to)) in groups.iter_mut().zip(GROUPS) {
                group.extend_from_slice(&times[from..to]);
            }
            if let Some(inverse) = inverse_time(&arm, &takeover) {
                let mut later = times[50..].to_vec();
                later.sort_by(f64::total_cmp);
                // Three of four cycles make no plan.
                ratios.push((quantile(&later, 0.5) - clock) / inverse);
            }
        }
        for (group, (name, ..)) in groups.into_iter().zip(GROUPS) {
            row(&format!("{}, {name}", short(model)), group, BAR);
        }
    }
    ratios.sort_by(f64::total_cmp);
    let ratio = quantile(&ratios, 0.5);
    let result = if ratio <= BAR_OF_INVERSE {
        "ok"
    } else {
        "OVER"
    };
    println!(
        "cycle without a plan, as a multiple of its inverse kinematics: {ratio:.2}, bar {BAR_OF_INVERSE}  {result}"
    );
}

/// Last part of the name of a model.
fn short(model: &ArmModel) -> &str {
    model.id.split_once('-').map_or(model.id, |(_, name)| name)
}
