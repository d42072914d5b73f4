//! What the passes over the net found out and the lowering needs.

use rpi_net::passes::{Dependencies, Presences, Schedule, Users};
use rpi_net::{Net, PortRef, Tree};

/// Order and presence of a net.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Its fragments as a tree.
    pub tree: Tree,
    /// The order of evaluation.
    pub schedule: Schedule,
    /// Which flows may be absent.
    pub presences: Presences,
}

impl Plan {
    /// Runs the passes over a net; none if something in it depends on itself.
    #[must_use]
    pub fn new(net: &Net, may_be_absent: impl Fn(PortRef) -> bool) -> Option<Plan> {
        let tree = Tree::new(net);
        let schedule = Schedule::new(&Dependencies::new(net, &tree))?;
        let presences = Presences::infer(net, &tree, &Users::new(net), may_be_absent);
        Some(Plan {
            tree,
            schedule,
            presences,
        })
    }
}
