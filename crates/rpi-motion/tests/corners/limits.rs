//! Which bound makes a motion slower than requested, and an endless task over corners.

use crate::{PERIOD, corner};
use nalgebra::{Translation3, Vector3};
use rpi_kin::state_to_rest::Bounds;
use rpi_kin::{Pose, models};
use rpi_motion::path::ToolPath;
use rpi_motion::{Arm, Controls, JointState, Joints, MotionCore, Path, SpeedBound, check_path};

const JOINTS: Joints = [0.1, -1.6, 1.9, 0.2, 0.6, 0.1, 0.0];

const DEFAULT: Bounds = Bounds {
    speed: 0.25,
    acceleration: 0.5,
    jerk: 5.0,
};

fn arm() -> Arm {
    Arm::new(&models::kuka_kr::KR_6_R900, Pose::identity(), &[])
}

#[test]
fn a_corner_that_is_too_tight_names_the_bound_and_the_place() {
    let arm = arm();
    let bounds_and_zones = [
        (DEFAULT, 0.01, Some(SpeedBound::ToolJerk)),
        (
            Bounds {
                jerk: 500.0,
                ..DEFAULT
            },
            0.01,
            Some(SpeedBound::ToolAcceleration),
        ),
        (
            Bounds {
                speed: 0.03,
                ..DEFAULT
            },
            0.01,
            None,
        ),
    ];
    for (requested, zone, bound) in bounds_and_zones {
        let start = arm.forward(&JOINTS);
        let tool = corner(&start, 0.15, 90f64.to_radians(), zone, 0.1);
        let path = Path::Tool(tool);
        let report = check_path(&arm, path, &JOINTS, requested).expect("a path");
        assert_eq!(report.limit.map(|limit| limit.bound), bound);
        let (low, high) = (0.15 - zone, path.length() - 0.15 + zone);
        let in_zone = |s: f64| (low..=high).contains(&s);
        assert!(report.limit.is_none_or(|limit| in_zone(limit.s)));
        // The motion names it before the zone.
        let mut core = MotionCore::new(arm, PERIOD);
        core.begin(path, &JointState::at_rest(JOINTS), requested)
            .expect("reachable");
        let mut named = None;
        loop {
            let at = core.next_set_point(Controls::default()).expect("a cycle");
            if at.path.s >= low {
                break;
            }
            named = core.speed_limit().or(named);
        }
        assert_eq!(named.map(|limit| limit.bound), bound);
        assert!(named.is_none_or(|limit| in_zone(limit.s)), "{named:?}");
    }
}

#[test]
fn the_axis_that_makes_a_line_slow_is_named() {
    // Past the wrist singularity: axis 5 at 0.
    let arm = arm();
    let joints = [0.1, -1.6, 1.9, 0.2, 0.02, 0.1, 0.0];
    let start = arm.forward(&joints);
    let to = Pose::from_parts(
        Translation3::from(start.translation.vector + Vector3::new(0.0, 0.2, 0.0)),
        start.rotation,
    );
    let path = Path::line(&start, &to);
    let report = check_path(&arm, path, &joints, DEFAULT).expect("a path");
    let limit = report.limit.expect("an axis is too slow");
    assert!(
        matches!(
            limit.bound,
            SpeedBound::AxisVelocity { axis: 3 | 5 }
                | SpeedBound::AxisAcceleration { axis: 3 | 5 }
                | SpeedBound::AxisJerk { axis: 3 | 5 }
        ),
        "{limit}"
    );
    assert!(limit.velocity < DEFAULT.speed && limit.s < 0.1, "{limit}");
}

/// A hexagon around the start, run through for ever: six corners, and the next round takes over on the last side.
#[test]
fn an_endless_task_of_six_corners_never_stops() {
    let arm = arm();
    let start = arm.forward(&JOINTS);
    let at = |k: usize| {
        let (sin, cos) = rpi_math::sincos((60.0 * k as f64).to_radians());
        let way = Vector3::new(-0.15 + 0.15 * cos, 0.15 * sin, 0.0);
        Pose::from_parts(
            Translation3::from(start.translation.vector + way),
            start.rotation,
        )
    };
    let round = |from: Pose| {
        let points = [from, at(1), at(2), at(3), at(4), at(5), at(6), at(7)];
        Path::Tool(ToolPath::polyline(&points, &[0.03; 6]).expect("six corners"))
    };
    let mut path = round(start);
    let mut core = MotionCore::new(arm, PERIOD);
    core.begin(path, &JointState::at_rest(JOINTS), DEFAULT)
        .expect("reachable");
    let mut last = [JOINTS; 3];
    let (mut rounds, mut cycles, mut slowest) = (0, 0, f64::INFINITY);
    while rounds < 4 {
        let place = core.next_set_point(Controls::default()).expect("a cycle");
        cycles += 1;
        last.rotate_left(1);
        last[2] = place.joints;
        let speed = tool_speed(&arm, &last);
        if cycles > 1000 {
            slowest = f64::min(slowest, speed);
        }
        if place.path.s > path.length() - 0.1 {
            let velocity = core::array::from_fn(|k| (last[2][k] - last[1][k]) / PERIOD);
            let acceleration = core::array::from_fn(|k| {
                (last[2][k] - 2.0 * last[1][k] + last[0][k]) / (PERIOD * PERIOD)
            });
            let state = JointState::from_differences(last[2], velocity, acceleration, PERIOD);
            path = round(arm.forward(&last[2]));
            core.begin(path, &state, DEFAULT).expect("reachable");
            rounds += 1;
        }
        assert!(cycles < 100_000, "round {rounds} is endless");
    }
    println!("slowest {slowest} m/s");
    assert!(slowest > 0.05, "{slowest}");
}

fn tool_speed(arm: &Arm, last: &[Joints; 3]) -> f64 {
    let place = |joints| arm.forward(joints).translation.vector;
    (place(&last[2]) - place(&last[1])).norm() / PERIOD
}
