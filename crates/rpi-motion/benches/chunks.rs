//! Compares ways to execute the chunks of a policy, on the same random policies: `cargo bench -p rpi-motion --bench chunks`.
//!
//! The table has, for each way: the peak of the jerk as a multiple of the limit of the axis, the share of the cycles in which a
//! limit of velocity, acceleration or jerk is exceeded, the distance of the set-points from the curve of the policy, the added
//! latency (the delay of the policy's curve that fits the set-points best), and the share of time at rest. A second table has the
//! times of the cycles of our motion. `RPI_CHUNK_SESSIONS` sets the number of sessions for each arm.

#[path = "../tests/chunks/policy.rs"]
mod policy;
#[path = "../tests/support/xorshift.rs"]
mod xorshift;

use policy::Policy;
use rpi_kin::state_to_rest::Bounds;
use rpi_kin::{ArmModel, Pose, models};
use rpi_motion::chunk::{ChunkMotion, ChunkOptions, ChunkRows};
use rpi_motion::{Arm, Controls, JointState, Joints};
use std::time::Instant;
use xorshift::Random;

const PERIOD: f64 = 1e-3;

const ARMS: [&ArmModel; 3] = [
    &models::kuka_lbr::LWR_4_PLUS,
    &models::universal_robots::UR5E,
    &models::franka::PANDA,
];

const CHUNKS: usize = 15;

/// Longest latency that is looked for, in cycles.
const LONGEST: usize = 150;

/// A chunk: times of the observation and of the arrival, s, and its rows.
struct Chunk {
    observed: f64,
    arrives: f64,
    period: f64,
    rows: Vec<Joints>,
}

/// The chunks of one session, and its policy.
struct Session {
    arm: Arm,
    policy: Policy,
    chunks: Vec<Chunk>,
}

fn session(model: &'static ArmModel, seed: u64, longest_delay: f64) -> Session {
    let arm = Arm::new(model, Pose::identity(), &[]);
    let mut random = Random::new(seed);
    let period = random.between(0.02, 0.05);
    let count = ((1.2 / period) as usize + 2).min(200);
    let policy = Policy::new(&arm, random.between(0.2, 0.5), longest_delay, &mut random);
    let mut time = 0.0;
    let chunk = |_| {
        let observed = time;
        let offset: Joints = core::array::from_fn(|_| random.between(-3e-3, 3e-3));
        time += random.between(0.02, longest_delay);
        let row = |k: usize| {
            let place = policy.at(observed + period * k as f64).0;
            core::array::from_fn(|axis| place[axis] + offset[axis] + random.between(-5e-4, 5e-4))
        };
        Chunk {
            observed,
            arrives: time,
            period,
            rows: (0..count).map(row).collect(),
        }
    };
    let chunks = (0..CHUNKS).map(chunk).collect();
    Session {
        arm,
        policy,
        chunks,
    }
}

impl Session {
    /// Newest chunk that has arrived at a time (s).
    fn newest(&self, time: f64) -> &Chunk {
        let arrived = self.chunks.iter().rev().find(|chunk| chunk.arrives <= time);
        arrived.unwrap_or(&self.chunks[0])
    }

    fn begin_and_end(&self) -> (f64, f64) {
        (self.chunks[0].arrives, self.chunks[CHUNKS - 1].arrives)
    }
}

/// Way to execute chunks: the set-points of a session, one per cycle from the arrival of the first chunk on.
type Way = fn(&Session) -> Vec<Joints>;

fn sampled(session: &Session, at: fn(&Chunk, f64) -> Joints) -> Vec<Joints> {
    let (begin, end) = session.begin_and_end();
    let cycles = ((end - begin) / PERIOD) as usize;
    (1..=cycles)
        .map(|k| {
            let time = begin + k as f64 * PERIOD;
            let chunk = session.newest(time);
            let last = (chunk.rows.len() - 1) as f64;
            at(
                chunk,
                ((time - chunk.observed) / chunk.period).clamp(0.0, last),
            )
        })
        .collect()
}

fn held(session: &Session) -> Vec<Joints> {
    sampled(session, |chunk, row| chunk.rows[row as usize])
}

fn linear(session: &Session) -> Vec<Joints> {
    sampled(session, |chunk, row| {
        let k = (row as usize).min(chunk.rows.len() - 2);
        let share = row - k as f64;
        core::array::from_fn(|axis| {
            chunk.rows[k][axis] * (1.0 - share) + chunk.rows[k + 1][axis] * share
        })
    })
}

/// Natural cubic spline through all rows, by its second derivatives.
fn cubic(session: &Session) -> Vec<Joints> {
    sampled(session, |chunk, row| {
        let k = (row as usize).min(chunk.rows.len() - 2);
        let (b, a) = (row - k as f64, 1.0 - (row - k as f64));
        core::array::from_fn(|axis| {
            let bends = bends(&chunk.rows, axis);
            a * chunk.rows[k][axis]
                + b * chunk.rows[k + 1][axis]
                + ((a * a * a - a) * bends[k] + (b * b * b - b) * bends[k + 1]) / 6.0
        })
    })
}

/// Second derivatives of the natural cubic spline at its rows, times the square of the period (Thomas algorithm).
fn bends(rows: &[Joints], axis: usize) -> Vec<f64> {
    let n = rows.len();
    let (mut factor, mut value) = (vec![0.0; n], vec![0.0; n]);
    for k in 1..n - 1 {
        let right = 6.0 * (rows[k + 1][axis] - 2.0 * rows[k][axis] + rows[k - 1][axis]);
        let pivot = 4.0 - factor[k - 1];
        factor[k] = 1.0 / pivot;
        value[k] = (right - value[k - 1]) / pivot;
    }
    for k in (1..n - 1).rev() {
        value[k] -= factor[k] * value[k + 1];
    }
    value
}

fn ours(session: &Session) -> Vec<Joints> {
    followed(session).into_iter().map(|cycle| cycle.0).collect()
}

/// Set-points of our motion, each with the time that its cycle took, s.
fn followed(session: &Session) -> Vec<(Joints, f64)> {
    let unbounded = Bounds {
        speed: 1e6,
        acceleration: 1e9,
        jerk: 1e12,
    };
    let (begin, end) = session.begin_and_end();
    let mut motion = ChunkMotion::new(session.arm, PERIOD);
    // As the other ways: the arm waits at the place of the first row that is executed.
    let start = session.policy.at(begin).0;
    let begun = motion.begin(&JointState::at_rest(start), unbounded, PERIOD);
    begun.expect("the bounds are positive");
    let mut next = session.chunks.iter().peekable();
    let cycles = ((end - begin) / PERIOD) as usize;
    let mut all = Vec::new();
    for k in 0..cycles {
        let time = begin + k as f64 * PERIOD;
        let mut taken = 0.0;
        while let Some(chunk) = next.next_if(|chunk| chunk.arrives <= time + PERIOD / 2.0) {
            let axes = session.arm.axes();
            let positions: Vec<f64> = chunk
                .rows
                .iter()
                .flat_map(|row| &row[..axes])
                .copied()
                .collect();
            let rows = ChunkRows {
                period: chunk.period,
                positions: &positions,
                velocities: None,
                age: (time - chunk.observed).max(0.0),
            };
            // A chunk that has passed when it arrives is refused; the arm then waits for the next one.
            let start = Instant::now();
            let _ = motion.take(&rows, &ChunkOptions::default());
            taken += start.elapsed().as_secs_f64();
        }
        let start = Instant::now();
        let at = motion.next_set_point(Controls::default());
        all.push((at.state.position, taken + start.elapsed().as_secs_f64()));
    }
    all
}

/// Figures of one way over all sessions.
#[derive(Default)]
struct Figures {
    peak_jerk: f64,
    over: usize,
    at_rest: usize,
    cycles: usize,
    errors: Vec<f64>,
    latency: Vec<f64>,
}

impl Figures {
    fn add(&mut self, session: &Session, set_points: &[Joints]) {
        let axes = session.arm.axes();
        let begin = session.begin_and_end().0;
        let wanted: Vec<Joints> = (0..set_points.len())
            .map(|k| session.policy.at(begin + (k + 1) as f64 * PERIOD).0)
            .collect();
        for (at, wanted) in set_points.iter().zip(&wanted) {
            let off = (0..axes).map(|axis| (at[axis] - wanted[axis]).abs());
            self.errors.push(off.fold(0.0, f64::max));
        }
        for last in set_points.windows(4) {
            let (jerk, worst, rests) = shares(&session.arm, last);
            self.peak_jerk = self.peak_jerk.max(jerk);
            self.over += usize::from(worst > 1.0 + 1e-6);
            self.at_rest += usize::from(rests);
            self.cycles += 1;
        }
        self.latency.push(latency(set_points, &wanted, axes));
    }

    fn print(&mut self, name: &str) {
        self.errors.sort_by(f64::total_cmp);
        let at = |share: f64| self.errors[((self.errors.len() - 1) as f64 * share) as usize];
        let percent = |count: usize| 100.0 * count as f64 / self.cycles as f64;
        let latency = self.latency.iter().sum::<f64>() / self.latency.len() as f64;
        let digits = if self.peak_jerk < 1000.0 { 3 } else { 0 };
        let jerk = format!("{:.digits$}", self.peak_jerk);
        println!(
            "| {name} | {jerk} | {:.2} % | {:.4} | {:.4} | {:.1} | {:.2} % |",
            percent(self.over),
            at(0.5),
            at(0.99),
            1e3 * latency,
            percent(self.at_rest)
        );
    }
}

/// Largest jerk and largest velocity, acceleration or jerk as shares of the limits, and whether the arm rests, from four
/// successive set-points.
fn shares(arm: &Arm, last: &[Joints]) -> (f64, f64, bool) {
    let (mut peak, mut worst, mut rests) = (0.0f64, 0.0f64, true);
    for (axis, limits) in arm.limits().iter().enumerate() {
        let [a, b, c, d] = [last[0][axis], last[1][axis], last[2][axis], last[3][axis]];
        let velocity = (d - c) / PERIOD;
        let acceleration = (d - 2.0 * c + b) / (PERIOD * PERIOD);
        let jerk = (d - 3.0 * (c - b) - a) / (PERIOD * PERIOD * PERIOD) / limits.jerk;
        peak = peak.max(jerk.abs());
        worst = worst
            .max(jerk.abs())
            .max(velocity.abs() / limits.velocity)
            .max(acceleration.abs() / limits.acceleration);
        rests &= velocity.abs() < 1e-9;
    }
    (peak, worst, rests)
}

/// Delay (s) of the wanted curve that fits the set-points best, in the mean of the squares.
fn latency(set_points: &[Joints], wanted: &[Joints], axes: usize) -> f64 {
    let cost = |delay: usize| -> f64 {
        let pairs = set_points[LONGEST..].iter().zip(&wanted[LONGEST - delay..]);
        pairs
            .step_by(5)
            .map(|(at, wanted)| {
                (0..axes)
                    .map(|axis| (at[axis] - wanted[axis]) * (at[axis] - wanted[axis]))
                    .sum::<f64>()
            })
            .sum()
    };
    let best = (0..LONGEST).min_by(|one, other| cost(*one).total_cmp(&cost(*other)));
    best.unwrap_or(0) as f64 * PERIOD
}

/// Prints the times of the cycles of our motion. Each session runs several times; the shortest time of each cycle counts,
/// because other programs on the machine only make it longer.
fn print_times() {
    const RUNS: usize = 5;
    println!(
        "\nCycles of `ChunkMotion`:\n\n| arm | median | 99 of 100 | longest |\n|---|---:|---:|---:|"
    );
    for model in ARMS {
        let mut times = Vec::new();
        for seed in 0..5 {
            let session = session(model, seed, 0.6);
            let mut shortest: Vec<f64> = followed(&session).iter().map(|cycle| cycle.1).collect();
            for _ in 1..RUNS {
                let again = followed(&session);
                for (shortest, (_, time)) in shortest.iter_mut().zip(again) {
                    *shortest = shortest.min(time);
                }
            }
            times.extend(shortest);
        }
        times.sort_by(f64::total_cmp);
        let at = |share: f64| 1e6 * times[((times.len() - 1) as f64 * share) as usize];
        let [median, high, longest] = [at(0.5), at(0.99), at(1.0)];
        println!(
            "| {} | {median:.1} µs | {high:.1} µs | {longest:.0} µs |",
            model.display_name
        );
    }
}

const WAYS: [(&str, Way); 4] = [
    ("hold until next", held),
    ("linear interpolation", linear),
    ("cubic spline", cubic),
    ("`ChunkMotion`", ours),
];

fn main() {
    let sessions = std::env::var("RPI_CHUNK_SESSIONS")
        .map_or(20, |text| text.parse().expect("a number of sessions"));
    for (title, longest_delay) in [
        ("delays of 20 to 600 ms", 0.6),
        ("delays of 20 to 1100 ms", 1.1),
    ] {
        println!("\nChunks of 1.2 s, {title}:\n");
        println!(
            "| way | peak jerk (of the limit) | over a limit | error, median (rad) | error, p99 (rad) | latency (ms) | at rest |"
        );
        println!("|---|---|---|---|---|---|---|");
        for (name, way) in WAYS {
            let mut figures = Figures::default();
            for model in ARMS {
                for seed in 0..sessions {
                    let session = session(model, seed, longest_delay);
                    figures.add(&session, &way(&session));
                }
            }
            figures.print(name);
        }
    }
    print_times();
}
