//! A first look, which most nets pass: in which phases might each flow have no value, whatever holds or does not hold?
//!
//! It knows no values and no conditions but `first`, so it sees more than there is, and never less than the
//! [`Solution`](super::solve::Solution). Only what lies behind a delay is looked at, one byte for each node.

use super::phases::{PHASES, PhaseSet};
use super::rules::{Rule, is_by_first};
use super::solve::before;
use rpi_net::passes::Users;
use rpi_net::{FragmentId, Input, Net, NodeId, PortRef};

/// Whether one of these flows might be read before it has a value.
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
    /// For each node the phases in which it might have no value.
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

    /// The phases grow with those of the in-ports, so that the least solution exists.
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

    /// Any phase of another fragment may meet any of one's own.
    fn seen(&self, port: PortRef, from: FragmentId) -> PhaseSet {
        let without = self.without[port.node.index()];
        match without.is_empty() || self.net.node(port.node).fragment == from {
            true => without,
            false => PhaseSet::default().others(),
        }
    }
}

/// The phases in which a delay gives what it was given in one of these.
fn later(given: PhaseSet) -> PhaseSet {
    let meets = |phase: &usize| before(*phase).iter().any(|phase| given.has(*phase));
    let phases = (0..PHASES).filter(meets).map(PhaseSet::only);
    phases.fold(PhaseSet::default(), PhaseSet::with)
}
