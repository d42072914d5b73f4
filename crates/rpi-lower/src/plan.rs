//! What the passes over the net found out and the lowering needs.

use rpi_net::Tree;
use rpi_net::passes::{Analysis, Presences, Schedule};

/// Order and presence of a net.
#[derive(Clone, Copy, Debug)]
pub struct Plan<'a> {
    /// Its fragments as a tree.
    pub tree: &'a Tree,
    /// The order of evaluation.
    pub schedule: &'a Schedule,
    /// Which flows may be absent.
    pub presences: &'a Presences,
}

impl<'a> Plan<'a> {
    /// What was found out about a net; none if something in it depends on itself.
    #[must_use]
    pub fn of(analysis: &'a Analysis) -> Option<Plan<'a>> {
        Some(Plan {
            tree: &analysis.tree,
            schedule: analysis.schedule.as_ref()?,
            presences: &analysis.presences,
        })
    }
}
