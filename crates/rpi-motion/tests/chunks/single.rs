//! Single chunks, however wild, and chunks in quick succession: the arm comes to rest at the last row, without a detour.

use crate::session::UNBOUNDED;
use crate::watch::{PERIOD, Watch};
use crate::xorshift::Random;
use crate::{ARMS, number};
use rpi_kin::{ArmModel, Pose};
use rpi_motion::chunk::{ChunkError, ChunkMotion, ChunkOptions, ChunkRows, Seam};
use rpi_motion::{Arm, Controls, JointState, Joints};

/// Longest time in which an arm must have reached the last row of a chunk of 2 s at most, s: rows that vibrate are followed at a
/// hundredth of their rate.
const LONGEST: f64 = 200.0;

/// Time between two rows, s.
const ROW_PERIOD: f64 = 0.02;

/// An arm that follows chunks, watched.
struct Rig {
    arm: Arm,
    motion: ChunkMotion,
    watch: Watch,
    /// Smallest and largest position of each axis so far, rad.
    reached: [Joints; 2],
}

impl Rig {
    fn new(model: &'static ArmModel, home: Joints) -> Self {
        let arm = Arm::new(model, Pose::identity(), &[]);
        let mut motion = ChunkMotion::new(arm, PERIOD);
        let begun = motion.begin(&JointState::at_rest(home), UNBOUNDED, PERIOD);
        begun.expect("finite");
        Self {
            arm,
            motion,
            watch: Watch::standing(&home),
            reached: [home; 2],
        }
    }

    fn send(&mut self, rows: &[Joints], seam: Seam) -> Result<(), ChunkError> {
        let axes = self.arm.axes();
        let positions: Vec<f64> = rows.iter().flat_map(|row| &row[..axes]).copied().collect();
        let chunk = ChunkRows {
            period: ROW_PERIOD,
            positions: &positions,
            velocities: None,
            age: 0.0,
        };
        let options = ChunkOptions {
            seam,
            ..ChunkOptions::default()
        };
        self.motion.take(&chunk, &options)
    }

    /// One cycle. Returns true once the arm rests at the end of its chunks.
    fn cycle(&mut self, controls: Controls) -> bool {
        let at = self.motion.next_set_point(controls);
        self.watch.push(&self.arm, &at.state.position);
        let [low, high] = &mut self.reached;
        for axis in 0..self.arm.axes() {
            low[axis] = low[axis].min(at.state.position[axis]);
            high[axis] = high[axis].max(at.state.position[axis]);
        }
        at.at_rest && at.is_late && at.remaining < 1e-6 && !self.motion.is_preparing()
    }

    fn run_to_rest(&mut self, what: &str) {
        let rests = (0..(LONGEST / PERIOD) as usize).any(|_| self.cycle(Controls::default()));
        assert!(
            rests,
            "{what}: the arm does not come to rest at the last row"
        );
        assert!(self.watch.is_within(), "{what}: {:?}", self.watch.worst);
    }
}

/// The middle of the ranges of an arm, within a turn.
fn middle(model: &ArmModel) -> Joints {
    let mut home = Joints::default();
    for (joint, limits) in home.iter_mut().zip(model.limits) {
        let range = limits.position;
        *joint = f64::midpoint(range.lower.max(-2.0), range.upper.min(2.0));
    }
    home
}

/// A random chunk: steps, ramps, noise and vibration of some axes, far beyond what the arm can follow.
fn rows(home: &Joints, axes: usize, random: &mut Random) -> Vec<Joints> {
    let count = 5 + (95.0 * random.unit()) as usize;
    let mut rows = vec![*home; count];
    for axis in (0..axes)
        .filter(|_| random.unit() < 0.5)
        .collect::<Vec<_>>()
    {
        let size = random.between(-0.8, 0.8);
        let (kind, begin) = (random.unit(), random.unit() * count as f64);
        let ramp = 1.0 + 30.0 * random.unit();
        let frequency = random.between(0.1, 3.0);
        let square = |x: f64| x * x;
        for (k, row) in rows.iter_mut().enumerate() {
            let since = (k as f64 - begin).max(0.0);
            row[axis] += match kind {
                u if u < 0.25 => size * f64::from(since > 0.0),
                u if u < 0.5 => size * (since / ramp).min(1.0),
                u if u < 0.75 => size * square((since / ramp).min(1.0)),
                u if u < 0.9 => 0.1 * size * rpi_math::sin(frequency * since),
                _ => 0.05 * size * random.between(-1.0, 1.0),
            };
        }
    }
    rows
}

/// Distance by which the curve of an axis may pass the positions of all rows, rad: the permitted deviation by smoothing, and the
/// distance by which a curve with the acceleration of the axis passes its rows.
fn curve_room(model: &ArmModel, axis: usize) -> f64 {
    let square = ROW_PERIOD * ROW_PERIOD;
    ChunkOptions::default().smoothing + square * model.limits[axis].acceleration / 4.0
}

/// Distance by which an axis may pass the positions of all rows, rad: it may leave its curve there, and brake from its highest
/// velocity.
fn room(model: &ArmModel, axis: usize) -> f64 {
    let limits = &model.limits[axis];
    let time = limits.velocity / limits.acceleration + limits.acceleration / limits.jerk;
    curve_room(model, axis) + limits.velocity * time / 2.0
}

/// Runs a random chunk, and checks the positions that the axes reach and come to rest at. No axis may pass all rows by more than
/// its `room`. Returns the largest distance beyond all rows as a share of the room.
fn follow_any_chunk(model: &'static ArmModel, seed: u64, room: fn(&ArmModel, usize) -> f64) -> f64 {
    let mut random = Random::new(seed);
    let home = middle(model);
    let mut rig = Rig::new(model, home);
    let rows = rows(&home, rig.arm.axes(), &mut random);
    let what = format!("{} seed {seed}", model.id);
    rig.send(&rows, Seam::Overlap).expect("the chunk is valid");
    rig.run_to_rest(&what);
    let last = rows[rows.len() - 1];
    let mut farthest = 0.0f64;
    for axis in 0..rig.arm.axes() {
        let of_rows = rows.iter().map(|row| row[axis]);
        let (low, high) = of_rows.fold((home[axis], home[axis]), |(low, high), value| {
            (low.min(value), high.max(value))
        });
        let room = room(model, axis);
        let [least, most] = rig.reached.map(|joints| joints[axis]);
        let beyond = (most - high).max(low - least);
        farthest = farthest.max(beyond / room);
        assert!(
            beyond < room,
            "{what}: axis {axis} {least} to {most}, rows {low} to {high}"
        );
        let end = rig.watch.joints()[axis];
        let range = rig.arm.limits()[axis].position;
        let goal = last[axis].clamp(range.lower, range.upper);
        let off = (end - goal).abs();
        let permitted = ChunkOptions::default().smoothing + 1e-3;
        assert!(off < permitted, "{what}: axis {axis} {end} {goal}");
    }
    farthest
}

#[test]
fn any_chunk_is_followed_to_its_last_row_without_a_detour() {
    let (chunks, first) = (number("RPI_CHUNK_SESSIONS", 100), number("RPI_SEED", 1));
    for model in ARMS {
        let farthest = (first..first + chunks.div_ceil(3))
            .map(|seed| follow_any_chunk(model, seed, room))
            .fold(0.0, f64::max);
        println!("{}: beyond the rows by {farthest:.3} of the room", model.id);
    }
}

/// Few rows with a jump next to an end: five rows, of which the first two of one axis are 0.8 rad above the others.
#[test]
fn a_jump_near_the_end_of_few_rows_causes_no_swing() {
    for model in ARMS {
        follow_any_chunk(model, 664, curve_room);
    }
}

/// A ramp of 0.08 rad shortly after the first row, smoothed so strongly that the curve bends from its beginning on. Entered at its full
/// rate, the difference in acceleration decays so slowly that the axis goes 0.7 rad in the other direction.
#[test]
fn a_first_chunk_that_bends_at_once_causes_no_detour() {
    for model in ARMS {
        follow_any_chunk(model, 2363, curve_room);
    }
}

/// Rows that go on by `step` (rad) of the first axis from `from` on.
fn steady(home: &Joints, from: f64, step: f64, count: usize) -> Vec<Joints> {
    let row = |k: usize| {
        let mut row = *home;
        row[0] += from + step * (k + 1) as f64;
        row
    };
    (0..count).map(row).collect()
}

#[test]
fn no_appended_chunk_is_lost() {
    for model in ARMS {
        // Cycles between two chunks: the first is still in preparation for some of them.
        for gap in 0..20 {
            let home = middle(model);
            let mut rig = Rig::new(model, home);
            for part in 0..3 {
                let rows = steady(&home, 0.02 * f64::from(part), 2e-3, 10);
                rig.send(&rows, Seam::Append).expect("there is room");
                (0..gap).for_each(|_| {
                    rig.cycle(Controls::default());
                });
            }
            let what = format!("{} gap {gap}", model.id);
            let begin = rig.watch.joints()[0];
            let cycles = (0..3000).take_while(|_| !rig.cycle(Controls::default()));
            let took = (cycles.count() + 3 * gap) as f64 * PERIOD;
            // 30 rows take 0.58 s, and the stop a little more.
            assert!(took > 0.58, "{what}: {took} s from {begin}");
            let end = rig.watch.joints()[0] - home[0];
            assert!((end - 0.06).abs() < 0.005, "{what}: {end}");
            assert!(rig.watch.is_within(), "{what}: {:?}", rig.watch.worst);
        }
    }
}

#[test]
fn chunks_that_are_appended_during_a_pause_are_executed_after_it() {
    let home = middle(ARMS[0]);
    let mut rig = Rig::new(ARMS[0], home);
    let paused = Controls {
        paused: true,
        ..Controls::default()
    };
    let first = steady(&home, 0.0, 2e-3, 10);
    rig.send(&first, Seam::Overlap).expect("the chunk is valid");
    (0..30).for_each(|_| {
        rig.cycle(Controls::default());
    });
    let mut appended = 0;
    for part in 1..50 {
        let rows = steady(&home, 0.02 * f64::from(part), 2e-3, 10);
        match rig.send(&rows, Seam::Append) {
            Ok(()) => appended += 1,
            Err(error) => {
                assert_eq!(error, ChunkError::Full);
                break;
            }
        }
        (0..50).for_each(|_| {
            rig.cycle(paused);
        });
    }
    assert!((20..45).contains(&appended), "{appended}");
    rig.run_to_rest("after the pause");
    let end = rig.watch.joints()[0] - home[0];
    let wanted = 0.02 * f64::from(appended + 1);
    assert!((end - wanted).abs() < 0.005, "{end} {wanted}");
}

#[test]
fn a_rejected_chunk_leaves_the_one_before_in_preparation() {
    let home = middle(ARMS[0]);
    let mut rig = Rig::new(ARMS[0], home);
    let rows = steady(&home, 0.0, 2e-3, 10);
    rig.send(&rows, Seam::Overlap).expect("the chunk is valid");
    assert_eq!(rig.send(&rows[..3], Seam::Overlap), Err(ChunkError::Length));
    let positions = vec![0.0; 10 * rig.arm.axes()];
    let stale = ChunkRows {
        period: 0.02,
        positions: &positions,
        velocities: None,
        age: 1.0,
    };
    let refused = rig.motion.take(&stale, &ChunkOptions::default());
    assert_eq!(refused, Err(ChunkError::Stale));
    rig.run_to_rest("the first chunk");
    let end = rig.watch.joints()[0] - home[0];
    assert!((end - 0.02).abs() < 0.005, "{end}");
}
