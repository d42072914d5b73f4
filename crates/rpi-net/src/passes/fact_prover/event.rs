//! Events in a cycle, about which the prover answers.

use crate::net::{FragmentId, PortRef};

/// Event in a cycle, about whose occurrence proofs are made: a fragment is active, and the flows in `present` have
/// values for a reader in the fragment.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) struct Event {
    pub(crate) fragment: FragmentId,
    pub(crate) present: Vec<PortRef>,
}
