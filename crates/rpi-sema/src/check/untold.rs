//! Flows whose types nothing tells, because their equations only say that they are what others of them are.
//!
//! `a = b; b = a` waits for itself, and that is what is reported; `z = pre z` may run, but nothing says of what type.
//! What only follows from such flows is not mentioned.

use super::body::Body;
use super::order::{Guess, State};
use crate::typed::{FlowId, Optional};
use rpi_diag::{Code, Finding, Span};
use rpi_net::passes::causality::{self, Read};
use std::collections::VecDeque;

/// A flow of unknown type that the equation of another reads.
#[derive(Clone, Copy)]
struct Link {
    /// The equation that defines what is read.
    from: usize,
    /// The equation that reads it.
    to: usize,
    span: Span,
    /// Whether it is read in this very cycle, not through `pre`.
    now: bool,
}

impl Body<'_, '_> {
    /// Reports flows whose types nothing tells: first what waits for itself, which no guess mends.
    pub(super) fn report_unknown_types(&mut self) {
        self.report_rings(true);
        self.guess_by(Guess::Factors);
        self.report_rings(false);
    }

    /// Reports rings of flows of unknown type, either those within a cycle or all.
    fn report_rings(&mut self, only_now: bool) {
        let equations = 0..self.pending.len();
        let open: Vec<usize> = equations.filter(|index| self.is_untold(*index)).collect();
        let links: Vec<Link> = open.iter().flat_map(|index| self.links(*index)).collect();
        for index in open {
            let is_open = |at: usize| self.pending[at].state == State::Guessed;
            let usable =
                |link: &&Link| (link.now || !only_now) && is_open(link.from) && is_open(link.to);
            let usable: Vec<Link> = links.iter().filter(usable).copied().collect();
            let ring = ring_through(&usable, index);
            for link in &ring {
                self.pending[link.to].state = State::Told;
            }
            match (ring.is_empty(), only_now) {
                (true, _) => {}
                (false, true) => self.waits_for_itself(&ring, &links),
                (false, false) => self.untold(index),
            }
        }
    }

    fn is_untold(&self, index: usize) -> bool {
        let pending = &self.pending[index];
        let is_open = |flow: &FlowId| {
            let flow = self.unit.flow(*flow);
            flow.ty.has_unknown() && flow.optional == Optional::Inferred
        };
        pending.state == State::Guessed && pending.introduces.iter().flatten().any(is_open)
    }

    /// The flows of unknown type that an equation reads.
    fn links(&mut self, index: usize) -> Vec<Link> {
        let mark = self.mark();
        self.missing.clear();
        self.inferring = true;
        self.value_at(index);
        self.inferring = false;
        self.put_back(mark);
        let missing = std::mem::take(&mut self.missing);
        let reads = missing
            .iter()
            .filter(|read| self.is_untold(read.equation))
            .map(|read| Link {
                from: read.equation,
                to: index,
                span: read.span,
                now: read.now,
            });
        reads.collect()
    }

    fn waits_for_itself(&mut self, ring: &[Link], links: &[Link]) {
        let read = |link: &Link| {
            let is_same = |other: &&Link| {
                other.now
                    && (other.from, other.to) == (link.from, link.to)
                    && other.span != link.span
            };
            Read {
                from: self.name_of(link.from),
                to: self.name_of(link.to),
                span: link.span,
                more: links
                    .iter()
                    .filter(is_same)
                    .map(|other| other.span)
                    .collect(),
            }
        };
        let reads: Vec<Read> = ring.iter().map(read).collect();
        self.report(causality::ring(&reads));
    }

    /// The name of the first flow that an equation introduces.
    fn name_of(&self, index: usize) -> String {
        let flow = self.pending[index].introduces.iter().flatten().next();
        flow.map_or_else(String::new, |flow| self.unit.flow(*flow).name.to_string())
    }

    fn untold(&mut self, index: usize) {
        let flows = self.pending[index].introduces.iter().flatten();
        let Some(flow) = flows
            .map(|id| self.unit.flow(*id))
            .find(|flow| flow.ty.has_unknown())
        else {
            return;
        };
        let finding = Finding::new(
            Code::RPI2007,
            format!("nothing tells the type of `{}`", flow.name),
        )
        .at(flow.span, "its equation only says what it was before")
        .help(format!(
            "declare it: `var {}: ...;` before `let`",
            flow.name
        ));
        self.report(finding);
    }
}

/// The shortest ring of links through an equation; empty if there is none.
fn ring_through(links: &[Link], start: usize) -> Vec<Link> {
    let mut reached: Vec<Link> = Vec::new();
    let mut queue = VecDeque::from([start]);
    while let Some(from) = queue.pop_front() {
        for link in links.iter().filter(|link| link.from == from) {
            if reached.iter().all(|known| known.to != link.to) {
                reached.push(*link);
                queue.push_back(link.to);
            }
        }
    }
    let mut ring: Vec<Link> = Vec::new();
    let mut at = start;
    while let Some(link) = reached.iter().find(|link| link.to == at) {
        ring.push(*link);
        at = link.from;
        if at == start {
            break;
        }
    }
    ring.reverse();
    ring
}
