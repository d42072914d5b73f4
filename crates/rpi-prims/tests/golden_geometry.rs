//! Tests of geometric primitives by example: vectors, twists, wrenches, rotations and poses.

mod common;

use common::golden::check;
use common::value_of;
use rpi_prims::geometry;
use rpi_prims::value_types::{Pose, Rotation, Twist, Vector, Wrench};

rpi_testkit::trap_allocations!();

fn wrench(force: Vector, torque: Vector) -> Wrench {
    Wrench { force, torque }
}

fn twist(linear: Vector, angular: Vector) -> Twist {
    Twist { linear, angular }
}

fn sample_vectors() -> (Vector, Vector) {
    (Vector::new(1.0, 2.0, 3.0), Vector::new(-4.0, 5.0, 0.5))
}

/// Rotation by a right angle about the z axis.
fn quarter_turn() -> Rotation {
    geometry::from_abc(core::f64::consts::FRAC_PI_2, 0.0, 0.0)
}

fn check_vectors() {
    let (a, b) = sample_vectors();
    let quarter = quarter_turn();
    check(&[
        (
            "Rpi::VectorSubtract",
            &[value_of(a), value_of(b)],
            &[value_of(a - b)],
        ),
        ("Rpi::VectorNegate", &[value_of(a)], &[value_of(-a)]),
        (
            "Rpi::VectorDivide",
            &[value_of(a), value_of(2.0)],
            &[value_of(a / 2.0)],
        ),
        (
            "Rpi::VectorNorm",
            &[value_of(Vector::new(2.0, 3.0, 6.0))],
            &[value_of(7.0)],
        ),
        (
            "World::VectorRotate",
            &[value_of(Vector::x()), value_of(quarter)],
            &[value_of(Vector::y())],
        ),
    ]);
}

fn check_twists() {
    let (a, b) = sample_vectors();
    let quarter = quarter_turn();
    let parts = [1.0, 2.0, 3.0, 0.1, 0.2, 0.3].map(value_of);
    let about_zyx = Vector::new(0.3, 0.2, 0.1);
    check(&[
        (
            "World::TwistRotate",
            &[value_of(twist(Vector::x(), Vector::z())), value_of(quarter)],
            &[value_of(twist(Vector::y(), Vector::z()))],
        ),
        (
            "World::TwistChangeCenter",
            &[
                value_of(twist(Vector::x(), Vector::z())),
                value_of(Vector::x()),
            ],
            &[value_of(twist(Vector::new(1.0, 1.0, 0.0), Vector::z()))],
        ),
        (
            "World::TwistFromXYZ",
            &parts,
            &[value_of(twist(a, about_zyx))],
        ),
        (
            "World::TwistToXYZ",
            &[value_of(twist(a, about_zyx))],
            &parts,
        ),
        (
            "Rpi::TwistScale",
            &[value_of(twist(a, b)), value_of(2.0)],
            &[value_of(twist(a * 2.0, b * 2.0))],
        ),
        (
            "Rpi::TwistDivide",
            &[value_of(twist(a, b)), value_of(2.0)],
            &[value_of(twist(a / 2.0, b / 2.0))],
        ),
        (
            "Rpi::TwistSubtract",
            &[value_of(twist(a, b)), value_of(twist(b, a))],
            &[value_of(twist(a - b, b - a))],
        ),
        (
            "Rpi::TwistNegate",
            &[value_of(twist(a, b))],
            &[value_of(twist(-a, -b))],
        ),
    ]);
}

fn check_wrenches() {
    let (a, b) = sample_vectors();
    let parts = [1.0, 2.0, 3.0, 0.1, 0.2, 0.3].map(value_of);
    let about_zyx = Vector::new(0.3, 0.2, 0.1);
    check(&[
        (
            "World::WrenchFromXYZ",
            &parts,
            &[value_of(wrench(a, about_zyx))],
        ),
        (
            "Rpi::WrenchAdd",
            &[value_of(wrench(a, b)), value_of(wrench(b, a))],
            &[value_of(wrench(a + b, a + b))],
        ),
        (
            "Rpi::WrenchSubtract",
            &[value_of(wrench(a, b)), value_of(wrench(b, a))],
            &[value_of(wrench(a - b, b - a))],
        ),
        (
            "Rpi::WrenchNegate",
            &[value_of(wrench(a, b))],
            &[value_of(wrench(-a, -b))],
        ),
        (
            "Rpi::WrenchScale",
            &[value_of(wrench(a, b)), value_of(2.0)],
            &[value_of(wrench(a * 2.0, b * 2.0))],
        ),
        (
            "Rpi::WrenchDivide",
            &[value_of(wrench(a, b)), value_of(2.0)],
            &[value_of(wrench(a / 2.0, b / 2.0))],
        ),
        (
            "Rpi::WrenchRotate",
            &[
                value_of(wrench(Vector::x(), Vector::z())),
                value_of(quarter_turn()),
            ],
            &[value_of(wrench(Vector::y(), Vector::z()))],
        ),
        (
            "Rpi::WrenchToParts",
            &[value_of(wrench(a, b))],
            &[value_of(a), value_of(b)],
        ),
        (
            "Rpi::WrenchFromParts",
            &[value_of(a), value_of(b)],
            &[value_of(wrench(a, b))],
        ),
    ]);
}

fn check_rotations() {
    let quarter = quarter_turn();
    check(&[
        (
            "Rpi::RotationExponential",
            &[value_of(Vector::z() * core::f64::consts::FRAC_PI_2)],
            &[value_of(quarter)],
        ),
        (
            "Rpi::RotationLogarithm",
            &[value_of(quarter)],
            &[value_of(Vector::z() * core::f64::consts::FRAC_PI_2)],
        ),
        (
            "Rpi::RotationPower",
            &[value_of(quarter), value_of(2.0)],
            &[value_of(geometry::from_abc(
                core::f64::consts::PI,
                0.0,
                0.0,
            ))],
        ),
    ]);
}

#[test]
fn vectors_twists_and_wrenches() {
    check_vectors();
    check_twists();
    check_wrenches();
    check_rotations();
}

#[test]
fn poses() {
    let turned = geometry::from_abc(core::f64::consts::FRAC_PI_2, 0.0, 0.0);
    let pose = Pose::from_parts(Vector::new(1.0, 2.0, 3.0).into(), turned);
    check(&[
        (
            "World::FrameFromXYZ",
            &[
                value_of(1.0),
                value_of(2.0),
                value_of(3.0),
                value_of(turned),
            ],
            &[value_of(pose)],
        ),
        (
            "World::FrameToXYZ",
            &[value_of(pose)],
            &[
                value_of(1.0),
                value_of(2.0),
                value_of(3.0),
                value_of(turned),
            ],
        ),
        (
            "Rpi::FrameApply",
            &[value_of(pose), value_of(Vector::x())],
            &[value_of(Vector::new(1.0, 3.0, 3.0))],
        ),
        (
            "World::FrameTransform",
            &[value_of(pose), value_of(pose.inverse())],
            &[value_of(Pose::identity())],
        ),
    ]);
}

#[test]
fn euler_angles_at_the_gimbal_lock() {
    let lock = core::f64::consts::FRAC_PI_2;
    for (a, b, c) in [(0.3, lock, 0.1), (0.3, -lock, 0.1), (-2.0, lock, 1.0)] {
        let rotation = geometry::from_abc(a, b, c);
        let (a, b, c) = geometry::to_abc(rotation);
        assert_eq!(c, 0.0);
        assert!((b.abs() - lock).abs() < 1e-7);
        let angle = geometry::to_axis_angle(rotation.inverse() * geometry::from_abc(a, b, c)).1;
        assert!(angle < 1e-7, "{angle}");
    }
}
