//! Fast pre-check of the initialisation, which most nets pass: in which phases each flow may be uninitialised.
//!
//! It ignores values and all conditions except `first`, so it over-approximates the
//! [`Solution`](super::solve::Solution). Only nodes behind a delay are visited, with one byte of state for each node.

use crate::init::phases::{PHASES, PhaseSet};
use crate::init::rules::{Rule, is_by_first};
use crate::init::solve::before;
use rpi_net::passes::Users;
use rpi_net::{FragmentId, Input, Net, NodeId, PortRef};

/// Returns whether one of these flows may be read before it is initialised.
pub(super) fn doubts(
    net: &Net,
    rules: &[Rule],
    mut read: impl Iterator<Item = (PortRef, FragmentId)>,
) -> bool {
    let glance = Glance::new(net, rules);
    read.any(|(port, from)| !glance.seen(port, from).is_empty())
}

struct Glance<'n> {
    net: &'n Net,
    rules: &'n [Rule],
    /// For each node, the phases in which it may be uninitialised.
    without: Vec<PhaseSet>,
}

impl<'n> Glance<'n> {
    fn new(net: &'n Net, rules: &'n [Rule]) -> Self {
        let mut glance = Glance {
            net,
            rules,
            without: vec![PhaseSet::default(); net.nodes.len()],
        };
        let users = Users::new(net);
        let is_delay = |id: &NodeId| rules[id.index()] == Rule::Delay;
        let mut open: Vec<NodeId> = net.node_ids().filter(is_delay).collect();
        while let Some(id) = open.pop() {
            let next = glance.of_node(id);
            if std::mem::replace(&mut glance.without[id.index()], next) != next {
                open.extend(users.of(id));
            }
        }
        glance
    }

    /// Computes the phases of a node from those of its inputs. The function is monotone, so the least solution exists.
    fn of_node(&self, id: NodeId) -> PhaseSet {
        let start = PhaseSet::only(0);
        let input = |k: usize| self.input(id, k);
        match self.rules[id.index()] {
            Rule::Delay => start.with(later(input(0))),
            Rule::OptionalDelay => later(input(0)),
            Rule::Choice if is_by_first(self.net, self.rules, id) => {
                input(1).and(start).with(input(2).and(start.others()))
            }
            _ => {
                let inputs = 0..self.net.node(id).inputs.len();
                inputs.map(input).fold(PhaseSet::default(), PhaseSet::with)
            }
        }
    }

    fn input(&self, id: NodeId, input: usize) -> PhaseSet {
        let node = self.net.node(id);
        match node.inputs.get(input) {
            Some(Input::Port(port)) => self.seen(*port, node.fragment),
            _ => PhaseSet::default(),
        }
    }

    /// Returns the phases of a port for a reader. Any phase of another fragment may coincide with any phase of the
    /// reader's.
    fn seen(&self, port: PortRef, from: FragmentId) -> PhaseSet {
        let without = self.without[port.node.index()];
        match without.is_empty() || self.net.node(port.node).fragment == from {
            true => without,
            false => PhaseSet::default().others(),
        }
    }
}

/// Returns the phases in which a delay outputs a value that it read in one of the given phases.
fn later(given: PhaseSet) -> PhaseSet {
    let meets = |phase: &usize| before(*phase).iter().any(|phase| given.has(*phase));
    let phases = (0..PHASES).filter(meets).map(PhaseSet::only);
    phases.fold(PhaseSet::default(), PhaseSet::with)
}
