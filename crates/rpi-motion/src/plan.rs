//! Plans the next piece of the time law: the fastest one whose brake passes the verification.

use crate::node::{MostAllowed, Node, tool_shares};
use crate::node_table::NodeTable;
use crate::time_law::{HeldBrake, PathState};
use crate::verify::Verifier;
use rpi_kin::state_to_rest::{Bounds, StateToRestProfile};
use rpi_kin::stop_profile::{StopProfile, VelocityState};

/// Shares of the maximum acceleration and jerk along the path with which plans are tried, from fast to slow.
pub(crate) const SHARES: [f64; 5] = [1.0, 0.7, 0.45, 0.25, 0.1];

/// Share of the acceleration and jerk of a plan that its stop uses where the path is curved: there, a part of the jerk
/// of the tool is needed across the path.
const BRAKE_ON_CURVE: f64 = 0.6;

/// Share of the lowest allowed speed ahead with which a plan is tried if plans with the speed itself fail.
const SLOWER: f64 = 0.4;

/// Share of the requested acceleration and jerk of the tool that a constant speed may use at a place where braking
/// begins. On a curve that is passed at its own maximum speed, no jerk is left for braking.
const FREE: f64 = 0.35;

/// Multiple of the braking distance up to which a curve ahead counts as near, without unit.
const NOT_FAR: f64 = 3.0;

/// Rule for the target speed of a candidate plan.
#[derive(Clone, Copy, Debug)]
enum Speed {
    Near,
    Far,
    BelowFar,
    /// Speed of the tightest curve ahead. The stop begins only behind this curve (0), or behind the next one (1).
    Through(usize),
}

/// Candidate for the plan of the next 16 ms: how fast it may be, and how it stops.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    /// Number of steps in [`SHARES`] by which the candidate is slower than the first candidate.
    slower_by: usize,
    speed: Speed,
    /// Share of the acceleration and jerk of the plan that the stop uses; for a stop behind a curve, share of those
    /// that the path allows.
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

/// Shares of the lowest allowed speed ahead with which a plan continues the present stop, but does not come to rest.
const SPEEDS_OF_STOP: [f64; 3] = [1.0, SLOWER, SLOWER * SLOWER];

/// Multiple of the lowest allowed speed ahead below which a stop has slowed down enough and is not to come to rest.
const NEARLY: f64 = 1.5;

/// Number of samples whose work the time law of a candidate takes.
const SAMPLES_OF_PROFILE: usize = 6;

/// Part of the samples of a cycle, as a divisor, that is kept for plans that continue the present stop.
const RESERVE: usize = 4;

/// Limits of a plan that depend on the request and the situation: maximum speed, and use of the bounds of the tool.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Demand {
    /// Maximum velocity along the path, m/s (rad/s on a joint line).
    pub speed: f64,
    /// Share of the requested acceleration and jerk of the tool that the motion along the path may use; a residual
    /// (decaying difference between arm and path) uses the rest.
    pub tool_share: f64,
    /// Maximum number of samples that all verifications of one cycle take together.
    pub samples: usize,
}

/// Planner of the time law along a path. It stores which of the [`SHARES`] was accepted last, so that the next plan
/// begins near to it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Planner {
    pub last_share: usize,
}

/// One candidate with its numbers: the bounds of the plan, the position along the path before which its stop must not
/// begin, and the maximum magnitudes of acceleration and jerk of the stop.
struct Trial {
    bounds: Bounds,
    behind: f64,
    brake: (f64, f64),
}

/// Speeds that the path allows within a stretch ahead of the motion.
struct Ahead {
    /// Position along the path (path parameter) at the start of the stretch, m (rad on a joint line).
    from: f64,
    /// Length of the stretch, m (rad on a joint line).
    length: f64,
    near: MostAllowed,
    far: MostAllowed,
    /// Smaller one of `near` and `far`, for acceleration and jerk.
    most: MostAllowed,
    curved: bool,
    tight: Option<TightCurve>,
}

impl Ahead {
    /// Examines the path from `from` to a little beyond `held_end`, where the present time law comes to rest, so that a
    /// motion from rest sees the next nodes, too.
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

    /// Returns the numbers of a candidate plan with the share `share` of acceleration and jerk. `None` if the candidate
    /// does not apply to this path.
    fn trial(&self, candidate: &Candidate, share: f64) -> Option<Trial> {
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
        // Behind a curve, the stop does not depend on the bounds of the plan on the curve.
        let (acceleration, jerk) = match candidate.speed {
            Speed::Through(_) => (self.most.acceleration, self.most.jerk),
            _ => (bounds.acceleration, bounds.jerk),
        };
        let brake = (candidate.brake * acceleration, candidate.brake * jerk);
        (candidate.brake >= 1.0 || self.curved).then_some(Trial {
            bounds,
            behind,
            brake,
        })
    }

    /// Returns plans that slow down as the present stop of `held` does, but to a constant speed instead of to rest.
    /// Shortly before a narrow place that is much slower than all others, only the stop is known to pass: the
    /// acceleration and jerk that the place allows at its own speed are too small to slow down in time.
    fn slower_stops(&self, held: &HeldBrake) -> impl Iterator<Item = Trial> + use<> {
        let (speed, from) = (self.far.velocity, self.from);
        let brake = held.stop_bounds;
        SPEEDS_OF_STOP
            .iter()
            .filter(move |_| brake.0 > 0.0 && brake.1 > 0.0)
            .map(move |share| Trial {
                bounds: Bounds {
                    speed: share * speed,
                    acceleration: brake.0,
                    jerk: brake.1,
                },
                behind: from,
                brake,
            })
    }

    /// Returns the time law of a trial from the state `now` at `time` (s) on. `None` if it would move backwards, or
    /// would pass a slow place too fast.
    fn time_law(
        &self,
        table: &NodeTable,
        now: PathState,
        time: f64,
        trial: &Trial,
    ) -> Option<HeldBrake> {
        let Trial {
            bounds,
            behind,
            brake,
        } = *trial;
        let plan = StateToRestProfile::new(now.into(), table.goal(), bounds)?;
        let law = HeldBrake::following(plan, time, behind, brake)?;
        let is_slow_enough = bounds.speed <= self.far.velocity;
        (is_slow_enough || self.slows_down_in_time(table, &law, bounds)).then_some(law)
    }

    /// Returns true if the motion can slow down to the speed of each place ahead before it reaches the place, once the
    /// stop of the time law begins. The stop alone would come to rest in time, too, but would pass such a place too
    /// fast.
    fn slows_down_in_time(&self, table: &NodeTable, law: &HeldBrake, bounds: Bounds) -> bool {
        /// Ratio of the allowed speeds of two successive places to check: only places that are slower by this ratio
        /// count.
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
    /// Returns the fastest verified time law from the state `now` at `time` (s) on; `None` if no candidate passes with
    /// the samples of one cycle, so that the present law `held` must continue.
    pub(crate) fn plan(
        &mut self,
        verifier: &Verifier<'_>,
        now: PathState,
        time: f64,
        held: &HeldBrake,
        demand: Demand,
    ) -> Option<HeldBrake> {
        let ahead = Ahead::new(verifier.table, now.s, held.end(), demand);
        let accepted = |trial: &Trial, samples: &mut usize| {
            *samples = samples.saturating_sub(SAMPLES_OF_PROFILE);
            if *samples == 0 {
                return None;
            }
            let law = ahead.time_law(verifier.table, now, time, trial)?;
            verifier.accepts(&law, samples).then_some(law)
        };
        let is_stopping = held.stop_bounds.0 > 0.0
            && time >= held.start_time + held.piece_time
            && now.velocity <= NEARLY * ahead.far.velocity;
        let reserve = match is_stopping {
            true => demand.samples / RESERVE,
            false => 0,
        };
        let mut samples = demand.samples - reserve;
        let first = self.last_share.saturating_sub(1);
        for candidate in CANDIDATES {
            let number = first + candidate.slower_by;
            let trial = SHARES
                .get(number)
                .and_then(|share| ahead.trial(&candidate, *share));
            if let Some(law) = trial.and_then(|trial| accepted(&trial, &mut samples)) {
                self.last_share = number;
                return Some(law);
            }
        }
        if !is_stopping {
            return None;
        }
        samples += reserve;
        ahead
            .slower_stops(held)
            .find_map(|trial| accepted(&trial, &mut samples))
    }
}

/// Returns the maximum velocity, acceleration and jerk along the path for the stretch of length `ahead` from the
/// position `s` on.
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

/// Part of the path ahead that is so curved that the tool has no jerk left for braking on it.
#[derive(Clone, Copy, Debug)]
struct TightCurve {
    /// Maximum speed of the tool along the whole curve, m/s.
    speed: f64,
    /// Maximum speed of the tool along the part of the curve within a few braking distances ([`NOT_FAR`]), m/s.
    near_speed: f64,
    /// Position along the path (path parameter) at which the curve begins, m.
    begin: f64,
    /// Positions along the path of the first place where the tool can brake again: behind this curve, and behind the
    /// next tight curve; `None` if there is none near enough.
    behind: [Option<f64>; 2],
}

impl TightCurve {
    /// Finds the tightest curve within the distance `ahead` of the position `s`, for a speed of at most `speed`. The
    /// next tight curve counts if it begins within the same distance behind it. `None` if there is no tight curve.
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
        let (share, jerk_share) =
            tool_shares(table.requested(), node.largest_curvature(), self.speed);
        share.max(jerk_share) > FREE
    }
}

/// Returns the distance (m; rad on a joint line) in which a motion along the path changes from the state `from` to the
/// constant velocity `speed` within `bounds`; `None` if a number is not usable.
fn slowing_distance(from: &PathState, speed: f64, bounds: Bounds) -> Option<f64> {
    let change = VelocityState {
        velocity: from.velocity - speed,
        acceleration: from.acceleration,
    };
    let slowing = StopProfile::new(change, bounds.acceleration, bounds.jerk)?;
    Some(slowing.distance() + speed * slowing.duration())
}
