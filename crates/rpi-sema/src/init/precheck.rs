//! Fast pre-check of the initialisation, which most nets pass: in which phases each flow may be uninitialised.
//!
//! It ignores values and all conditions except `first`, so it over-approximates the
//! [`Solution`](super::solve::Solution). Only nodes behind a delay are visited, with one byte of state for each node.

use crate::init::phases::{PHASES, PhaseSet};
use crate::init::rules::{TransferRule, is_by_first};
use crate::init::solve::previous_phases;
use rpi_net::passes::Readers;
use rpi_net::{FragmentId, Input, Net, NodeId, PortRef};

/// Returns whether one of the ports in `read`, each with the fragment in which it is read, may be read before it is
/// initialised.
pub(super) fn may_read_uninitialised(
    net: &Net,
    rules: &[TransferRule],
    mut read: impl Iterator<Item = (PortRef, FragmentId)>,
) -> bool {
    let glance = Precheck::new(net, rules);
    read.any(|(port, from)| !glance.port_phases(port, from).is_empty())
}

struct Precheck<'n> {
    net: &'n Net,
    rules: &'n [TransferRule],
    /// For each node, the phases of its fragment in which its output may be uninitialised.
    uninitialised: Vec<PhaseSet>,
}

impl<'n> Precheck<'n> {
    fn new(net: &'n Net, rules: &'n [TransferRule]) -> Self {
        let mut glance = Precheck {
            net,
            rules,
            uninitialised: vec![PhaseSet::default(); net.nodes.len()],
        };
        let users = Readers::new(net);
        let is_delay = |id: &NodeId| rules[id.index()] == TransferRule::Delay;
        let mut open: Vec<NodeId> = net.node_ids().filter(is_delay).collect();
        while let Some(id) = open.pop() {
            let next = glance.node_phases(id);
            if std::mem::replace(&mut glance.uninitialised[id.index()], next) != next {
                open.extend(users.readers_of(id));
            }
        }
        glance
    }

    /// Returns the phases in which the output of a node may be uninitialised, computed from those of its inputs. The
    /// function is monotone, so that a least solution exists.
    fn node_phases(&self, id: NodeId) -> PhaseSet {
        let start = PhaseSet::single(0);
        let input = |k: usize| self.input(id, k);
        match self.rules[id.index()] {
            TransferRule::Delay => start.union(phases_after_delay(input(0))),
            TransferRule::OptionalDelay => phases_after_delay(input(0)),
            TransferRule::Conditional if is_by_first(self.net, self.rules, id) => input(1)
                .intersection(start)
                .union(input(2).intersection(start.complement())),
            _ => {
                let inputs = 0..self.net.node(id).inputs.len();
                inputs.map(input).fold(PhaseSet::default(), PhaseSet::union)
            }
        }
    }

    fn input(&self, id: NodeId, input: usize) -> PhaseSet {
        let node = self.net.node(id);
        match node.inputs.get(input) {
            Some(Input::Port(port)) => self.port_phases(*port, node.fragment),
            _ => PhaseSet::default(),
        }
    }

    /// Returns the phases of the fragment `from` in which a port may be uninitialised for a read in that fragment. If
    /// the port is in another fragment, any phase of one fragment may coincide with any phase of the other.
    fn port_phases(&self, port: PortRef, from: FragmentId) -> PhaseSet {
        let without = self.uninitialised[port.node.index()];
        match without.is_empty() || self.net.node(port.node).fragment == from {
            true => without,
            false => PhaseSet::default().complement(),
        }
    }
}

/// Returns the phases in which a delay outputs a value that it read in one of the phases `given`.
fn phases_after_delay(given: PhaseSet) -> PhaseSet {
    let meets = |phase: &usize| {
        previous_phases(*phase)
            .iter()
            .any(|phase| given.contains(*phase))
    };
    let phases = (0..PHASES).filter(meets).map(PhaseSet::single);
    phases.fold(PhaseSet::default(), PhaseSet::union)
}
