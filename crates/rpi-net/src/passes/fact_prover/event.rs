//! Events in a cycle, about which the prover answers.

use crate::net::{FragmentId, PortRef};

/// Event whose occurrence proofs are about: in a cycle a fragment is active, and some flows are present as seen from
/// it.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) struct Event {
    pub(crate) fragment: FragmentId,
    pub(crate) present: Vec<PortRef>,
}
