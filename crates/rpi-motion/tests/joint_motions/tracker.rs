//! Goals that a program computes cycle by cycle: set-points are the goals where these keep the limits, and keep the limits where
//! the goals do not.

use super::watch::{PERIOD, Watch};
use super::xorshift::Random;
use super::{ARMS, joints};
use rpi_kin::{ArmModel, Pose};
use rpi_motion::{Arm, BackwardDifferences, JointTracker, Joints};
use rpi_testkit::no_alloc;

/// A tracker of an arm, whose set-points a controller watches.
struct Rig {
    arm: Arm,
    tracker: JointTracker,
    watch: Watch,
}

impl Rig {
    fn standing(model: &'static ArmModel, at: &Joints) -> Self {
        let arm = Arm::new(model, Pose::identity(), &[]);
        let mut tracker = JointTracker::new(arm, PERIOD);
        let last = BackwardDifferences {
            position: *at,
            ..BackwardDifferences::default()
        };
        tracker.begin(&last, PERIOD, PERIOD).expect("finite");
        Self {
            arm,
            tracker,
            watch: Watch::standing(at),
        }
    }

    /// Follows the goal for a cycle. Returns the distance from it, rad.
    fn follow(&mut self, goal: Option<&Joints>) -> f64 {
        let at = no_alloc(|| self.tracker.next_set_point(goal));
        self.watch.push(&self.arm, &at.joints);
        at.deviation
    }
}

/// Curve of the joints that begins and ends smoothly: a sin⁴(w t / 2) / 4.
struct Swing {
    begin: Joints,
    amplitude: Joints,
    rate: f64,
}

impl Swing {
    /// Creates a curve that uses at most about `share` of the limits of each axis; `rate` is w, 1/s.
    ///
    /// With sin⁴ x = (3 - 4 cos 2x + cos 4x) / 8, the curve has at most the velocity 0.17 a w, the acceleration a w² / 4 and the jerk
    /// a w³ 3/8.
    fn new(model: &ArmModel, begin: &Joints, share: f64, rate: f64) -> Self {
        let mut amplitude = [0.0; 7];
        for (slot, limits) in amplitude.iter_mut().zip(model.limits) {
            let most = [
                limits.velocity / (0.17 * rate),
                limits.acceleration / (0.25 * rate * rate),
                limits.jerk / (0.375 * rate * rate * rate),
            ];
            *slot = share * most.into_iter().fold(f64::INFINITY, f64::min);
        }
        Self {
            begin: *begin,
            amplitude,
            rate,
        }
    }

    fn at(&self, time: f64) -> Joints {
        let sine = rpi_math::sin(self.rate * time / 2.0);
        let share = sine * sine * sine * sine / 4.0;
        core::array::from_fn(|axis| self.begin[axis] + self.amplitude[axis] * share)
    }
}

fn middle(model: &ArmModel) -> Joints {
    let mut q = [0.0; 7];
    for (slot, limits) in q.iter_mut().zip(model.limits) {
        *slot = f64::midpoint(limits.position.lower, limits.position.upper) + 0.1;
    }
    q
}

#[test]
fn goals_within_the_limits_are_the_set_points() {
    for model in ARMS {
        let begin = middle(model);
        let swing = Swing::new(model, &begin, 0.9, 6.0);
        let mut rig = Rig::standing(model, &begin);
        for cycle in 1..4000 {
            let goal = swing.at(f64::from(cycle) * PERIOD);
            let deviation = rig.follow(Some(&goal));
            assert_eq!(deviation, 0.0, "{} cycle {cycle}", model.id);
        }
        assert!(rig.watch.is_within(), "{:?}", rig.watch.worst);
    }
}

/// For a second, the goals ask for three times the limits. The axes follow as closely as they can, and take the goals up exactly again
/// within two seconds after they have come to rest.
#[test]
fn goals_beyond_the_limits_are_caught_up_with() {
    for model in ARMS {
        let begin = middle(model);
        let swing = Swing::new(model, &begin, 3.0, 6.0);
        let mut rig = Rig::standing(model, &begin);
        let turn = core::f64::consts::TAU / 6.0;
        let mut largest: f64 = 0.0;
        for cycle in 1..4000 {
            let time = (f64::from(cycle) * PERIOD).min(turn);
            let deviation = rig.follow(Some(&swing.at(time)));
            largest = largest.max(deviation);
            if f64::from(cycle) * PERIOD > turn + 2.0 {
                assert!(deviation < 1e-9, "{} cycle {cycle}: {deviation}", model.id);
            }
        }
        assert!(largest > 1e-4, "{}: nothing was beyond a limit", model.id);
        assert!(rig.watch.is_within(), "{}: {:?}", model.id, rig.watch.worst);
    }
}

/// The goals accelerate all the time, and begin beside the axes: these converge and are at the goals exactly, without an oscillation
/// about them.
#[test]
fn goals_that_accelerate_are_taken_up_exactly() {
    for model in ARMS {
        let begin = middle(model);
        let swing = Swing::new(model, &begin, 0.2, 4.0);
        let beside = begin.map(|joint| joint + 0.001);
        let mut rig = Rig::standing(model, &beside);
        for cycle in 1..4000 {
            let deviation = rig.follow(Some(&swing.at(f64::from(cycle) * PERIOD)));
            let is_late = cycle > 2000 && deviation > 0.0;
            assert!(!is_late, "{} cycle {cycle}: {deviation}", model.id);
        }
        assert!(rig.watch.is_within(), "{}: {:?}", model.id, rig.watch.worst);
    }
}

/// Random goals in turn: curves within and beyond the limits, jumps, no goal, no number; some so far away that the ranges end before.
fn chain(model: &'static ArmModel, seed: u64) {
    let mut random = Random::new(seed);
    let start = joints(model, &mut random, -0.05);
    let mut rig = Rig::standing(model, &start);
    for part in 0..12 {
        let kind = random.unit();
        let (share, rate) = (random.between(0.1, 3.0), random.between(2.0, 30.0));
        let begin = match kind < 0.3 {
            true => joints(model, &mut random, 0.2),
            false => *rig.watch.joints(),
        };
        let swing = Swing::new(model, &begin, share, rate);
        for cycle in 0..20 + (random.unit() * 700.0) as usize {
            let mut goal = swing.at(cycle as f64 * PERIOD);
            let wanted = match kind {
                k if k > 0.9 => None,
                k if k > 0.85 => {
                    goal[1] = f64::NAN;
                    Some(&goal)
                }
                _ => Some(&goal),
            };
            rig.follow(wanted);
        }
        assert!(
            rig.watch.is_within(),
            "{} seed {seed} part {part}: {:?} {}",
            model.id,
            rig.watch.worst,
            rig.watch.out_of_range
        );
    }
}

#[test]
fn any_goals_keep_every_limit_and_range() {
    for model in ARMS {
        (1..=25).for_each(|seed| chain(model, seed));
    }
}

#[test]
fn without_a_goal_the_axes_come_to_rest() {
    let model = ARMS[0];
    let begin = middle(model);
    let swing = Swing::new(model, &begin, 0.9, 6.0);
    let mut rig = Rig::standing(model, &begin);
    for cycle in 1..300 {
        rig.follow(Some(&swing.at(f64::from(cycle) * PERIOD)));
    }
    for _ in 0..1500 {
        assert_eq!(rig.follow(None), f64::INFINITY);
    }
    assert_eq!(rig.watch.state().velocity, [0.0; 7]);
    assert!(rig.watch.is_within(), "{:?}", rig.watch.worst);
}
