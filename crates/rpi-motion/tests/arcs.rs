//! Arcs by via point, by centre and by angle: geometry, and the reasons for which there is none.

use core::f64::consts::{PI, TAU};
use nalgebra::{Translation3, UnitQuaternion, Vector3};
use rpi_kin::Pose;
use rpi_motion::path::{Arc, ArcError, ArcOrientation, Piece, ToolPath};

fn pose(position: Vector3<f64>, turn: Vector3<f64>) -> Pose {
    let rotation = UnitQuaternion::from_scaled_axis(turn);
    Pose::from_parts(Translation3::from(position), rotation)
}

fn start() -> Pose {
    pose(Vector3::new(0.5, 0.1, 0.4), Vector3::new(0.3, -0.4, 0.2))
}

fn path(arc: Arc) -> ToolPath {
    ToolPath::new(Piece::Arc(arc))
}

fn is_near(one: &Pose, other: &Pose) -> bool {
    (one.translation.vector - other.translation.vector).norm() < 1e-12
        && (one.rotation.inverse() * other.rotation).angle() < 1e-12
}

#[test]
fn an_arc_by_its_centre_is_the_shorter_one_and_ends_where_it_shall() {
    let from = start();
    let centre = Vector3::new(0.4, 0.3, 0.5);
    let spoke = from.translation.vector - centre;
    for degrees in [1, 45, 90, 135, 179] {
        let angle = f64::from(degrees).to_radians();
        let normal = nalgebra::Unit::new_normalize(spoke.cross(&Vector3::z()));
        let turned = UnitQuaternion::from_axis_angle(&normal, angle);
        let to = pose(centre + turned * spoke, Vector3::new(0.0, 0.1, 0.0));
        let arc = Arc::by_centre(&from, &centre, &to).expect("an arc");
        assert!((arc.radius() - spoke.norm()).abs() < 1e-12);
        assert!(
            (arc.way() - spoke.norm() * angle).abs() < 1e-12,
            "{degrees}"
        );
        let path = path(arc);
        assert!(is_near(&path.pose(0.0), &from) && is_near(&path.pose(path.length()), &to));
        let middle = path.pose(path.length() / 2.0).translation.vector;
        assert!(((middle - centre).norm() - spoke.norm()).abs() < 1e-12);
    }
}

#[test]
fn a_centre_that_is_slightly_off_is_moved_and_one_that_is_far_off_is_rejected() {
    let from = start();
    let centre = from.translation.vector - Vector3::new(0.1, 0.0, 0.0);
    let to = pose(centre + Vector3::new(0.0, 0.1, 0.0), Vector3::zeros());
    let off = |x: f64| Arc::by_centre(&from, &(centre + Vector3::new(x, 0.0, 0.0)), &to);
    let path = path(off(1e-3).expect("within the tolerance"));
    assert!(is_near(&path.pose(path.length()), &to) && is_near(&path.pose(0.0), &from));
    assert_eq!(off(5e-3).err(), Some(ArcError::UnequalRadii));
}

#[test]
fn an_arc_by_angle_may_turn_more_than_once() {
    let from = start();
    let (centre, axis) = (Vector3::new(0.4, 0.1, 0.0), Vector3::new(0.0, 0.0, 2.0));
    for angle in [0.3, -0.3, PI, TAU, -2.5 * TAU, 3.25 * TAU] {
        for orientation in [ArcOrientation::Fixed, ArcOrientation::Turning] {
            let arc = Arc::by_angle(&from, &centre, &axis, angle, orientation).expect("an arc");
            assert!((arc.way() - 0.1 * angle.abs()).abs() < 1e-12, "{angle}");
            let path = path(arc);
            for share in [0.0, 0.2, 0.5, 1.0] {
                let at = path.pose(path.length() * share);
                let turned = UnitQuaternion::from_scaled_axis(Vector3::z() * angle * share);
                let expected = Vector3::new(0.4, 0.1, 0.4) + turned * Vector3::new(0.1, 0.0, 0.0);
                let rotation = match orientation {
                    ArcOrientation::Fixed => from.rotation,
                    ArcOrientation::Turning => turned * from.rotation,
                };
                let expected = Pose::from_parts(Translation3::from(expected), rotation);
                assert!(is_near(&at, &expected), "{angle} {share} {orientation:?}");
            }
        }
    }
}

#[test]
fn each_reason_for_which_there_is_no_arc_has_its_error() {
    let from = start();
    let here = from.translation.vector;
    let at = |x: f64, y: f64| here + Vector3::new(x, y, 0.0);
    let to = |x: f64, y: f64| pose(at(x, y), Vector3::zeros());
    let via = |x, y| Arc::via(&from, &at(x, y), &to(0.2, 0.0)).err();
    assert_eq!(via(0.1, 0.0), Some(ArcError::Colinear));
    assert_eq!(via(f64::NAN, 0.0), Some(ArcError::Colinear));
    let half = Arc::by_centre(&from, &at(0.1, 0.0), &to(0.2, 0.0));
    assert_eq!(half.err(), Some(ArcError::Colinear));
    let unequal = Arc::by_centre(&from, &at(0.1, 0.0), &to(0.1, 0.2));
    assert_eq!(unequal.err(), Some(ArcError::UnequalRadii));
    let about = |centre: Vector3<f64>, axis: Vector3<f64>, angle| {
        Arc::by_angle(&from, &centre, &axis, angle, ArcOrientation::Fixed).err()
    };
    let (centre, z) = (at(0.1, 0.0), Vector3::z());
    assert_eq!(about(centre, z, 0.0), Some(ArcError::NoAngle));
    assert_eq!(about(centre, z, f64::INFINITY), Some(ArcError::NoAngle));
    assert_eq!(about(centre, Vector3::zeros(), 1.0), Some(ArcError::OnAxis));
    assert_eq!(about(here + z, z, 1.0), Some(ArcError::OnAxis));
    assert_eq!(about(centre, z, 1.0), None);
}
