//! Results of the net analyses that the lowering needs.

use rpi_net::FragmentTree;
use rpi_net::passes::{Analysis, Presences, Schedule};

/// Results of the net analyses that the translation to an image needs: fragment tree, schedule and presences.
#[derive(Clone, Copy, Debug)]
pub struct Plan<'a> {
    /// Fragments of the net as a tree. A fragment is a part of the net that is activated and reset as a whole.
    pub tree: &'a FragmentTree,
    /// Order in which the nodes and fragments of the net are evaluated in each cycle.
    pub schedule: &'a Schedule,
    /// For every flow of the net, whether it has a value in every, some or no cycle.
    pub presences: &'a Presences,
}

impl<'a> Plan<'a> {
    /// Returns the plan of an analysed net; `None` if the net has a dependency cycle and therefore no schedule.
    #[must_use]
    pub fn from_analysis(analysis: &'a Analysis) -> Option<Plan<'a>> {
        Some(Plan {
            tree: &analysis.tree,
            schedule: analysis.schedule.as_ref()?,
            presences: &analysis.presences,
        })
    }
}
