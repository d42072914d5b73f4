//! Plans the next piece of the time law: the fastest one whose brake passes the verification.

use crate::node_table::{MostAllowed, NodeTable};
use crate::time_law::{HeldBrake, PathState};
use crate::verify::Verifier;
use rpi_kin::state_to_rest::{Bounds, StateToRestProfile};

/// Shares of acceleration and jerk that are tried, from fast to slow.
pub(crate) const SHARES: [f64; 5] = [1.0, 0.7, 0.45, 0.25, 0.1];

/// Verifications of one plan, at most.
pub(crate) const CHECKS: usize = 7;

/// What a plan may ask for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Demand {
    /// Maximum velocity of the path parameter.
    pub speed: f64,
    /// Share of the bounds of the tool that the path parameter may use, as long as the residual uses the rest.
    pub tool_share: f64,
}

/// Planner of the time law. It remembers the share that held last, so that the next plan begins near to it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Planner {
    pub last_share: usize,
}

impl Planner {
    /// Returns the fastest law from `now` on that is verified, or `None` if the budget of checks is used up. Then the
    /// law in force must be kept. `held_end` is where that one ends.
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
        let mut checks = 0;
        for number in self.last_share.saturating_sub(1)..SHARES.len() {
            let share = SHARES[number];
            for speed in [near.velocity, far.velocity, 0.4 * far.velocity] {
                if checks == CHECKS {
                    return None;
                }
                let bounds = Bounds {
                    speed,
                    acceleration: acceleration * share,
                    jerk: jerk * share,
                };
                let profile = StateToRestProfile::new(now.into(), length, bounds);
                let law = profile.and_then(|profile| {
                    HeldBrake::following(profile, time, bounds.acceleration, bounds.jerk)
                });
                let Some(law) = law else { continue };
                checks += 1;
                if verifier.accepts(&law) {
                    self.last_share = number;
                    return Some(law);
                }
            }
        }
        None
    }
}

/// Bounds of the path parameter for a stretch of the path.
pub(crate) fn allowed(table: &NodeTable, s: f64, ahead: f64, demand: Demand) -> MostAllowed {
    let mut cursor = 0;
    let most = table.most_between(s, s + ahead, &mut cursor);
    let asked = table.asked();
    MostAllowed {
        velocity: most.velocity.min(demand.speed),
        acceleration: most
            .acceleration
            .min(asked.acceleration * demand.tool_share),
        jerk: most.jerk.min(asked.jerk * demand.tool_share),
    }
}
