//! What equations give their clocks to: flows, parts of flows, ports of devices.

use super::infer::{Inference, Of};
use super::lift::Lift;
use super::terms::{Term, Terms, of};
use crate::typed::{Equation, ExprId, FlowId, Optional, Place};
use std::ops::Range;

/// Leaves of a value that have one clock.
type Part = (Range<usize>, Term);

impl Inference<'_> {
    pub(super) fn equation(&mut self, equation: &Equation) {
        let parts = match &self.values[equation.value.0 as usize] {
            Of::One(term) => vec![(0..usize::MAX, *term)],
            Of::Each(parts) => in_a_row(parts),
        };
        let mut at = 0;
        for target in &equation.targets {
            let leaves = at..at + target.ty.leaf_count();
            let first = parts.partition_point(|(part, _)| part.end <= leaves.start);
            let parts = parts[first..].iter();
            let parts = parts.take_while(|(part, _)| part.start < leaves.end);
            let parts: Vec<Part> = parts.filter_map(|part| within(part, &leaves)).collect();
            at = leaves.end;
            let wanted = match target.place {
                Place::Flow { flow, .. } => {
                    self.of_several(flow, &parts);
                    of(&self.flows, flow)
                }
                Place::Port { .. } => Terms::BASE,
                Place::Nowhere => continue,
            };
            let optional = self.may_be_absent(&target.place, &parts);
            for (leaves, own) in parts {
                self.give(equation.value, (leaves, own), wanted, optional);
            }
        }
    }

    /// A flow without declaration that takes values of several clocks has that which is common to them.
    fn of_several(&mut self, flow: FlowId, parts: &[Part]) {
        let term = of(&self.flows, flow);
        if parts.len() > 1
            && self.terms.is_open(term)
            && !self.unit.is_lustre
            && let Some(common) = self.common(parts.iter().map(|(_, clock)| *clock))
        {
            self.terms.unify(term, common);
        }
    }

    /// Whether what takes a value takes one that may be absent.
    fn may_be_absent(&self, place: &Place, parts: &[Part]) -> bool {
        match place {
            Place::Flow { flow, .. } => match self.unit.flow(*flow).optional {
                Optional::Declared(optional) => optional,
                Optional::Inferred => parts.len() > 1 || self.of_states[flow.0 as usize],
            },
            Place::Port { .. } => true,
            Place::Nowhere => false,
        }
    }

    /// Leaves of a value go where another clock is wanted, or a faster one is and they may be absent.
    fn give(&mut self, value: ExprId, (leaves, own): Part, wanted: Term, optional: bool) {
        if optional && !self.unit.is_lustre && self.is_slower(own, wanted) {
            let read = wanted;
            self.lift(value, Lift { leaves, own, read });
        } else {
            self.meet(own, wanted, self.unit.expr(value).span);
        }
    }
}

pub(super) fn in_a_row(parts: &[(Term, usize)]) -> Vec<Part> {
    let mut at = 0;
    let mut row = Vec::with_capacity(parts.len());
    for (term, leaves) in parts {
        row.push((at..at + leaves, *term));
        at += leaves;
    }
    row
}

/// What of a part lies among some leaves.
fn within((part, term): &Part, leaves: &Range<usize>) -> Option<Part> {
    let both = part.start.max(leaves.start)..part.end.min(leaves.end);
    (!both.is_empty()).then_some((both, *term))
}
