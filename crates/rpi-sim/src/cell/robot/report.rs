//! What a description gives, in words: axes, reach, inverse, assumptions.

use super::RobotDescription;
use crate::noise::Noise;
use core::fmt;
use rpi_kin::chain::JointType;
use rpi_kin::rotation::angle_between;
use rpi_kin::{ArmModel, AxisLimits, InverseKinematics, MAX_AXES};

/// Summary of a robot description, with a test of its inverse kinematics on random poses.
#[derive(Clone, Debug)]
pub struct RobotReport<'a> {
    /// Description of the robot that was checked.
    pub description: &'a RobotDescription,
    /// Greatest distance of the flange from the base among the random poses, m: a lower bound of the reach.
    pub reach: f64,
    /// Result of the test of the inverse kinematics.
    pub inverse: InverseReport,
}

/// Result of a test of the inverse kinematics on random poses with all axes within their ranges.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InverseReport {
    /// Number of poses that were tested.
    pub poses: usize,
    /// Number of poses for which joint positions within the ranges were found.
    pub found: usize,
    /// Greatest distance between a pose and the pose of the joint positions found for it, m.
    pub distance: f64,
    /// Greatest angle between a pose and the pose of the joint positions found for it, rad.
    pub angle: f64,
}

impl<'a> RobotReport<'a> {
    /// Tests a robot description on `poses` random poses. The same number gives the same poses.
    #[must_use]
    pub fn new(description: &'a RobotDescription, poses: usize) -> Self {
        let model = description.model;
        let mut random = Noise::new(1, 0);
        let (mut reach, mut inverse) = (0.0_f64, InverseReport::default());
        for _ in 0..poses {
            let [joints, hint] = [(); 2].map(|()| random_joints(&mut random, model));
            let pose = model.forward(&joints[..model.axes()]);
            reach = reach.max(pose.translation.vector.norm());
            inverse.examine(model, &pose, &hint);
        }
        Self {
            description,
            reach,
            inverse,
        }
    }
}

impl InverseReport {
    fn examine(&mut self, model: &ArmModel, pose: &rpi_kin::Pose, hint: &[f64]) {
        self.poses += 1;
        let hint = &hint[..model.axes()];
        let Ok(found) = model.inverse_anywhere(pose, hint, model.limits) else {
            return;
        };
        let reached = model.forward(&found[..model.axes()]);
        self.found += 1;
        let way = reached.translation.vector - pose.translation.vector;
        self.distance = self.distance.max(way.norm());
        self.angle = self
            .angle
            .max(angle_between(&reached.rotation, &pose.rotation));
    }
}

/// Returns random joint positions (rad or m) within the ranges of a model; 0 for axes that it does not have.
fn random_joints(random: &mut Noise, model: &ArmModel) -> [f64; MAX_AXES] {
    let mut joints = [0.0; MAX_AXES];
    for (joint, limits) in joints.iter_mut().zip(model.limits) {
        let range = limits.position;
        *joint = range.lower + (range.upper - range.lower) * random.uniform();
    }
    joints
}

impl fmt::Display for RobotReport<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let model = self.description.model;
        writeln!(f, "{} ({})", model.display_name, model.id)?;
        writeln!(f, "source: {}", model.source)?;
        writeln!(f, "axes: {}", model.axes())?;
        let joints = model.chain.links.iter().map(|link| link.joint);
        for ((name, limits), joint) in self.description.axes.iter().zip(model.limits).zip(joints) {
            writeln!(f, "  {}", axis_line(name, limits, joint))?;
        }
        writeln!(f, "reach: {:.3} m", self.reach)?;
        writeln!(f, "inverse: {}", inverse_line(model, &self.inverse))?;
        match self.description.assumed.as_slice() {
            [] => writeln!(f, "assumed: nothing"),
            assumed => writeln!(f, "assumed: {}", assumed.join(", ")),
        }
    }
}

/// Returns one line about an axis: its name and limits, in degrees or mm.
fn axis_line(name: &str, limits: &AxisLimits, joint: JointType) -> String {
    let (factor, unit) = match joint {
        JointType::Revolute => (core::f64::consts::PI.recip() * 180.0, "deg"),
        JointType::Prismatic => (1000.0, "mm"),
    };
    let short = |value: f64| (value * factor * 10.0).round() / 10.0;
    let range = limits.position;
    format!(
        "{name}: {} to {} {unit}, {} {unit}/s, {} {unit}/s^2, {} {unit}/s^3",
        short(range.lower),
        short(range.upper),
        short(limits.velocity),
        short(limits.acceleration),
        short(limits.jerk)
    )
}

fn inverse_line(model: &ArmModel, tested: &InverseReport) -> String {
    let method = match model.inverse {
        InverseKinematics::Srs(_) => "closed form (spherical shoulder and wrist)",
        InverseKinematics::Opw(_) => "closed form (ortho-parallel basis, spherical wrist)",
        InverseKinematics::Ur(_) => "closed form (axes 2 to 4 parallel)",
        InverseKinematics::DampedLeastSquares { .. } => "damped least squares",
        InverseKinematics::NoClosedForm => return "none: motions to poses are refused".to_owned(),
    };
    format!(
        "{method}; {} of {} random poses found, worst {:.1e} m and {:.1e} rad",
        tested.found, tested.poses, tested.distance, tested.angle
    )
}
