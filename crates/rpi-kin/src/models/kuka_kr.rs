//! Six-axis industrial arms of KUKA: KR 6 R900 sixx and KR 16-2.
//!
//! With all joints at zero (as defined by the vendor), the arm is stretched out horizontally to the front. Axes 1, 4
//! and 6 are clockwise.

use crate::model::{ArmModel, InverseKinematics};
use crate::opw::Geometry;
use crate::{AxisLimits, Chain, Convention, Link};
use core::f64::consts::FRAC_PI_2;

/// Model of the six-axis arm KUKA KR 6 R900 sixx (Agilus).
pub static KR_6_R900: ArmModel = ArmModel {
    id: "kuka-kr6-r900",
    display_name: "KUKA KR 6 R900 sixx",
    source: "ros-industrial/kuka_experimental; acceleration: roboticsapi/kuka-kr-api; jerk: not published, multiple of the iiwa",
    chain: chain(&KR_6_R900_LINKS),
    limits: &KR_6_R900_LIMITS,
    inverse: InverseKinematics::Opw(KR_6_R900_LENGTHS),
};

/// Model of the six-axis arm KUKA KR 16-2.
pub static KR_16_2: ArmModel = ArmModel {
    id: "kuka-kr16-2",
    display_name: "KUKA KR 16-2",
    source: "ros-industrial/kuka_experimental; acceleration: roboticsapi/kuka-kr-api; jerk: not published, multiple of the iiwa",
    chain: chain(&KR_16_2_LINKS),
    limits: &KR_16_2_LIMITS,
    inverse: InverseKinematics::Opw(KR_16_2_LENGTHS),
};

const KR_6_R900_LENGTHS: Geometry = geometry(0.025, -0.035, [0.400, 0.455, 0.420, 0.080]);
const KR_16_2_LENGTHS: Geometry = geometry(0.260, 0.035, [0.675, 0.680, 0.670, 0.158]);

static KR_6_R900_LINKS: [Link; 6] = KR_6_R900_LENGTHS.links();
static KR_16_2_LINKS: [Link; 6] = KR_16_2_LENGTHS.links();

/// Assumed acceleration limit of an axis as a multiple of its velocity limit, in 1/s: full speed is reached after 0.5
/// s.
const ACCELERATION_FACTOR: f64 = 2.0;
/// Assumed jerk limit of an axis as a multiple of its velocity limit, in 1/s²: full acceleration is reached after 0.1
/// s.
const JERK_FACTOR: f64 = 20.0;

static KR_6_R900_LIMITS: [AxisLimits; 6] = [
    axis(-170.0, 170.0, 360.0),
    axis(-190.0, 45.0, 300.0),
    axis(-120.0, 156.0, 360.0),
    axis(-185.0, 185.0, 381.0),
    axis(-120.0, 120.0, 388.0),
    axis(-350.0, 350.0, 615.0),
];

static KR_16_2_LIMITS: [AxisLimits; 6] = [
    axis(-185.0, 185.0, 156.0),
    axis(-155.0, 35.0, 156.0),
    axis(-130.0, 154.0, 156.0),
    axis(-350.0, 350.0, 330.0),
    axis(-130.0, 130.0, 330.0),
    axis(-350.0, 350.0, 615.0),
];

const fn axis(lower: f64, upper: f64, velocity: f64) -> AxisLimits {
    AxisLimits::from_degrees(lower, upper, velocity)
        .with_scaled_acceleration_and_jerk(ACCELERATION_FACTOR, JERK_FACTOR)
}

const fn chain(links: &'static [Link]) -> Chain {
    Chain {
        convention: Convention::Standard,
        links,
        fixed_links: &[],
    }
}

/// Returns the geometry of a KR arm from its lengths `a1`, `a2` and `c1` to `c4` in m, named as in [`Geometry`]. The
/// arm is upright when axis 2 is a quarter turn from its zero position, which is horizontal.
const fn geometry(a1: f64, a2: f64, [c1, c2, c3, c4]: [f64; 4]) -> Geometry {
    Geometry {
        a1,
        a2,
        b: 0.0,
        c1,
        c2,
        c3,
        c4,
        sense: [-1.0, 1.0, 1.0, -1.0, 1.0, -1.0],
        offset: [0.0, FRAC_PI_2, 0.0, 0.0, 0.0, 0.0],
    }
}
