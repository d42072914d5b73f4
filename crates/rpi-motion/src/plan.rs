//! Plans the next piece of the time law: the fastest one whose brake passes the verification.

use crate::node::{MostAllowed, Node, tool_shares};
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

/// Share of the bounds of the tool that a steady speed uses at most where braking can begin: on a curve that is passed at its own
/// speed, no jerk is left for it.
const FREE: f64 = 0.35;

/// Distance up to which a curve counts, as a multiple of the braking distance.
const NOT_FAR: f64 = 3.0;

/// Rule for the target speed of a candidate plan.
#[derive(Clone, Copy, Debug)]
enum Speed {
    Near,
    Far,
    BelowFar,
    /// That of the tightest curve ahead; the brake begins only behind it, or (1) behind the next one.
    Through(usize),
}

/// Candidate plan for the next stretch of time: how fast it may be, and how it brakes.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    /// Number of steps in [`SHARES`] by which the candidate is slower than the first one.
    slower_by: usize,
    speed: Speed,
    /// Share of the bounds of the plan that its braking uses; behind a curve, of those of the path.
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
const CANDIDATES: [Candidate; 24] = [
    candidate(0, Speed::Near, 1.0),
    candidate(0, Speed::Far, 1.0),
    candidate(0, Speed::Far, BRAKE_ON_CURVE),
    candidate(0, Speed::Through(0), 1.0),
    candidate(0, Speed::Through(0), BRAKE_ON_CURVE),
    candidate(0, Speed::Through(1), BRAKE_ON_CURVE),
    candidate(1, Speed::Near, 1.0),
    candidate(1, Speed::Far, 1.0),
    candidate(1, Speed::Far, BRAKE_ON_CURVE),
    candidate(1, Speed::Through(0), BRAKE_ON_CURVE),
    candidate(1, Speed::Through(1), BRAKE_ON_CURVE),
    candidate(2, Speed::Through(0), BRAKE_ON_CURVE),
    candidate(3, Speed::Through(0), BRAKE_ON_CURVE),
    candidate(4, Speed::Through(0), BRAKE_ON_CURVE),
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

/// What the path allows ahead of a plan.
struct Ahead {
    /// Path parameter now, and the length of the stretch ahead that counts.
    from: f64,
    length: f64,
    near: MostAllowed,
    far: MostAllowed,
    /// Smaller of both in acceleration and jerk.
    most: MostAllowed,
    curved: bool,
    tight: Option<TightCurve>,
}

impl Ahead {
    /// Looks at the path up to a little more than the present brake needs (to `held_end`), so that a law from rest sees
    /// the next nodes, too.
    fn new(table: &NodeTable, from: f64, held_end: f64, demand: Demand) -> Self {
        let length = held_end - from + 0.004f64.min(table.goal() / 16.0);
        let near = allowed(table, from, 0.5 * length, demand);
        let mut far = allowed(table, from, length, demand);
        let curved = table.is_curved_between(from, from + length);
        let tight = curved.then(|| TightCurve::find(table, from, length, demand.speed));
        let tight = tight.flatten();
        if let Some(curve) = tight {
            // On a curve there may be no jerk left for slowing down to its tightest place.
            far.velocity = far.velocity.min(curve.near_speed);
        }
        Self {
            from,
            length,
            near,
            far,
            most: near.min(far),
            curved,
            tight,
        }
    }

    /// Returns the bounds of a candidate plan, and the place before which its brake must not begin.
    fn bounds(&self, candidate: &Candidate, share: f64) -> Option<(Bounds, f64)> {
        let (speed, behind) = match candidate.speed {
            Speed::Near => (self.near.velocity, self.from),
            Speed::Far => (self.far.velocity, self.from),
            Speed::BelowFar => (SLOWER * self.far.velocity, self.from),
            Speed::Through(number) => {
                let curve = self.tight?;
                (curve.speed, curve.behind[number]?)
            }
        };
        let bounds = Bounds {
            speed,
            acceleration: self.most.acceleration * share,
            jerk: self.most.jerk * share,
        };
        (candidate.brake >= 1.0 || self.curved).then_some((bounds, behind))
    }

    /// Returns acceleration and jerk of the brake of a candidate plan. Behind a curve, they do not depend on those of the
    /// plan on it.
    fn brake(&self, candidate: &Candidate, plan: &Bounds) -> (f64, f64) {
        let (acceleration, jerk) = match candidate.speed {
            Speed::Through(_) => (self.most.acceleration, self.most.jerk),
            _ => (plan.acceleration, plan.jerk),
        };
        (candidate.brake * acceleration, candidate.brake * jerk)
    }

    /// Returns whether the time law can slow down to the speed of each place ahead before it is there. A stop alone would
    /// end there in time, too, but too late to pass at that speed: its acceleration must have decayed when the place
    /// begins.
    fn slows_down_in_time(&self, table: &NodeTable, law: &HeldBrake, bounds: Bounds) -> bool {
        /// Ratio of the speeds of two successive places that are checked: only slower places count, not each node.
        const STEP: f64 = 0.9;
        let turn = law.turn;
        let is_in_time = |speed: f64, place: f64| {
            slowing_distance(&turn, speed, bounds).is_some_and(|way| turn.s + way <= place)
        };
        if let Some(curve) = self.tight
            && curve.begin > turn.s
            && curve.near_speed < turn.velocity
            && !is_in_time(curve.near_speed, curve.begin)
        {
            return false;
        }
        let mut level = turn.velocity;
        let (mut cursor, mut before) = (0, turn.s);
        let mut places = table.nodes_between(turn.s, turn.s + self.length, &mut cursor);
        places.all(|node| {
            // A curve may begin anywhere between two nodes.
            let (s, speed) = (core::mem::replace(&mut before, node.s), node.most.velocity);
            if speed >= STEP * level {
                return true;
            }
            level = speed;
            is_in_time(speed, s)
        })
    }
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
        let ahead = Ahead::new(table, now.s, held_end, demand);
        let mut samples = SAMPLES_PER_CYCLE;
        let first = self.last_share.saturating_sub(1);
        for candidate in CANDIDATES {
            let number = first + candidate.slower_by;
            let share = SHARES.get(number).copied();
            let Some((bounds, behind)) = share.and_then(|share| ahead.bounds(&candidate, share))
            else {
                continue;
            };
            let profile = StateToRestProfile::new(now.into(), table.goal(), bounds);
            let brake = ahead.brake(&candidate, &bounds);
            let law = profile.and_then(|plan| HeldBrake::following(plan, time, behind, brake));
            let Some(law) = law else { continue };
            if bounds.speed > ahead.far.velocity && !ahead.slows_down_in_time(table, &law, bounds) {
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

/// Curve ahead on which the tool has no jerk left for braking.
#[derive(Clone, Copy, Debug)]
struct TightCurve {
    /// Greatest speed on it.
    speed: f64,
    /// Greatest speed on the part of it that is not far.
    near_speed: f64,
    /// Place where it begins.
    begin: f64,
    /// First place behind it where the tool can brake, and the same behind the next tight curve if that is near.
    behind: [Option<f64>; 2],
}

impl TightCurve {
    /// Finds the tightest curve within `ahead` of the place `s`, at a speed of at most `speed`; the next one counts up
    /// to the same distance behind it.
    fn find(table: &NodeTable, s: f64, ahead: f64, speed: f64) -> Option<Self> {
        let mut cursor = 0;
        let mut curve = Self {
            speed,
            near_speed: speed,
            begin: s,
            behind: [None; 2],
        };
        let (mut run, mut before) = (s, s);
        let (mut end, mut was_tight) = (s + ahead, false);
        for node in table.nodes_between(s, f64::INFINITY, &mut cursor) {
            if node.s > end && !was_tight {
                break;
            }
            let is_first = curve.behind[0].is_none();
            let is_tightest = node.most.velocity < curve.speed;
            if is_tightest && (is_first || node.s <= s + ahead) {
                curve.speed = node.most.velocity;
                curve.behind = [None; 2];
            }
            if is_first && node.s <= s + NOT_FAR * ahead {
                curve.near_speed = curve.near_speed.min(node.most.velocity);
            }
            let is_tight = curve.is_tight_at(table, node);
            if is_tight && !was_tight {
                run = before;
            }
            if is_tight && curve.behind[0].is_none() {
                curve.begin = run;
            }
            before = node.s;
            if was_tight && !is_tight {
                let slot = curve.behind.iter_mut().find(|place| place.is_none());
                if let Some(slot) = slot {
                    *slot = Some(node.s);
                }
                end = (node.s + ahead).max(end);
                if curve.behind[1].is_some() {
                    break;
                }
            }
            was_tight = is_tight;
        }
        curve.behind[0].map(|_| curve)
    }

    fn is_tight_at(&self, table: &NodeTable, node: &Node) -> bool {
        let (share, jerk_share) = tool_shares(table.requested(), node.curvature, self.speed);
        share.max(jerk_share) > FREE
    }
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
