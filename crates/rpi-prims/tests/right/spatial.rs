//! Tests of rotations and poses.

use crate::common::{self, TestBench, get, near, value_of};
use crate::one;
use rpi_prims::geometry;
use rpi_prims::value_types::{Pose, Rotation, Twist, Vector};
use std::f64::consts::FRAC_PI_2;

/// Returns rotations in all octants and some about one axis.
fn rotations() -> Vec<Rotation> {
    let angles = [-2.9, -1.0, 0.0, 0.3, 1.4];
    let abc = angles
        .iter()
        .flat_map(|a| angles.iter().map(move |b| (*a, *b)));
    abc.flat_map(|(a, b)| angles.map(|c| geometry::from_abc(a, b, c)))
        .collect()
}

pub(crate) fn same_rotation(a: Rotation, b: Rotation) {
    let sign = if a.coords.dot(&b.coords) < 0.0 {
        -1.0
    } else {
        1.0
    };
    near((a.coords * sign).as_slice(), b.coords.as_slice());
}

#[test]
fn a_rotation_leaves_its_axis_where_it_is() {
    for rotation in rotations() {
        let out =
            TestBench::new("World::RotationToAxisAngle", &[]).step_present(&[value_of(rotation)]);
        let (axis, angle): (Vector, f64) = (get(&out[0]), get(&out[1]));
        near((rotation * axis).as_slice(), axis.as_slice());
        same_rotation(geometry::exp(axis * angle), rotation);
    }
}

#[test]
fn a_rotation_goes_through_a_quaternion_unchanged() {
    for rotation in rotations() {
        let parts =
            TestBench::new("World::RotationToQuaternion", &[]).step_present(&[value_of(rotation)]);
        let back = one("World::RotationFromQuaternion", &parts);
        same_rotation(get(&back), rotation);
    }
}

fn pose(x: f64, y: f64, z: f64, abc: (f64, f64, f64)) -> Pose {
    Pose::from_parts(
        Vector::new(x, y, z).into(),
        geometry::from_abc(abc.0, abc.1, abc.2),
    )
}

fn same_pose(a: Pose, b: Pose) {
    near(
        a.translation.vector.as_slice(),
        b.translation.vector.as_slice(),
    );
    same_rotation(a.rotation, b.rotation);
}

const FROM: (f64, f64, f64) = (0.3, -0.2, 1.0);
const TO: (f64, f64, f64) = (-1.1, 0.7, 0.4);

#[test]
fn interpolated_poses_start_and_end_where_they_should() {
    let (from, to) = (pose(0.1, 0.2, 0.3, FROM), pose(-0.4, 0.5, 0.1, TO));
    let at = |amount: f64| {
        get::<Pose>(&one(
            "World::FrameLerp",
            &[value_of(from), value_of(to), value_of(amount)],
        ))
    };
    same_pose(at(0.0), from);
    same_pose(at(1.0), to);
    let half = geometry::to_axis_angle(from.rotation.inverse() * at(0.5).rotation).1;
    let whole = geometry::to_axis_angle(from.rotation.inverse() * to.rotation).1;
    near(&[half * 2.0], &[whole]);
}

#[test]
fn a_twist_from_two_frames_leads_from_one_to_the_other() {
    let (from, to) = (pose(0.1, 0.2, 0.3, FROM), pose(-0.4, 0.5, 0.1, TO));
    let twist = one("World::TwistFromFrames", &[value_of(from), value_of(to)]);
    let end = one("World::FrameAddTwist", &[value_of(from), twist]);
    same_pose(get(&end), to);
}

#[test]
fn poses_generated_online_arrive() {
    let goal = pose(-0.4, 0.5, 0.1, TO);
    let limits = [0.5, 2.0, 1.0, 4.0].map(value_of);
    let (mut at, mut velocity) = (pose(0.1, 0.2, 0.3, FROM), Twist::default());
    let mut rig = TestBench::new("World::FrameOTG", &[]);
    for _ in 0..600 {
        let mut inputs = vec![
            value_of(at),
            value_of(velocity),
            value_of(goal),
            value_of(Twist::default()),
        ];
        inputs.extend(limits.clone());
        let out = rig.step_present(&inputs);
        let next: Twist = get(&out[1]);
        let change = (next.linear - velocity.linear).norm();
        assert!(change <= 2.0 * common::DT + 1e-12 && next.linear.norm() <= 0.5 + 1e-12);
        (at, velocity) = (get(&out[0]), next);
    }
    let left = goal.inverse() * at;
    assert!(left.translation.vector.norm() < 1e-6 && geometry::log(left.rotation).norm() < 1e-6);
}

#[test]
fn a_curve_of_rotations_keeps_its_ends_and_velocities() {
    let (from, to) = (
        geometry::from_abc(0.3, -0.2, 1.0),
        geometry::from_abc(-0.1, 0.4, 0.9),
    );
    let (v, w) = (Vector::new(0.2, -0.1, 0.4), Vector::new(-0.3, 0.5, 0.1));
    let at = |t: f64| {
        get::<Rotation>(&one(
            "World::RotationBezier",
            &[
                value_of(t),
                value_of(from),
                value_of(v),
                value_of(w),
                value_of(to),
            ],
        ))
    };
    same_rotation(at(0.0), from);
    same_rotation(at(1.0), to);
    let h = 1e-6;
    let start = geometry::log(from.inverse() * at(h)) / h;
    let end = geometry::log(at(1.0 - h).inverse() * to) / h;
    assert!(
        (start - v).norm() < 1e-5 && (end - w).norm() < 1e-5,
        "{start} {end}"
    );
}

#[test]
fn small_and_unscaled_quaternions_are_rotations() {
    let small = one(
        "World::RotationFromQuaternion",
        &[1e-6, 0.0, 0.0, 1.0].map(value_of),
    );
    near(&[geometry::to_axis_angle(get(&small)).1], &[2e-6]);
    let scaled = one(
        "World::RotationFromQuaternion",
        &[0.0, 0.0, 3.0, 3.0].map(value_of),
    );
    same_rotation(get(&scaled), geometry::from_abc(FRAC_PI_2, 0.0, 0.0));
}
