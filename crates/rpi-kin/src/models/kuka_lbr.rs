//! Seven-axis light-weight arms of KUKA: LWR 4+, LBR iiwa 7 and LBR iiwa 14.
//!
//! All three are S-R-S arms without offsets. They differ in their lengths and in the sense of axes 2, 4 and 6: a
//! positive angle of axis 2 moves an iiwa towards +x, and an LWR towards -x.

use crate::chain::LinkTwist;
use crate::model::{ArmModel, InverseKinematics};
use crate::srs::Geometry;
use crate::{AxisLimits, Chain, Convention, Link};

/// Model of the seven-axis arm KUKA LBR iiwa 7 R800.
pub static IIWA_7: ArmModel = ArmModel {
    id: "kuka-iiwa-7",
    display_name: "KUKA LBR iiwa 7 R800",
    source: "lengths: IFL-CAMP/iiwa_stack; ranges and velocities: lbr-stack/lbr_fri_ros2_stack; acceleration and jerk: roboticsapi/kuka-lwr-api",
    chain: chain(&IIWA_7_LINKS),
    limits: &IIWA_7_LIMITS,
    inverse: InverseKinematics::Srs(IIWA_7_LENGTHS.geometry()),
};

/// Model of the seven-axis arm KUKA LBR iiwa 14 R820.
pub static IIWA_14: ArmModel = ArmModel {
    id: "kuka-iiwa-14",
    display_name: "KUKA LBR iiwa 14 R820",
    source: "lengths: IFL-CAMP/iiwa_stack; ranges and velocities: lbr-stack/lbr_fri_ros2_stack; acceleration and jerk: roboticsapi/kuka-lwr-api",
    chain: chain(&IIWA_14_LINKS),
    limits: &IIWA_14_LIMITS,
    inverse: InverseKinematics::Srs(IIWA_14_LENGTHS.geometry()),
};

/// Model of the seven-axis arm KUKA LWR 4+.
pub static LWR_4_PLUS: ArmModel = ArmModel {
    id: "kuka-lwr4+",
    display_name: "KUKA LWR 4+",
    source: "roboticsapi/kuka-lwr-api; lengths also in orocos_kdl",
    chain: chain(&LWR_4_PLUS_LINKS),
    limits: &LWR_4_PLUS_LIMITS,
    inverse: InverseKinematics::Srs(LWR_4_PLUS_LENGTHS.geometry()),
};

const IIWA_7_LENGTHS: Lbr = Lbr {
    base: 0.340,
    upper: 0.400,
    fore: 0.400,
    hand: 0.126,
    axis2_sense: 1.0,
};
const IIWA_14_LENGTHS: Lbr = Lbr {
    base: 0.360,
    upper: 0.420,
    fore: 0.400,
    hand: 0.126,
    axis2_sense: 1.0,
};
const LWR_4_PLUS_LENGTHS: Lbr = Lbr {
    base: 0.3105,
    upper: 0.400,
    fore: 0.390,
    hand: 0.078,
    axis2_sense: -1.0,
};

static IIWA_7_LINKS: [Link; 7] = IIWA_7_LENGTHS.links();
static IIWA_14_LINKS: [Link; 7] = IIWA_14_LENGTHS.links();
static LWR_4_PLUS_LINKS: [Link; 7] = LWR_4_PLUS_LENGTHS.links();

/// Assumed acceleration limit of an axis as a multiple of its velocity limit, in 1/s: full speed is reached after 1/3
/// s.
const ACCELERATION_FACTOR: f64 = 3.0;
/// Assumed jerk limit of an axis as a multiple of its velocity limit, in 1/s²: full acceleration is reached after 0.15
/// s.
const JERK_FACTOR: f64 = 20.0;

static IIWA_7_LIMITS: [AxisLimits; 7] =
    iiwa_limits([98.0, 98.0, 100.0, 130.0, 140.0, 180.0, 180.0]);
static IIWA_14_LIMITS: [AxisLimits; 7] =
    iiwa_limits([85.0, 85.0, 100.0, 75.0, 130.0, 135.0, 135.0]);
static LWR_4_PLUS_LIMITS: [AxisLimits; 7] = [
    lwr_limits(170.0, 112.5),
    lwr_limits(120.0, 112.5),
    lwr_limits(170.0, 112.5),
    lwr_limits(120.0, 112.5),
    lwr_limits(170.0, 180.0),
    lwr_limits(120.0, 112.5),
    lwr_limits(170.0, 112.5),
];

const fn iiwa_limits(velocity: [f64; 7]) -> [AxisLimits; 7] {
    [
        AxisLimits::from_degrees(-170.0, 170.0, velocity[0])
            .with_scaled_acceleration_and_jerk(ACCELERATION_FACTOR, JERK_FACTOR),
        AxisLimits::from_degrees(-120.0, 120.0, velocity[1])
            .with_scaled_acceleration_and_jerk(ACCELERATION_FACTOR, JERK_FACTOR),
        AxisLimits::from_degrees(-170.0, 170.0, velocity[2])
            .with_scaled_acceleration_and_jerk(ACCELERATION_FACTOR, JERK_FACTOR),
        AxisLimits::from_degrees(-120.0, 120.0, velocity[3])
            .with_scaled_acceleration_and_jerk(ACCELERATION_FACTOR, JERK_FACTOR),
        AxisLimits::from_degrees(-170.0, 170.0, velocity[4])
            .with_scaled_acceleration_and_jerk(ACCELERATION_FACTOR, JERK_FACTOR),
        AxisLimits::from_degrees(-120.0, 120.0, velocity[5])
            .with_scaled_acceleration_and_jerk(ACCELERATION_FACTOR, JERK_FACTOR),
        AxisLimits::from_degrees(-175.0, 175.0, velocity[6])
            .with_scaled_acceleration_and_jerk(ACCELERATION_FACTOR, JERK_FACTOR),
    ]
}

/// Returns the limits of an axis of the LWR: range ±`bound` degrees, `velocity` in degrees per second. Its acceleration
/// is published as 4 rad/s² for every axis. Its jerk is not published: it is derived from the velocity limit with the
/// factor of the iiwa.
const fn lwr_limits(bound: f64, velocity: f64) -> AxisLimits {
    let limits = AxisLimits::from_degrees(-bound, bound, velocity);
    limits.with_acceleration_and_jerk(4.0, JERK_FACTOR * limits.velocity)
}

const fn chain(links: &'static [Link]) -> Chain {
    Chain {
        convention: Convention::Standard,
        links,
        fixed_links: &[],
    }
}

/// Lengths, and sense of axis 2, by which the LBR arms differ.
#[derive(Clone, Copy)]
struct Lbr {
    /// Distance from the base to the shoulder, in m.
    base: f64,
    /// Distance from the elbow to the wrist, in m.
    upper: f64,
    /// Distance from the wrist to the flange, in m.
    fore: f64,
    hand: f64,
    /// Sense of axis 2: +1 if a positive angle moves the arm towards +x, else -1.
    axis2_sense: f64,
}

impl Lbr {
    /// Returns the rows of the standard Denavit-Hartenberg table: lengths in every other row, quarter turns between the
    /// axes.
    const fn links(self) -> [Link; 7] {
        let (over, back) = if self.axis2_sense > 0.0 {
            (LinkTwist::MINUS_90, LinkTwist::PLUS_90)
        } else {
            (LinkTwist::PLUS_90, LinkTwist::MINUS_90)
        };
        [
            Link::new(0.0, over, self.base),
            Link::new(0.0, back, 0.0),
            Link::new(0.0, back, self.upper),
            Link::new(0.0, over, 0.0),
            Link::new(0.0, over, self.fore),
            Link::new(0.0, back, 0.0),
            Link::new(0.0, LinkTwist::NONE, self.hand),
        ]
    }

    const fn geometry(self) -> Geometry {
        let sense = [
            1.0,
            self.axis2_sense,
            1.0,
            -self.axis2_sense,
            1.0,
            self.axis2_sense,
            1.0,
        ];
        Geometry {
            base: self.base,
            upper: self.upper,
            fore: self.fore,
            hand: self.hand,
            sense,
        }
    }
}
