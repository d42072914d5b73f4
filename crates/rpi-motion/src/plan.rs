//! Plans the next piece of the time law: the fastest one whose brake passes the verification.

use crate::node::MostAllowed;
use crate::node_table::NodeTable;
use crate::time_law::{HeldBrake, PathState};
use crate::verify::{SAMPLES_PER_CYCLE, Verifier};
use rpi_kin::state_to_rest::{Bounds, StateToRestProfile};
use rpi_kin::stop_profile::{StopProfile, VelocityState};

/// Shares of the greatest acceleration and jerk with which plans are tried, from fast to slow.
pub(crate) const SHARES: [f64; 5] = [1.0, 0.7, 0.45, 0.25, 0.1];

/// Share of the bounds of a piece that its brake uses where the path is curved: there, the jerk of the tool across the
/// path needs a part of the whole.
const BRAKE_ON_CURVE: f64 = 0.6;

/// Share of the lowest speed ahead that is tried where the speed itself is too high.
const SLOWER: f64 = 0.4;

/// Rule for the target speed of a candidate plan.
#[derive(Clone, Copy, Debug)]
enum Speed {
    Near,
    Far,
    BelowFar,
}

/// Candidate plan for the next stretch of time: how fast it may be, and how it brakes.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    /// Number of steps in [`SHARES`] by which the candidate is slower than the first one.
    slower_by: usize,
    speed: Speed,
    /// Share of the bounds of the plan that its braking uses.
    brake: f64,
}

const fn candidate(slower_by: usize, speed: Speed, brake: f64) -> Candidate {
    Candidate {
        slower_by,
        speed,
        brake,
    }
}

/// Candidate plans in the order in which they are tried.
const CANDIDATES: [Candidate; 16] = [
    candidate(0, Speed::Near, 1.0),
    candidate(0, Speed::Far, 1.0),
    candidate(0, Speed::Far, BRAKE_ON_CURVE),
    candidate(1, Speed::Near, 1.0),
    candidate(1, Speed::Far, 1.0),
    candidate(1, Speed::Far, BRAKE_ON_CURVE),
    candidate(2, Speed::Near, 1.0),
    candidate(2, Speed::Far, 1.0),
    candidate(0, Speed::BelowFar, 1.0),
    candidate(1, Speed::BelowFar, 1.0),
    candidate(2, Speed::BelowFar, 1.0),
    candidate(3, Speed::Far, 1.0),
    candidate(3, Speed::BelowFar, 1.0),
    candidate(4, Speed::Far, 1.0),
    candidate(4, Speed::BelowFar, 1.0),
    candidate(4, Speed::Near, 1.0),
];

/// Limits of a plan that depend on the command: speed and use of the bounds of the tool.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Demand {
    /// Maximum velocity of the path parameter, in its unit per second.
    pub speed: f64,
    /// Share of the bounds of the tool that the path parameter may use while a residual uses the rest.
    pub tool_share: f64,
}

/// Planner of the time law. It remembers the share of [`SHARES`] that was accepted last, so that the next plan begins
/// near to it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Planner {
    pub last_share: usize,
}

impl Planner {
    /// Returns the fastest time law from `now` on that is verified, or `None` if the budget of checks is used up; the
    /// law in force must then be kept. `held_end` is the path parameter at which the law in force comes to rest.
    pub(crate) fn plan(
        &mut self,
        verifier: &Verifier<'_>,
        now: PathState,
        time: f64,
        held_end: f64,
        demand: Demand,
    ) -> Option<HeldBrake> {
        let table = verifier.table;
        let length = table.path().length();
        // A little more than the present brake needs, so that a law from rest sees the next nodes, too.
        let ahead = held_end - now.s + 0.004f64.min(length / 16.0);
        let near = allowed(table, now.s, 0.5 * ahead, demand);
        let far = allowed(table, now.s, ahead, demand);
        let (acceleration, jerk) = (
            near.acceleration.min(far.acceleration),
            near.jerk.min(far.jerk),
        );
        let curved = table.is_curved_between(now.s, now.s + ahead);
        let mut samples = SAMPLES_PER_CYCLE;
        let first = self.last_share.saturating_sub(1);
        for candidate in CANDIDATES {
            let number = first + candidate.slower_by;
            let Some(share) = SHARES.get(number) else {
                continue;
            };
            if candidate.brake < 1.0 && !curved {
                continue;
            }
            let bounds = Bounds {
                speed: match candidate.speed {
                    Speed::Near => near.velocity,
                    Speed::Far => far.velocity,
                    Speed::BelowFar => SLOWER * far.velocity,
                },
                acceleration: acceleration * share,
                jerk: jerk * share,
            };
            let profile = StateToRestProfile::new(now.into(), length, bounds);
            let law = profile.and_then(|profile| {
                let (acceleration, jerk) = (
                    candidate.brake * bounds.acceleration,
                    candidate.brake * bounds.jerk,
                );
                HeldBrake::following(profile, time, acceleration, jerk)
            });
            let Some(law) = law else { continue };
            if bounds.speed > far.velocity && !slows_down_in_time(table, &law, bounds, ahead) {
                continue;
            }
            if samples == 0 {
                return None;
            }
            if verifier.accepts(&law, &mut samples) {
                self.last_share = number;
                return Some(law);
            }
        }
        None
    }
}

/// Bounds of the path parameter for a stretch of the path.
pub(crate) fn allowed(table: &NodeTable, s: f64, ahead: f64, demand: Demand) -> MostAllowed {
    let mut cursor = 0;
    let most = table.most_between(s, s + ahead, &mut cursor);
    let requested = table.requested();
    MostAllowed {
        velocity: most.velocity.min(demand.speed),
        acceleration: most
            .acceleration
            .min(requested.acceleration * demand.tool_share),
        jerk: most.jerk.min(requested.jerk * demand.tool_share),
    }
}

/// Returns whether the time law can slow down to the speed of each place ahead before it is there. A stop alone would
/// end there in time, too, but too late to pass at that speed: its acceleration must have decayed when the place
/// begins.
fn slows_down_in_time(table: &NodeTable, law: &HeldBrake, bounds: Bounds, ahead: f64) -> bool {
    /// Ratio of the speeds of two successive places that are checked: only markedly slower places count, not each node.
    const STEP: f64 = 0.8;
    let turn = law.turn;
    let mut level = turn.velocity;
    let mut cursor = 0;
    let mut places = table.places_between(turn.s, turn.s + ahead, &mut cursor);
    places.all(|(s, speed)| {
        if speed >= STEP * level {
            return true;
        }
        level = speed;
        slowing_distance(&turn, speed, bounds).is_some_and(|distance| turn.s + distance <= s)
    })
}

/// Distance in which the path parameter comes from a state to a speed without acceleration.
fn slowing_distance(from: &PathState, speed: f64, bounds: Bounds) -> Option<f64> {
    let change = VelocityState {
        velocity: from.velocity - speed,
        acceleration: from.acceleration,
    };
    let slowing = StopProfile::new(change, bounds.acceleration, bounds.jerk)?;
    Some(slowing.distance() + speed * slowing.duration())
}
