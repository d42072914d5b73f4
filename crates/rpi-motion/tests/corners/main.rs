//! Corners within zones: geometry, and speed and bounds of the tool when an arm follows them.

use nalgebra::{Rotation3, Translation3, UnitQuaternion, Vector3};
use rpi_kin::state_to_rest::Bounds;
use rpi_kin::{ArmModel, Pose, models};
use rpi_motion::path::{Piece, ToolPath};
use rpi_motion::{Arm, Controls, JointState, Joints, MotionCore, Path};

mod limits;
mod speed;

pub(crate) const PERIOD: f64 = 1e-3;

/// Two sides of a length (m) that turn by an angle (rad) at a point, in a plane through `start`.
pub(crate) fn corner(start: &Pose, side: f64, turn: f64, zone: f64, tilt: f64) -> ToolPath {
    let plane = Rotation3::from_euler_angles(0.4, 0.3, 0.2);
    let first = plane * Vector3::x() * side;
    let second = plane * Vector3::new(rpi_math::cos(turn), rpi_math::sin(turn), 0.0) * side;
    let turned = UnitQuaternion::from_scaled_axis(Vector3::y() * tilt) * start.rotation;
    let middle = start.translation.vector + first;
    let points = [
        *start,
        Pose::from_parts(Translation3::from(middle), turned),
        Pose::from_parts(Translation3::from(middle + second), start.rotation),
    ];
    ToolPath::polyline(&points, &[zone]).expect("a corner")
}

fn position(path: &ToolPath, s: f64) -> Vector3<f64> {
    path.pose(s).translation.vector
}

/// Barycentric coordinates are not negative in the triangle; its plane is left by at most `eps`.
fn is_in_triangle(p: &Vector3<f64>, [a, b, c]: &[Vector3<f64>; 3], eps: f64) -> bool {
    let (u, v, w) = (b - a, c - a, p - a);
    let normal = u.cross(&v);
    let area = normal.norm_squared();
    let (one, other) = (
        w.cross(&v).dot(&normal) / area,
        u.cross(&w).dot(&normal) / area,
    );
    let eps = eps / area.sqrt().sqrt();
    one >= -eps
        && other >= -eps
        && one + other <= 1.0 + eps
        && (w.dot(&normal) / area.sqrt()).abs() < 1e-12
}

#[test]
fn the_tool_stays_in_the_triangle_of_the_corner_and_is_smooth_at_both_ends() {
    let start = Pose::translation(0.5, 0.1, 0.4);
    for degrees in (10..=170).step_by(10) {
        for zone in [0.001, 0.01, 0.05, 0.2] {
            let turn = f64::from(degrees).to_radians();
            let path = corner(&start, 0.5, turn, zone, 0.3);
            let (low, high) = (0.5 - zone, path.length() - (0.5 - zone));
            let tip = position(&path, low)
                + (position(&path, low) - position(&path, 0.0)).normalize() * zone;
            let triangle = [position(&path, low), tip, position(&path, high)];
            for k in 0..=400 {
                let s = low + (high - low) * f64::from(k) / 400.0;
                let p = position(&path, s);
                assert!(
                    is_in_triangle(&p, &triangle, 1e-9),
                    "{degrees}° zone {zone} at {s}: {p:?}"
                );
            }
            // The length is the length: unit speed, also across both joins; no jump in the second derivative.
            let h = zone * 1e-3;
            for s in [low, low + 0.3 * (high - low), high] {
                let speed = (position(&path, s + h) - position(&path, s - h)).norm() / (2.0 * h);
                assert!(
                    (speed - 1.0).abs() < 1e-5,
                    "{degrees}° zone {zone}: {speed}"
                );
            }
            for s in [low, high] {
                let bend = |s: f64| {
                    (position(&path, s + h) - position(&path, s) * 2.0 + position(&path, s - h))
                        / (h * h)
                };
                let jump = (bend(s + 2.0 * h) - bend(s - 2.0 * h)).norm() * zone;
                assert!(jump < 0.12, "{degrees}° zone {zone}: {jump}");
            }
        }
    }
}

/// What was seen of the tool on its way through a corner.
pub(crate) struct Followed {
    /// Lowest speed in the corner and the speed that its curvature allows there, m/s.
    pub(crate) slowest: f64,
    pub(crate) allowed: f64,
    /// Largest shares of the requested velocity, acceleration and jerk of the tool.
    pub(crate) worst: [f64; 3],
    last: [Vector3<f64>; 4],
}

impl Followed {
    pub(crate) fn new(start: Vector3<f64>, allowed: f64) -> Self {
        Self {
            slowest: f64::INFINITY,
            allowed,
            worst: [0.0; 3],
            last: [start; 4],
        }
    }

    /// Takes the next pose of the tool.
    pub(crate) fn push(&mut self, tool: &Pose, requested: &Bounds) {
        self.last.rotate_left(1);
        self.last[3] = tool.translation.vector;
        let [a, b, c, d] = self.last;
        let shares = [
            (d - c).norm() / PERIOD / requested.speed,
            (d - c * 2.0 + b).norm() / (PERIOD * PERIOD) / requested.acceleration,
            (d - (c - b) * 3.0 - a).norm() / (PERIOD * PERIOD * PERIOD) / requested.jerk,
        ];
        for (worst, share) in self.worst.iter_mut().zip(shares) {
            *worst = worst.max(share);
        }
    }
}

/// Greatest steady speed (m/s) between two places of a path: that of the curvature, or the requested one.
pub(crate) fn speed_of_formula(path: &Path, (low, high): (f64, f64), requested: &Bounds) -> f64 {
    let places = (0..=200).map(|k| low + (high - low) * f64::from(k) / 200.0);
    places
        .map(|s| {
            let k = path.curvature(s);
            let sideways = (requested.acceleration / k.value.max(1e-9)).sqrt();
            let turning = rpi_math::hypot(k.slope, k.value * k.value).max(1e-9);
            sideways.min(rpi_math::cbrt(requested.jerk / turning))
        })
        .fold(requested.speed, f64::min)
}

fn follow(
    model: &'static ArmModel,
    joints: Joints,
    turn: f64,
    zone: f64,
    requested: Bounds,
) -> Followed {
    let arm = Arm::new(model, Pose::identity(), &[]);
    let (side, start) = (0.15, arm.forward(&joints));
    let path = corner(&start, side, turn, zone, 0.1);
    let (low, high) = (side - zone, path.length() - (side - zone));
    let mut core = MotionCore::new(arm, PERIOD);
    core.begin(Path::Tool(path), &JointState::at_rest(joints), requested)
        .expect("reachable");
    let allowed = speed_of_formula(&Path::Tool(path), (low, high), &requested);
    let mut followed = Followed::new(start.translation.vector, allowed);
    for _ in 0..100_000 {
        let at = core
            .next_set_point(Controls::default())
            .expect("on the path");
        followed.push(&arm.forward(&at.joints), &requested);
        if at.path.s > low && at.path.s < high {
            followed.slowest = followed.slowest.min(at.path.velocity);
        }
        if at.done {
            return followed;
        }
    }
    panic!(
        "not done: {turn} {zone} {requested:?} at {:?}",
        core.path_error()
    );
}

#[test]
fn a_corner_is_passed_at_the_speed_that_its_curvature_allows() {
    let model = &models::kuka_kr::KR_6_R900;
    let joints = [0.1, -1.6, 1.9, 0.2, 0.6, 0.1, 0.0];
    for degrees in [30, 60, 90, 120, 150] {
        for (zone, speed) in [
            (0.002, 2.0),
            (0.01, 0.01),
            (0.01, 0.25),
            (0.05, 0.25),
            (0.07, 2.0),
        ] {
            let requested = Bounds {
                speed,
                acceleration: 0.5,
                jerk: 5.0,
            };
            let turn = f64::from(degrees).to_radians();
            let followed = follow(model, joints, turn, zone, requested);
            let share = followed.slowest / followed.allowed;
            println!("{degrees} {zone} {speed}: {share:.4} {:?}", followed.worst);
            // The sides are too short to reach the speed that a wide, gentle corner would allow.
            let reachable = followed.allowed < 0.25;
            assert!(
                share > 0.95 || !reachable,
                "{degrees}° zone {zone} speed {speed}: {share}"
            );
            assert!(
                followed.worst.iter().all(|worst| *worst <= 1.0001),
                "{degrees} {zone} {speed}: {:?}",
                followed.worst
            );
        }
    }
}

#[test]
fn a_polyline_keeps_lines_between_its_corners_and_refuses_what_has_none() {
    use rpi_motion::path::ZoneError;
    let at = |x: f64, y: f64| Pose::translation(x, y, 0.0);
    let square = [at(0.0, 0.0), at(0.2, 0.0), at(0.2, 0.2), at(0.0, 0.2)];
    let path = ToolPath::polyline(&square, &[0.05, 0.3]).expect("a path");
    // The second zone is cut to half of the sides, so the corners leave 50 mm of the middle side.
    assert_eq!(position(&path, 0.15), Vector3::new(0.15, 0.0, 0.0));
    assert!(path.length() < 0.6 && path.length() > 0.5);
    let error = |points: &[Pose], zones: &[f64]| ToolPath::polyline(points, zones).err();
    assert_eq!(error(&square, &[0.05]), Some(ZoneError::Counts));
    assert_eq!(error(&square, &[0.05, 0.0]), Some(ZoneError::NoZone(2)));
    assert_eq!(
        error(&[square[0], square[0], square[1]], &[0.1]),
        Some(ZoneError::SamePoint(0))
    );
    assert_eq!(
        error(&[at(0.0, 0.0), at(0.2, 0.0), at(0.0, 0.0)], &[0.1]),
        Some(ZoneError::Reversal(1))
    );
    let _ = Piece::Line(rpi_motion::path::Line::new(&square[0], &square[1]));
}
