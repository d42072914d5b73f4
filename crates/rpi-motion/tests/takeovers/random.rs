//! Random numbers, poses and motions by seed.

use nalgebra::{Translation3, UnitQuaternion, Vector3};
use rpi_kin::state_to_rest::Bounds;
use rpi_kin::{ArmModel, Pose};
use rpi_motion::path::spline::MAX_POINTS;
use rpi_motion::path::{Arc, ArcOrientation, Piece, ToolPath};
use rpi_motion::{Arm, Joints, Path};

#[path = "../support/xorshift.rs"]
mod xorshift;

pub(crate) use xorshift::Random;

impl Random {
    pub(crate) fn below(&mut self, count: usize) -> usize {
        ((self.unit() * count as f64) as usize).min(count - 1)
    }

    pub(crate) fn direction(&mut self) -> Vector3<f64> {
        loop {
            let v = Vector3::from_fn(|_, _| self.between(-1.0, 1.0));
            let n = v.norm();
            if n > 0.1 && n <= 1.0 {
                return v / n;
            }
        }
    }
}

/// Kind of a random motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Line,
    Arc,
    Spline,
    JointLine,
}

pub(crate) const KINDS: [Kind; 4] = [Kind::Line, Kind::Arc, Kind::Spline, Kind::JointLine];

pub(crate) fn joints(model: &ArmModel, random: &mut Random) -> Joints {
    let mut q = [0.0; 7];
    for (axis, limits) in model.limits.iter().enumerate() {
        let (low, high) = (
            limits.position.lower.max(-2.6),
            limits.position.upper.min(2.6),
        );
        let margin = 0.1 * (high - low);
        q[axis] = random.between(low + margin, high - margin);
    }
    q
}

/// A random path from a position of the joints; `None` if this try makes none.
pub(crate) fn path(
    model: &ArmModel,
    arm: &Arm,
    kind: Kind,
    from: &Joints,
    random: &mut Random,
) -> Option<Path> {
    let here = arm.forward(from);
    match kind {
        Kind::Line => {
            let way = random.direction() * random.between(0.1, 0.5);
            let turn = random.direction() * random.between(0.0, 0.7);
            let to = Pose::from_parts(
                Translation3::from(here.translation.vector + way),
                UnitQuaternion::from_scaled_axis(turn) * here.rotation,
            );
            Some(Path::line(&here, &to))
        }
        Kind::Arc => {
            let radius = random.between(0.05, 0.25);
            let spoke = random.direction();
            let normal = spoke.cross(&random.direction());
            if normal.norm() < 0.1 {
                return None;
            }
            let centre = here.translation.vector - spoke * radius;
            let angle = random.between(0.5, 3.0);
            let orientation = match random.below(2) {
                0 => ArcOrientation::Fixed,
                _ => ArcOrientation::Turning,
            };
            let arc = Arc::by_angle(&here, &centre, &normal, angle, orientation).ok()?;
            Some(Path::Tool(ToolPath::new(Piece::Arc(arc))))
        }
        Kind::Spline => {
            let mut points = [here; MAX_POINTS];
            let count = 2 + random.below(MAX_POINTS - 1);
            for k in 1..count {
                let way = random.direction() * random.between(0.02, 0.1);
                let turn = random.direction() * random.between(0.0, 0.2);
                points[k] = Pose::from_parts(
                    Translation3::from(points[k - 1].translation.vector + way),
                    UnitQuaternion::from_scaled_axis(turn) * points[k - 1].rotation,
                );
            }
            ToolPath::spline(&points[..count]).ok().map(Path::Tool)
        }
        Kind::JointLine => {
            let to = joints(model, random);
            let to = core::array::from_fn(|axis| from[axis] + 0.6 * (to[axis] - from[axis]));
            let path = Path::joint_line(from, &to, model.axes());
            (path.length() > 0.05).then_some(path)
        }
    }
}

/// Random bounds for the tool, or the defaults of the library.
pub(crate) fn requested(kind: Kind, random: &mut Random, default: bool) -> Bounds {
    let (speed, acceleration, jerk) = match (kind, default) {
        (Kind::JointLine, _) => (10.0, 100.0, 1000.0),
        (_, true) => (0.25, 0.5, 5.0),
        (_, false) => (
            random.between(0.05, 1.0),
            random.between(0.5, 4.0),
            random.between(5.0, 60.0),
        ),
    };
    Bounds {
        speed,
        acceleration,
        jerk,
    }
}
