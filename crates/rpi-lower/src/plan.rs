//! Results of the net analyses that the lowering needs.

use rpi_net::FragmentTree;
use rpi_net::passes::{Analysis, Presences, Schedule};

/// Results of the analyses that lowering needs: fragment tree, schedule and presences of a net.
#[derive(Clone, Copy, Debug)]
pub struct Plan<'a> {
    /// Fragments of the net as a tree.
    pub tree: &'a FragmentTree,
    /// Order of evaluation.
    pub schedule: &'a Schedule,
    /// Flows that may be absent.
    pub presences: &'a Presences,
}

impl<'a> Plan<'a> {
    /// The plan of an analysed net; `None` if the net has a dependency cycle and therefore no schedule.
    #[must_use]
    pub fn from_analysis(analysis: &'a Analysis) -> Option<Plan<'a>> {
        Some(Plan {
            tree: &analysis.tree,
            schedule: analysis.schedule.as_ref()?,
            presences: &analysis.presences,
        })
    }
}
