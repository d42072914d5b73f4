//! A linear unit: a carriage on a rail.

use crate::chain::Twist;
use crate::model::{ArmModel, Inverse};
use crate::{AxisLimits, Chain, Convention, Link};

/// A carriage that slides along the z of its base. Stroke and limits are those of no product: a cell gives its own.
pub static LINEAR_UNIT: ArmModel = ArmModel {
    id: "linear-unit",
    title: "linear unit",
    source: "none; the cell gives its own limits",
    chain: Chain {
        convention: Convention::Standard,
        links: &LINKS,
        tail: &[],
    },
    limits: &LIMITS,
    inverse: Inverse::Unknown,
};

static LINKS: [Link; 1] = [Link::new(0.0, Twist::NONE, 0.0).sliding()];

/// In m, m/s, m/s^2, m/s^3.
static LIMITS: [AxisLimits; 1] = [AxisLimits::radians(0.0, 1.0, 1.0).changing(2.0, 20.0)];
