//! Flows whose types nothing tells, because their equations only say that they are what others of them are.
//!
//! `a = b; b = a` waits for itself, and that is what is reported; `z = pre z` may run, but nothing says of what type.
//! What only follows from such flows is not mentioned.

use super::body::Body;
use super::order::State;
use crate::ty::Ty;
use crate::typed::{Each, ExprId, FlowId, Kind, Optional};
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
    /// Reports flows whose types nothing tells.
    pub(super) fn report_unknown_types(&mut self) {
        let open: Vec<usize> = (0..self.pending.len())
            .filter(|index| self.is_untold(*index))
            .collect();
        if open.is_empty() {
            return;
        }
        let links: Vec<Link> = open.iter().flat_map(|index| self.links(*index)).collect();
        let mut told = vec![false; self.pending.len()];
        for only_now in [true, false] {
            for index in &open {
                if told[*index] {
                    continue;
                }
                let usable =
                    |link: &&Link| (link.now || !only_now) && !told[link.from] && !told[link.to];
                let usable: Vec<Link> = links.iter().filter(usable).copied().collect();
                let ring = ring_through(&usable, *index);
                ring.iter().for_each(|link| told[link.to] = true);
                match (ring.is_empty(), only_now) {
                    (true, _) => {}
                    (false, true) => self.waits_for_itself(&ring),
                    (false, false) => self.untold(*index),
                }
            }
        }
    }

    fn is_untold(&self, index: usize) -> bool {
        let pending = &self.pending[index];
        let is_open = |flow: &FlowId| {
            let flow = self.unit.flow(*flow);
            flow.ty.is_unknown() && flow.optional == Optional::Inferred
        };
        pending.state == State::Guessed && pending.introduces.iter().flatten().any(is_open)
    }

    /// The flows of unknown type that an equation reads.
    fn links(&mut self, index: usize) -> Vec<Link> {
        let mark = self.mark();
        let value = self.value_at(index);
        let mut links = Vec::new();
        let mut open: Vec<(ExprId, bool)> = vec![(value, true)];
        while let Some((id, now)) = open.pop() {
            let expr = self.unit.expr(id);
            let now = now && !matches!(expr.kind, Kind::Each(Each::Pre | Each::Last, _));
            if let Kind::Flow(flow) = expr.kind
                && let Some(from) =
                    self.defined_by[flow.0 as usize].filter(|from| self.is_untold(*from))
            {
                links.push(Link {
                    from,
                    to: index,
                    span: expr.span,
                    now,
                });
            }
            expr.kind.operands(&mut |operand| open.push((operand, now)));
        }
        self.put_back(mark);
        links
    }

    fn waits_for_itself(&mut self, ring: &[Link]) {
        let reads: Vec<Read> = ring
            .iter()
            .map(|link| Read {
                from: self.name_of(link.from),
                to: self.name_of(link.to),
                span: link.span,
            })
            .collect();
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
            .find(|flow| flow.ty == Ty::Unknown)
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
