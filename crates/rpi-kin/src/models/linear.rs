//! Linear unit: a carriage on a rail.

use crate::chain::LinkTwist;
use crate::model::{ArmModel, InverseKinematics};
use crate::{AxisLimits, Chain, Convention, Link};

/// Model of a linear unit: a carriage that moves along z of its base frame. Its stroke and limits are placeholders; the
/// description of a cell replaces them.
pub static LINEAR_UNIT: ArmModel = ArmModel {
    id: "linear-unit",
    display_name: "linear unit",
    source: "none; the cell description sets its own limits",
    chain: Chain {
        convention: Convention::Standard,
        links: &LINKS,
        fixed_links: &[],
    },
    limits: &LIMITS,
    inverse: InverseKinematics::NoClosedForm,
};

static LINKS: [Link; 1] = [Link::new(0.0, LinkTwist::NONE, 0.0).prismatic()];

/// Placeholder limits of the linear unit, in m, m/s, m/s² and m/s³.
static LIMITS: [AxisLimits; 1] =
    [AxisLimits::from_radians(0.0, 1.0, 1.0).with_acceleration_and_jerk(2.0, 20.0)];
