//! One arm of a scene: names of its frames, and the poses of its links.
//!
//! The frame of a link has the orientation of the base and its origin on the axis of its joint when all joints are at 0, so that
//! the robot description has no rotations.

use nalgebra::{Isometry3, Vector3};
use rpi_kin::chain::{JointAxis, JointType};
use rpi_kin::{AxisLimits, Pose};
use rpi_sim::cell::ArmSpec;

use super::{FramePose, JointValue};

/// Name of the frame in which the bases of all arms are given.
pub(super) const WORLD: &str = "world";

/// An arm as viewers of robots show it: names of its frames, and the poses of its links.
pub(super) struct ArmView {
    /// Name of the arm in the cell description, with which the names of its frames begin.
    pub(super) name: String,
    pub(super) spec: ArmSpec,
    /// Axes of the joints in the base frame, when all joints are at 0.
    pub(super) axes: Vec<JointAxis>,
    /// Inverse of each link's pose in the base frame when all joints are at 0.
    at_zero: Vec<Isometry3<f64>>,
    /// For each joint, the index of the sampled channel with its position.
    channels: Vec<usize>,
    /// Latest position of each joint, in rad or m.
    positions: Vec<f64>,
    /// Positions of the joints in the previous tick, in rad or m; empty in the first tick.
    before: Vec<f64>,
}

impl ArmView {
    pub(super) fn new(name: &str, spec: &ArmSpec, channels: Vec<usize>) -> ArmView {
        let zero = vec![0.0; spec.joints.len()];
        let chain = &spec.model.chain;
        let frames = chain.link_frames(&zero);
        ArmView {
            name: name.to_owned(),
            axes: chain.axes_in_base(&zero).collect(),
            at_zero: frames.map(|f| rpi_kin::to_pose(&f).inverse()).collect(),
            channels,
            positions: spec.joints.clone(),
            before: Vec::new(),
            spec: spec.clone(),
        }
    }

    /// Stores the sample of the channel with this index if it is the position of a joint of this arm, in rad or m. An
    /// absent sample changes nothing.
    pub(super) fn take_sample(&mut self, channel: usize, value: Option<f64>) {
        let joint = self.channels.iter().position(|own| *own == channel);
        if let (Some(joint), Some(value)) = (joint, value)
            && let Some(position) = self.positions.get_mut(joint)
        {
            *position = value;
        }
    }

    /// Returns positions and velocities of the joints. Velocities are differences to the previous call; `tick` is the
    /// time since then in seconds.
    pub(super) fn joints(&mut self, tick: f64) -> Vec<JointValue> {
        let before = std::mem::replace(&mut self.before, self.positions.clone());
        let joint = |(k, position): (usize, &f64)| JointValue {
            name: self.joint_name(k),
            position: *position,
            velocity: before.get(k).map_or(0.0, |old| (position - old) / tick),
        };
        self.positions.iter().enumerate().map(joint).collect()
    }

    /// Returns the poses of base, links, flange and tool at the latest joint positions, each in its parent frame.
    pub(super) fn frames(&self) -> Vec<FramePose> {
        let chain = &self.spec.model.chain;
        let links = chain.link_frames(&self.positions);
        let moved = links
            .zip(&self.at_zero)
            .map(|(frame, at_zero)| rpi_kin::to_pose(&frame) * at_zero);
        let mut frames = vec![self.frame(WORLD.to_owned(), self.base(), self.spec.base)];
        let (mut parent, mut parent_pose) = (self.base(), Pose::identity());
        for (k, moved) in moved.enumerate() {
            let pose = moved * Pose::translation(self.point(k).x, self.point(k).y, self.point(k).z);
            frames.push(self.frame(parent, self.link_name(k), parent_pose.inverse() * pose));
            (parent, parent_pose) = (self.link_name(k), pose);
        }
        let flange = self.spec.model.forward(&self.positions);
        frames.push(self.frame(parent, self.flange(), parent_pose.inverse() * flange));
        frames.push(self.frame(self.flange(), self.tool(), self.spec.tool));
        frames
    }

    fn frame(&self, parent: String, child: String, pose: Pose) -> FramePose {
        FramePose {
            parent,
            child,
            pose,
        }
    }

    /// Returns a point on the axis of the joint with this index when all joints are at 0, in the base frame, in m.
    pub(super) fn point(&self, joint: usize) -> Vector3<f64> {
        self.axes
            .get(joint)
            .map_or(Vector3::zeros(), |axis| axis.point)
    }

    /// Returns the limits of the joint with this index and its kind (revolute or prismatic); `None` if there is no such
    /// joint.
    pub(super) fn limits(&self, joint: usize) -> Option<(&AxisLimits, JointType)> {
        self.spec
            .limits
            .get(joint)
            .zip(self.axes.get(joint).map(|a| a.joint))
    }

    pub(super) fn joint_name(&self, joint: usize) -> String {
        format!("{}_joint_{}", self.name, joint + 1)
    }

    pub(super) fn base(&self) -> String {
        format!("{}_base", self.name)
    }

    pub(super) fn link_name(&self, joint: usize) -> String {
        format!("{}_link_{}", self.name, joint + 1)
    }

    pub(super) fn flange(&self) -> String {
        format!("{}_flange", self.name)
    }

    pub(super) fn tool(&self) -> String {
        format!("{}_tool", self.name)
    }
}
