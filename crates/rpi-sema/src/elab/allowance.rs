//! How much a net or constant may ask for: a short text can stand for very much, and each primitive costs about a
//! kilobyte before it runs.
//!
//! What counts: calls that are written out, nodes with their names, leaves of values. Text pays for what it stands for,
//! once in a net however often it is called.

use super::{Elab, NotConstant};
use crate::hash::Set;
use crate::typed::{Unit, UnitId};
use rpi_diag::{Code, Finding, Span};

/// What everybody may ask for.
const FREE: usize = 200_000;

/// What a byte of an equation pays for.
const PER_BYTE: usize = 2;

/// Leaves of values that cost as much as a node.
const LEAVES: usize = 8;

/// Letters of a node's name that cost as much as the node.
const LETTERS: usize = 256;

/// What is left of it.
pub(super) struct Allowance {
    left: usize,
    /// The units whose text has paid.
    paid: Set<UnitId>,
    pub(super) is_used_up: bool,
}

impl Allowance {
    pub(super) fn new() -> Allowance {
        Allowance {
            left: FREE,
            paid: Set::default(),
            is_used_up: false,
        }
    }

    fn spend(&mut self, cost: usize) -> bool {
        self.is_used_up |= self.left < cost;
        self.left = self.left.saturating_sub(cost);
        !self.is_used_up
    }
}

impl Elab<'_> {
    /// Text that is written out for the first time.
    pub(super) fn pay_for(&mut self, id: UnitId) {
        if self.allowance.paid.insert(id) {
            self.allowance.left += PER_BYTE * length(&self.units[id.0 as usize]);
        }
    }

    /// Whether one more call can be written out.
    pub(super) fn may_call(&mut self, span: Span) -> bool {
        self.may_spend(1, span)
    }

    /// Whether there can be one more node of this name.
    pub(super) fn may_add(&mut self, name: &str, span: Span) -> bool {
        self.may_spend(1 + name.len() / LETTERS, span)
    }

    /// Whether there can be a value of so many leaves.
    pub(super) fn may_hold(&mut self, leaves: usize, span: Span) -> bool {
        self.may_spend(leaves / LEAVES, span)
    }

    fn may_spend(&mut self, cost: usize, span: Span) -> bool {
        let was_used_up = self.allowance.is_used_up;
        let may = self.allowance.spend(cost);
        if !may && !was_used_up {
            self.too_much(span);
        }
        may
    }

    fn too_much(&mut self, span: Span) {
        let message = "written out this is too much to work with";
        if self.mode == super::Mode::Constant {
            self.fail(NotConstant::Fault(span, message.to_owned()));
            return;
        }
        let finding = Finding::new(Code::RPI1011, message).at(span, "one more here");
        self.findings.push(finding.help("every call and every element of an array has a copy of its own: give a value that is used twice a name, or make arrays shorter"));
        self.fail(NotConstant::Faulty);
    }
}

/// How many bytes the equations of a unit are long.
fn length(unit: &Unit) -> usize {
    let equations = unit.blocks.iter().flat_map(|block| &block.equations);
    let lengths = equations.map(|equation| (equation.span.end - equation.span.start) as usize);
    lengths.sum()
}
