//! Splines through poses: they pass through all points, with continuous direction, curvature, angular velocity and angular
//! acceleration, at unit speed; and the reasons for which there is none.

#[path = "support/xorshift.rs"]
mod xorshift;

use nalgebra::{Translation3, UnitQuaternion, Vector3};
use rpi_kin::Pose;
use rpi_motion::path::spline::MAX_POINTS;
use rpi_motion::path::{SplineError, ToolPath};
use xorshift::Random;

fn pose(position: Vector3<f64>, turn: Vector3<f64>) -> Pose {
    let rotation = UnitQuaternion::from_scaled_axis(turn);
    Pose::from_parts(Translation3::from(position), rotation)
}

fn at(x: f64, y: f64) -> Pose {
    Pose::translation(x, y, 0.0)
}

/// Points of a random walk that turns by at most about a right angle at each point.
fn points(random: &mut Random, count: usize) -> Vec<Pose> {
    let mut course = Vector3::x();
    let mut points = vec![pose(Vector3::new(0.5, 0.1, 0.4), Vector3::zeros())];
    while points.len() < count {
        let here = points[points.len() - 1];
        let mut vector = |most: f64| Vector3::from_fn(|_, _| random.between(-most, most));
        course = (course + vector(0.6)).normalize();
        let (turn, length) = (vector(0.1), 0.07 + vector(0.02).x);
        let rotation = UnitQuaternion::from_scaled_axis(turn) * here.rotation;
        let place = here.translation.vector + course * length;
        points.push(Pose::from_parts(Translation3::from(place), rotation));
    }
    points
}

/// Places on the path (path parameter) at which it is nearest to each point, in order.
fn places(path: &ToolPath, points: &[Pose]) -> Vec<f64> {
    let off =
        |s: f64, point: &Pose| (path.pose(s).translation.vector - point.translation.vector).norm();
    let mut from = 0.0;
    let find = |point: &Pose| {
        let step = 1e-3;
        let count = ((path.length() - from) / step) as usize + 1;
        let near = (0..=count).map(|k| from + k as f64 * step);
        let first = near.min_by(|a, b| off(*a, point).total_cmp(&off(*b, point)));
        let (mut low, mut high) = (first.unwrap() - step, first.unwrap() + step);
        for _ in 0..100 {
            let (one, other) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
            match off(one, point) < off(other, point) {
                true => high = other,
                false => low = one,
            }
        }
        from = f64::midpoint(low, high);
        from
    };
    points.iter().map(find).collect()
}

#[test]
fn a_spline_passes_through_all_points_with_their_orientations() {
    let mut random = Random::new(1);
    for count in 2..=MAX_POINTS {
        let points = points(&mut random, count);
        let path = ToolPath::spline(&points).expect("a spline");
        for (s, point) in places(&path, &points).into_iter().zip(&points) {
            let found = path.pose(s);
            let off = (found.translation.vector - point.translation.vector).norm();
            assert!(off < 1e-9, "{count}: {off} at {s}");
            let turned = found.rotation.angle_to(&point.rotation);
            assert!(turned < 1e-6, "{count}: {turned} at {s}");
        }
    }
}

/// One-sided derivatives by the path parameter, of the position (first, second) and of the orientation (angular velocity,
/// angular acceleration), over the side of `s` to which the step `h` points.
fn derivatives(path: &ToolPath, s: f64, h: f64) -> [Vector3<f64>; 4] {
    let position = |k: f64| path.pose(s + k * h).translation.vector;
    // Rotation vectors from the orientation at `s`, in its frame: to first order at `s`, their derivatives are those of the
    // orientation.
    let rotation =
        |k: f64| (path.pose(s).rotation.inverse() * path.pose(s + k * h).rotation).scaled_axis();
    let first = |f: &dyn Fn(f64) -> Vector3<f64>| {
        (f(0.0) * -25.0 + f(1.0) * 48.0 - f(2.0) * 36.0 + f(3.0) * 16.0 - f(4.0) * 3.0) / (12.0 * h)
    };
    let second = |f: &dyn Fn(f64) -> Vector3<f64>| {
        (f(0.0) * 35.0 - f(1.0) * 104.0 + f(2.0) * 114.0 - f(3.0) * 56.0 + f(4.0) * 11.0)
            / (12.0 * h * h)
    };
    [
        first(&position),
        second(&position),
        first(&rotation),
        second(&rotation),
    ]
}

#[test]
fn a_spline_has_unit_speed_and_continuous_second_derivatives_at_its_points() {
    let mut random = Random::new(2);
    for _ in 0..20 {
        let points = points(&mut random, 8);
        let path = ToolPath::spline(&points).expect("a spline");
        for s in places(&path, &points).into_iter().skip(1).take(6) {
            let (before, after) = (derivatives(&path, s, -2e-4), derivatives(&path, s, 2e-4));
            for (order, (one, other)) in before.iter().zip(&after).enumerate() {
                let jump = (one - other).norm();
                let most = [1e-6, 5e-3, 1e-6, 5e-3][order] * (1.0 + one.norm());
                assert!(jump < most, "derivative {order} at {s}: {one:?} {other:?}");
            }
            assert!((before[0].norm() - 1.0).abs() < 1e-6);
        }
    }
}

#[test]
fn a_spline_through_two_points_is_a_line_and_through_points_of_a_line_stays_on_it() {
    let path = ToolPath::spline(&[at(0.0, 0.0), at(0.1, 0.0), at(0.3, 0.0), at(0.35, 0.0)]);
    let path = path.expect("a spline");
    assert!((path.length() - 0.35).abs() < 1e-12);
    for s in [0.0, 0.05, 0.2, 0.35] {
        let off = (path.pose(s).translation.vector - Vector3::new(s, 0.0, 0.0)).norm();
        assert!(off < 1e-12, "{s}: {off}");
    }
    let two = ToolPath::spline(&[at(0.0, 0.0), at(0.3, 0.4)]).expect("a spline");
    assert!((two.length() - 0.5).abs() < 1e-12);
}

#[test]
fn each_reason_for_which_there_is_no_spline_has_its_error() {
    let error = |points: &[Pose]| ToolPath::spline(points).err();
    assert_eq!(error(&[]), Some(SplineError::Counts));
    assert_eq!(error(&[at(0.0, 0.0)]), Some(SplineError::Counts));
    let many: Vec<Pose> = (0..=MAX_POINTS).map(|k| at(0.1 * k as f64, 0.0)).collect();
    assert_eq!(error(&many), Some(SplineError::Counts));
    assert_eq!(error(&many[1..]), None);
    assert_eq!(
        error(&[many[0], many[1], many[1]]),
        Some(SplineError::SamePoint(1))
    );
    assert_eq!(
        error(&[at(f64::NAN, 0.0), many[1]]),
        Some(SplineError::SamePoint(0))
    );
    assert_eq!(
        error(&[many[0], many[1], many[0]]),
        Some(SplineError::Reversal(1))
    );
    let turned = pose(Vector3::new(0.2, 0.0, 0.0), Vector3::new(0.0, 0.0, 1.0));
    assert_eq!(
        error(&[many[0], many[1], turned]),
        Some(SplineError::TurningDecides(1))
    );
}

/// Curvature, its derivative and the third derivative out of the plane of the curve, by central differences of fourth
/// order of the position at a place between two points.
fn numeric_curvature(path: &ToolPath, s: f64) -> [f64; 3] {
    const H: f64 = 4e-4;
    let at = |k: f64| path.pose(s + k * H).translation.vector;
    let direction = ((at(1.0) - at(-1.0)) * 8.0 - (at(2.0) - at(-2.0))) / (12.0 * H);
    let bend =
        ((at(1.0) + at(-1.0)) * 16.0 - (at(2.0) + at(-2.0)) - at(0.0) * 30.0) / (12.0 * H * H);
    let third = ((at(-1.0) - at(1.0)) * 13.0 + (at(2.0) - at(-2.0)) * 8.0 - (at(3.0) - at(-3.0)))
        / (8.0 * H * H * H);
    let normal = bend.normalize();
    let binormal = direction.cross(&normal);
    [bend.norm(), third.dot(&normal), third.dot(&binormal).abs()]
}

#[test]
fn the_curvature_is_that_of_the_positions_in_three_dimensions() {
    let mut random = Random::new(7);
    let mut most_twisted: f64 = 0.0;
    for count in 3..=MAX_POINTS {
        let points = points(&mut random, count);
        let path = ToolPath::spline(&points).expect("a spline");
        let ends = places(&path, &points);
        let whole = rpi_motion::Path::Tool(path);
        for pair in ends.windows(2) {
            for share in [0.2, 0.5, 0.8] {
                let s = pair[0] + share * (pair[1] - pair[0]);
                let known = whole.curvature(s);
                let [value, slope, twist] = numeric_curvature(&path, s);
                let close = |a: f64, b: f64| (a - b).abs() < 2e-2 + 1e-3 * value.max(a.abs());
                let is_close = close(known.value, value)
                    && close(known.slope, slope)
                    && close(known.twist, twist);
                assert!(
                    is_close,
                    "{known:?}, but {:?} at {s}",
                    [value, slope, twist]
                );
                most_twisted = most_twisted.max(twist);
            }
        }
    }
    assert!(
        most_twisted > 10.0,
        "all splines were plane: {most_twisted}"
    );
}
