//! UR5e of Universal Robots.

use crate::chain::LinkTwist;
use crate::model::{ArmModel, InverseKinematics};
use crate::ur::Geometry;
use crate::{AxisLimits, Chain, Convention, Link};

/// Model of the six-axis arm Universal Robots UR5e.
pub static UR5E: ArmModel = ArmModel {
    id: "ur5e",
    display_name: "Universal Robots UR5e",
    source: "UniversalRobots/Universal_Robots_ROS2_Description; acceleration and jerk: not published, multiples of the iiwa",
    chain: Chain {
        convention: Convention::Standard,
        links: &LINKS,
        fixed_links: &[],
    },
    limits: &LIMITS,
    inverse: InverseKinematics::Ur(LENGTHS),
};

const LENGTHS: Geometry = Geometry {
    d1: 0.1625,
    a2: -0.425,
    a3: -0.3922,
    d4: 0.1333,
    d5: 0.0997,
    d6: 0.0996,
};

static LINKS: [Link; 6] = [
    Link::new(0.0, LinkTwist::PLUS_90, LENGTHS.d1),
    Link::new(LENGTHS.a2, LinkTwist::NONE, 0.0),
    Link::new(LENGTHS.a3, LinkTwist::NONE, 0.0),
    Link::new(0.0, LinkTwist::PLUS_90, LENGTHS.d4),
    Link::new(0.0, LinkTwist::MINUS_90, LENGTHS.d5),
    Link::new(0.0, LinkTwist::NONE, LENGTHS.d6),
];

static LIMITS: [AxisLimits; 6] = [
    axis(360.0),
    axis(360.0),
    axis(180.0),
    axis(360.0),
    axis(360.0),
    axis(360.0),
];

const fn axis(bound: f64) -> AxisLimits {
    AxisLimits::from_degrees(-bound, bound, 180.0).with_scaled_acceleration_and_jerk(3.0, 20.0)
}
