//! Entry: which part of the state at a takeover goes on along the path, and which decays as residual.

use crate::node::{MostAllowed, Node, USED_JERK_SHARE, USED_SHARE};
use crate::plan::{Demand, allowed};
use crate::residual::Residual;
use crate::time_law::{HeldBrake, PathState};
use crate::verify::Verifier;
use crate::{Arm, JointState};
use rpi_kin::state_to_rest::{AxisState, Bounds};
use rpi_kin::{MAX_AXES, Range};

/// Parameters with which a takeover on to a path is tried: the share of the limits of the axes for the residual (the
/// decaying difference between arm and path), and the shares of the arm's velocity and acceleration along the path that
/// the motion continues.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Attempt {
    pub limits: f64,
    pub velocity: f64,
    pub acceleration: f64,
}

/// Parameters of takeovers in the order in which they are tried. Half the limits was the best share in the median of
/// random takeovers, 0.7 for arms that move fast.
pub(crate) const ATTEMPTS: [Attempt; 6] = [
    attempt(0.5, 1.0, 1.0),
    attempt(0.7, 1.0, 1.0),
    attempt(0.5, 1.0, 0.0),
    attempt(0.5, 0.5, 0.0),
    attempt(0.5, 0.0, 0.0),
    attempt(0.95, 0.0, 0.0),
];

/// Shares of the maximum acceleration and jerk along the path with which a takeover brakes if no plan follows, in the
/// order in which they are tried.
const BRAKE_SHARES: [f64; 3] = [0.7, 0.45, 0.25];

/// Minimum velocity along the path with which a takeover continues, m/s (rad/s on a joint line). A slower one is not
/// better than a start at rest.
const SLOWEST: f64 = 1e-4;

const fn attempt(limits: f64, velocity: f64, acceleration: f64) -> Attempt {
    Attempt {
        limits,
        velocity,
        acceleration,
    }
}

/// Takeover on to a path, verified against the limits.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry {
    pub residual: Residual,
    pub brake: HeldBrake,
    /// Index into [`SHARES`](crate::plan::SHARES) near which the next plan begins.
    pub share: usize,
}

/// Returns the residual of the takeover that is always possible: the position along the path rests at the start, and
/// each axis comes to rest there on its own, with all its limits. It needs no verification, because the arm could stop
/// within its range before the takeover. `None` if a number is not finite.
pub(crate) fn standing(arm: &Arm, node: &Node, state: &JointState, time: f64) -> Option<Residual> {
    residual(arm, node, state, time, PathState::default(), 1.0)
}

/// Returns the residual of the first takeover of a motion: as [`standing`], but with half of the limits if these bounds
/// and the `ranges` are then respected. A better takeover follows after a few cycles, so full jerk for this short time
/// would only shake the arm. `None` if a number is not finite.
pub(crate) fn first(
    arm: &Arm,
    node: &Node,
    state: &JointState,
    ranges: &[Range; MAX_AXES],
    time: f64,
) -> Option<Residual> {
    let gentle = residual(arm, node, state, time, PathState::default(), 0.5);
    gentle
        .filter(|residual| {
            peaks_are_within(arm, residual) && residual.can_stop(arm, time, &node.joints, ranges)
        })
        .or_else(|| standing(arm, node, state, time))
}

/// Tries one takeover at the time `time` of the motion (s) from the state of the arm; `None` if it fails the
/// verification.
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
    let mut samples = demand.samples;
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

/// Returns the velocity and acceleration along the path that fit best to those of the axes: least squares, weighted by
/// the velocity limits, and limited to what the path allows.
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

/// Returns the residual (decaying difference between arm and path) of a takeover with the state `start` along the path.
/// It decays with the share `share` of the limits of the axes; 1 stands for the limits themselves. `None` if a number
/// is not finite.
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

/// Returns true if the residual alone keeps the limits of velocity and acceleration. A start beyond its own bounds is
/// brought back with bounded jerk and may exceed them on the way.
fn peaks_are_within(arm: &Arm, residual: &Residual) -> bool {
    arm.limits().iter().enumerate().all(|(axis, limits)| {
        let (velocity, acceleration) = residual.peaks(axis);
        let most = USED_SHARE + 0.004;
        velocity <= most * limits.velocity && acceleration <= most * limits.acceleration
    })
}
