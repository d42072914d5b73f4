//! Franka Panda (FER).
//!
//! Its elbow and wrist have offsets, so it has no arm angle in the sense of [`crate::srs`], and no closed form is
//! implemented. Set-points must be joint positions, not poses.

use crate::chain::Twist;
use crate::model::{ArmModel, Inverse};
use crate::{AxisLimits, Chain, Convention, Link};

/// Franka Panda, also called FER.
pub static PANDA: ArmModel = ArmModel {
    id: "franka-panda",
    title: "Franka Panda (FER)",
    source: "lengths: frankarobotics/franka_description; limits: libfranka 0.9.2",
    chain: Chain {
        convention: Convention::Modified,
        links: &LINKS,
        tail: &FLANGE,
    },
    limits: &LIMITS,
    inverse: Inverse::Unknown,
};

static LINKS: [Link; 7] = [
    Link::new(0.0, Twist::NONE, 0.333),
    Link::new(0.0, Twist::MINUS_90, 0.0),
    Link::new(0.0, Twist::PLUS_90, 0.316),
    Link::new(0.0825, Twist::PLUS_90, 0.0),
    Link::new(-0.0825, Twist::MINUS_90, 0.384),
    Link::new(0.0, Twist::PLUS_90, 0.0),
    Link::new(0.088, Twist::PLUS_90, 0.0),
];

static FLANGE: [Link; 1] = [Link::new(0.0, Twist::NONE, 0.107)];

static LIMITS: [AxisLimits; 7] = [
    AxisLimits::radians(-2.8973, 2.8973, 2.175).changing(15.0, 7500.0),
    AxisLimits::radians(-1.7628, 1.7628, 2.175).changing(7.5, 3750.0),
    AxisLimits::radians(-2.8973, 2.8973, 2.175).changing(10.0, 5000.0),
    AxisLimits::radians(-3.0718, -0.0698, 2.175).changing(12.5, 6250.0),
    AxisLimits::radians(-2.8973, 2.8973, 2.61).changing(15.0, 7500.0),
    AxisLimits::radians(-0.0175, 3.7525, 2.61).changing(20.0, 10_000.0),
    AxisLimits::radians(-2.8973, 2.8973, 2.61).changing(20.0, 10_000.0),
];
