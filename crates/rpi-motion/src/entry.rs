//! Entry: which part of the state at a takeover goes on along the path, and which decays as residual.

use crate::node::{MostAllowed, Node, USED_JERK_SHARE, USED_SHARE};
use crate::plan::{Demand, allowed};
use crate::residual::Residual;
use crate::time_law::{HeldBrake, PathState};
use crate::verify::{SAMPLES_PER_CYCLE, Verifier};
use crate::{Arm, JointState};
use rpi_kin::state_to_rest::{AxisState, Bounds};
use rpi_kin::{MAX_AXES, Range};

/// Parameters with which a takeover on to a path is planned: shares of the limits for the residual, and of the arm's
/// velocity and acceleration along the path.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Attempt {
    pub limits: f64,
    pub velocity: f64,
    pub acceleration: f64,
}

/// Parameters of takeovers in the order in which they are tried. A share of half the limits was best in the median of
/// random takeovers, 0.7 where the arm comes fast.
pub(crate) const ATTEMPTS: [Attempt; 6] = [
    attempt(0.5, 1.0, 1.0),
    attempt(0.7, 1.0, 1.0),
    attempt(0.5, 1.0, 0.0),
    attempt(0.5, 0.5, 0.0),
    attempt(0.5, 0.0, 0.0),
    attempt(0.95, 0.0, 0.0),
];

/// Shares of acceleration and jerk that are tried for the first braking of a takeover.
const BRAKE_SHARES: [f64; 3] = [0.7, 0.45, 0.25];

/// Lowest useful velocity of the path parameter, 1/s: a slower takeover is not better than standing still.
const SLOWEST: f64 = 1e-4;

const fn attempt(limits: f64, velocity: f64, acceleration: f64) -> Attempt {
    Attempt {
        limits,
        velocity,
        acceleration,
    }
}

/// Takeover on to a path that has been verified against the limits.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry {
    pub residual: Residual,
    pub brake: HeldBrake,
    /// Index of the share of the limits with which the next plan begins.
    pub share: usize,
}

/// The entry that cannot fail: the path stands, and each axis comes to rest at its start on its own, with all its
/// limits. It needs no verification, because the arm could stop within its range before the takeover.
pub(crate) fn standing(arm: &Arm, node: &Node, state: &JointState, time: f64) -> Option<Residual> {
    residual(arm, node, state, time, PathState::default(), 1.0)
}

/// The first entry of a motion: as [`standing`], with half of the limits where this keeps them and the `ranges`. A better
/// entry follows after a few cycles, so full jerk for so short a time would only shake the arm, and what moves with it.
pub(crate) fn first(
    arm: &Arm,
    node: &Node,
    state: &JointState,
    ranges: &[Range; MAX_AXES],
    time: f64,
) -> Option<Residual> {
    let gentle = residual(arm, node, state, time, PathState::default(), 0.5);
    let in_ranges = |residual: &Residual| {
        ranges
            .iter()
            .enumerate()
            .take(arm.axes())
            .all(|(axis, range)| {
                let (low, high) = residual.span(axis);
                let here = node.joints[axis];
                here + low >= range.lower && here + high <= range.upper
            })
    };
    gentle
        .filter(|residual| peaks_are_within(arm, residual) && in_ranges(residual))
        .or_else(|| standing(arm, node, state, time))
}

/// Tries one entry at `time` (s) from the state of the arm.
pub(crate) fn attempted(
    verifier: &Verifier<'_>,
    state: &JointState,
    time: f64,
    attempt: Attempt,
    demand: Demand,
) -> Option<Entry> {
    let (arm, table) = (verifier.arm, verifier.table);
    let node = table.first_node();
    let along = along_path(
        arm,
        node,
        state,
        allowed(table, 0.0, 0.0, demand),
        demand,
        table.requested(),
    );
    let start = PathState {
        s: 0.0,
        velocity: along.velocity * attempt.velocity,
        acceleration: along.acceleration * attempt.acceleration,
    };
    if attempt.velocity > 0.0 && along.velocity < SLOWEST {
        return None;
    }
    let residual = residual(arm, node, state, time, start, attempt.limits)?;
    if !peaks_are_within(arm, &residual) {
        return None;
    }
    let verifier = Verifier {
        residual: &residual,
        ..*verifier
    };
    let reach = (start.velocity * start.velocity).min(0.1) + 0.005;
    let most = allowed(table, 0.0, reach, demand);
    let mut samples = SAMPLES_PER_CYCLE;
    for (number, share) in BRAKE_SHARES.into_iter().enumerate() {
        let brake = HeldBrake::stopping(start, time, most.acceleration * share, most.jerk * share)?;
        if verifier.accepts(&brake, &mut samples) {
            return Some(Entry {
                residual,
                brake,
                share: number + 1,
            });
        }
    }
    None
}

/// Velocity and acceleration of the path parameter that fit best to those of the joints: least squares, weighted by the
/// velocity limits, and cut to what the path allows.
pub(crate) fn along_path(
    arm: &Arm,
    node: &Node,
    state: &JointState,
    most: MostAllowed,
    demand: Demand,
    requested: Bounds,
) -> PathState {
    let weighted = |value: &dyn Fn(usize) -> f64| {
        let axes = arm.limits().iter().enumerate();
        axes.map(|(axis, limits)| {
            value(axis) * node.first[axis] / (limits.velocity * limits.velocity)
        })
        .sum::<f64>()
    };
    let length = weighted(&|axis| node.first[axis]);
    let velocity = weighted(&|axis| state.velocity[axis]) / length;
    let velocity = velocity.clamp(0.0, most.velocity.max(0.0));
    let remaining =
        |axis: usize| state.acceleration[axis] - node.second[axis] * velocity * velocity;
    let acceleration = weighted(&remaining) / length;
    let most = 0.9 * demand.tool_share * requested.acceleration;
    PathState {
        s: 0.0,
        velocity,
        acceleration: acceleration.clamp(-most, most),
    }
}

/// The residual of a start on the path, decaying with a share of the limits; a share of 1 means the limits themselves.
fn residual(
    arm: &Arm,
    node: &Node,
    state: &JointState,
    time: f64,
    start: PathState,
    share: f64,
) -> Option<Residual> {
    let PathState {
        velocity: v,
        acceleration: a,
        ..
    } = start;
    let difference = |axis: usize| AxisState {
        position: state.position[axis] - node.joints[axis],
        velocity: state.velocity[axis] - node.first[axis] * v,
        acceleration: state.acceleration[axis] - node.first[axis] * a - node.second[axis] * v * v,
    };
    let (used, used_jerk) = if share < 1.0 {
        (share * USED_SHARE, share * USED_JERK_SHARE)
    } else {
        (1.0, 1.0)
    };
    let bounds = |axis: usize| {
        let limits = arm.limits()[axis];
        Bounds {
            // Never the whole velocity: the next takeover may find an acceleration that is still to be lost.
            speed: used.min(USED_SHARE) * limits.velocity,
            acceleration: used * limits.acceleration,
            jerk: used_jerk * limits.jerk,
        }
    };
    Residual::new(arm.axes(), time, difference, bounds)
}

/// Whether the residual alone keeps the limits. A start beyond its own bounds is brought back with bounded jerk, and
/// may exceed them on the way.
fn peaks_are_within(arm: &Arm, residual: &Residual) -> bool {
    arm.limits().iter().enumerate().all(|(axis, limits)| {
        let (velocity, acceleration) = residual.peaks(axis);
        let most = USED_SHARE + 0.004;
        velocity <= most * limits.velocity && acceleration <= most * limits.acceleration
    })
}
