//! Franka Panda (FER).
//!
//! Its elbow and wrist have offsets, so it has no arm angle in the sense of [`crate::srs`], and no closed form is
//! implemented. Damped least squares hold its last axis, which is redundant for most poses; He and Liu (Analytical inverse
//! kinematics for Franka Emika Panda, 2021) choose the same one.

use crate::chain::LinkTwist;
use crate::model::{ArmModel, InverseKinematics};
use crate::{AxisLimits, Chain, Convention, Link};

/// Model of the Franka Panda arm, also called FER.
pub static PANDA: ArmModel = ArmModel {
    id: "franka-panda",
    display_name: "Franka Panda (FER)",
    source: "lengths: frankarobotics/franka_description; limits: libfranka 0.9.2",
    chain: Chain {
        convention: Convention::Modified,
        links: &LINKS,
        fixed_links: &FLANGE,
    },
    limits: &LIMITS,
    inverse: InverseKinematics::DampedLeastSquares { held_axis: Some(2) },
};

static LINKS: [Link; 7] = [
    Link::new(0.0, LinkTwist::NONE, 0.333),
    Link::new(0.0, LinkTwist::MINUS_90, 0.0),
    Link::new(0.0, LinkTwist::PLUS_90, 0.316),
    Link::new(0.0825, LinkTwist::PLUS_90, 0.0),
    Link::new(-0.0825, LinkTwist::MINUS_90, 0.384),
    Link::new(0.0, LinkTwist::PLUS_90, 0.0),
    Link::new(0.088, LinkTwist::PLUS_90, 0.0),
];

static FLANGE: [Link; 1] = [Link::new(0.0, LinkTwist::NONE, 0.107)];

static LIMITS: [AxisLimits; 7] = [
    AxisLimits::from_radians(-2.8973, 2.8973, 2.175).with_acceleration_and_jerk(15.0, 7500.0),
    AxisLimits::from_radians(-1.7628, 1.7628, 2.175).with_acceleration_and_jerk(7.5, 3750.0),
    AxisLimits::from_radians(-2.8973, 2.8973, 2.175).with_acceleration_and_jerk(10.0, 5000.0),
    AxisLimits::from_radians(-3.0718, -0.0698, 2.175).with_acceleration_and_jerk(12.5, 6250.0),
    AxisLimits::from_radians(-2.8973, 2.8973, 2.61).with_acceleration_and_jerk(15.0, 7500.0),
    AxisLimits::from_radians(-0.0175, 3.7525, 2.61).with_acceleration_and_jerk(20.0, 10_000.0),
    AxisLimits::from_radians(-2.8973, 2.8973, 2.61).with_acceleration_and_jerk(20.0, 10_000.0),
];
