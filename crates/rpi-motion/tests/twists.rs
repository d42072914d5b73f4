//! Motions with a constant twist: the path keeps the twist in its frame, and a motion along it, with directions that change at
//! random, keeps every limit and comes to rest where the arm cannot go on.

#[path = "takeovers/watch.rs"]
mod watch;
#[path = "support/xorshift.rs"]
mod xorshift;

use nalgebra::Vector3;
use rpi_kin::state_to_rest::Bounds;
use rpi_kin::{ArmModel, Pose, models};
use rpi_motion::path::{Piece, ToolPath, TwistFrame, TwistPath};
use rpi_motion::{Arm, Controls, Joints, MotionCore, Path};
use rpi_testkit::no_alloc;
use watch::{PERIOD, Watch};
use xorshift::Random;

rpi_testkit::trap_allocations!();

const ARMS: [&ArmModel; 4] = [
    &models::kuka_lbr::LWR_4_PLUS,
    &models::kuka_kr::KR_6_R900,
    &models::universal_robots::UR5E,
    &models::kuka_lbr::IIWA_7,
];

const REQUESTED: Bounds = Bounds {
    speed: 0.25,
    acceleration: 0.5,
    jerk: 5.0,
};

fn vector(random: &mut Random) -> Vector3<f64> {
    Vector3::from_fn(|_, _| random.between(-1.0, 1.0))
}

fn frame(random: &mut Random) -> TwistFrame {
    match random.unit() < 0.5 {
        true => TwistFrame::Base,
        false => TwistFrame::Tool,
    }
}

#[test]
fn the_path_has_the_twist_in_its_frame_everywhere() {
    let mut random = Random::new(1);
    let start = Pose::new(Vector3::new(0.5, 0.1, 0.4), Vector3::new(0.3, -0.4, 0.2));
    for _ in 0..50 {
        let (linear, angular) = (
            vector(&mut random),
            vector(&mut random) * random.between(0.0, 3.0),
        );
        let frame = frame(&mut random);
        let path = TwistPath::new(&start, &linear, &angular, frame).expect("a twist");
        let speed = rpi_motion::path::twist::twist_speed(&linear, &angular);
        for s in [0.0, 1e-4, 0.03, 0.4, 1.7] {
            let (h, at) = (1e-5, path.pose(s));
            let (before, after) = (path.pose(s - h), path.pose(s + h));
            let v = (after.translation.vector - before.translation.vector) / (2.0 * h);
            let w = (after.rotation * before.rotation.inverse()).scaled_axis() / (2.0 * h);
            let (v, w) = match frame {
                TwistFrame::Base => (v, w),
                TwistFrame::Tool => (at.rotation.inverse() * v, at.rotation.inverse() * w),
            };
            assert!(
                (v * speed - linear).norm() < 1e-8,
                "{frame:?} at {s}: {v:?} {linear:?}"
            );
            assert!(
                (w * speed - angular).norm() < 1e-8,
                "{frame:?} at {s}: {w:?} {angular:?}"
            );
            let bend = (after.translation.vector + before.translation.vector
                - at.translation.vector * 2.0)
                / (h * h);
            assert!(
                (bend.norm() - path.curvature().value).abs() < 1e-4,
                "{frame:?} at {s}"
            );
            let third = third_derivative(&path, s).norm();
            assert!(
                (third - path.curvature().third_derivative()).abs() < 1e-3,
                "{frame:?} at {s}: {third} {:?}",
                path.curvature()
            );
        }
    }
    let zero = Vector3::zeros();
    assert!(TwistPath::new(&start, &zero, &zero, TwistFrame::Base).is_none());
    assert!(TwistPath::new(&start, &(zero / 0.0), &zero, TwistFrame::Base).is_none());
}

/// Third derivative of the position with respect to the path parameter, by central differences.
fn third_derivative(path: &TwistPath, s: f64) -> Vector3<f64> {
    let h = 1e-3;
    let at = |k: f64| path.pose(s + k * h).translation.vector;
    ((at(-1.0) - at(1.0)) * 13.0 + (at(2.0) - at(-2.0)) * 8.0 - (at(3.0) - at(-3.0)))
        / (8.0 * h * h * h)
}

fn joints(model: &ArmModel, random: &mut Random) -> Joints {
    let mut q = [0.0; 7];
    for (slot, limits) in q.iter_mut().zip(model.limits) {
        let (low, high) = (
            limits.position.lower.max(-2.6),
            limits.position.upper.min(2.6),
        );
        let margin = 0.15 * (high - low);
        *slot = random.between(low + margin, high - margin);
    }
    q
}

/// Moves with random twists in turn, the last one for so long that the arm comes to a place where it cannot go on.
fn chain(model: &'static ArmModel, seed: u64) -> (usize, usize) {
    let arm = Arm::new(model, Pose::identity(), &[]);
    let mut random = Random::new(seed);
    let mut watch = Watch::standing(&joints(model, &mut random));
    let mut core = MotionCore::new(arm, PERIOD);
    let (mut ended, mut refused) = (0, 0);
    for number in 0..6 {
        let (linear, angular) = (
            vector(&mut random),
            vector(&mut random) * random.between(0.0, 2.0),
        );
        let start = arm.forward(watch.joints());
        let frame = frame(&mut random);
        let path = TwistPath::new(&start, &linear, &angular, frame).expect("a twist");
        let path = Path::Tool(ToolPath::new(Piece::Twist(path)));
        if no_alloc(|| core.begin(path, &watch.state(), REQUESTED)).is_err() {
            refused += 1;
            return (ended, refused);
        }
        let cycles = if number == 5 {
            60_000
        } else {
            50 + (random.unit() * 800.0) as usize
        };
        for cycle in 0..cycles {
            let Ok(at) = no_alloc(|| core.next_set_point(Controls::default())) else {
                panic!("{} seed {seed}: no set-point", model.id);
            };
            watch.push(&arm, &at.joints);
            let is_at_end = core.path_error().is_some() && at.path.s > core.goal() - 1e-3;
            if is_at_end && at.on_path && at.path.velocity == 0.0 {
                ended += 1;
                break;
            }
            if cycle + 1 == 60_000 {
                println!(
                    "{} seed {seed} {frame:?} rests not: {:?} goal {} {:?} {}",
                    model.id,
                    at.path,
                    core.goal(),
                    core.path_error(),
                    at.on_path
                );
            }
        }
        assert!(
            watch.is_within(),
            "{} seed {seed} motion {number}: {:?} {}",
            model.id,
            watch.worst,
            watch.out_of_range
        );
    }
    (ended, refused)
}

#[test]
fn motions_with_random_twists_keep_every_limit_and_rest_where_the_arm_cannot_go_on() {
    for model in ARMS {
        let counts = (1..=20).map(|seed| chain(model, seed));
        let (ended, refused) = counts.fold((0, 0), |sum, one| (sum.0 + one.0, sum.1 + one.1));
        println!("{}: {ended} ended, {refused} refused", model.id);
        assert!(ended >= 18 - refused, "{}: {ended} {refused}", model.id);
        assert!(refused <= 4, "{}: {refused}", model.id);
    }
}
