//! Linear unit: a carriage on a rail.

use crate::chain::Twist;
use crate::model::{ArmModel, Inverse};
use crate::{AxisLimits, Chain, Convention, Link};

/// Carriage that moves along z of its base frame. Stroke and limits are placeholders; the cell description sets its
/// own.
pub static LINEAR_UNIT: ArmModel = ArmModel {
    id: "linear-unit",
    title: "linear unit",
    source: "none; the cell description sets its own limits",
    chain: Chain {
        convention: Convention::Standard,
        links: &LINKS,
        tail: &[],
    },
    limits: &LIMITS,
    inverse: Inverse::Unknown,
};

static LINKS: [Link; 1] = [Link::new(0.0, Twist::NONE, 0.0).sliding()];

/// Limits in m, m/s, m/s² and m/s³.
static LIMITS: [AxisLimits; 1] = [AxisLimits::radians(0.0, 1.0, 1.0).changing(2.0, 20.0)];
