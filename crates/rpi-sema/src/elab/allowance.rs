//! Size limit for a net or a constant. A short program can expand to a huge net, and each primitive costs about a
//! kilobyte at compile time.
//!
//! Counted are expanded calls, nodes with their names, and leaves of values. The text of each unit raises the limit
//! once per net, however often the unit is called.

use crate::elab::{Elab, NotConstant};
use crate::hash::Set;
use crate::typed::{Unit, UnitId};
use rpi_diag::{Code, Finding, Span};

/// Nodes allowed for every net, in addition to what its text allows.
const FREE: usize = 200_000;

/// Nodes allowed for each byte of an equation.
const PER_BYTE: usize = 2;

/// Number of leaves of a value that cost as much as one node.
const LEAVES: usize = 8;

/// Number of bytes of a node's name that cost as much as the node.
const LETTERS: usize = 256;

/// Remaining budget of a net or constant.
pub(in crate::elab) struct Allowance {
    left: usize,
    /// Units whose text has been counted.
    paid: Set<UnitId>,
    pub(in crate::elab) is_used_up: bool,
}

impl Allowance {
    pub(in crate::elab) fn new() -> Allowance {
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
    /// Adds the text of a unit to the budget, the first time the unit is expanded.
    pub(in crate::elab) fn pay_for(&mut self, id: UnitId) {
        if self.allowance.paid.insert(id) {
            self.allowance.left += PER_BYTE * length(&self.units[id.0 as usize]);
        }
    }

    /// Returns whether one more call can be expanded. Reports the first excess.
    pub(in crate::elab) fn may_call(&mut self, span: Span) -> bool {
        self.may_spend(1, span)
    }

    /// Returns whether one more node of this name can be added. Reports the first excess.
    pub(in crate::elab) fn may_add(&mut self, name: &str, span: Span) -> bool {
        self.may_spend(1 + name.len() / LETTERS, span)
    }

    /// Returns whether a value with this many leaves can be built. Reports the first excess.
    pub(in crate::elab) fn may_hold(&mut self, leaves: usize, span: Span) -> bool {
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
        let message = "program is too large after all calls are expanded";
        if self.mode == crate::elab::Mode::Constant {
            self.fail(NotConstant::Fault(span, message.to_owned()));
            return;
        }
        let finding = Finding::new(Code::RPI1011, message).at(span, "the limit is exceeded here");
        self.findings.push(finding.help("each call and each array element is a separate copy: name values that are used twice, or shorten arrays"));
        self.fail(NotConstant::Faulty);
    }
}

/// Returns the total length of a unit's equations in bytes.
fn length(unit: &Unit) -> usize {
    let equations = unit.blocks.iter().flat_map(|block| &block.equations);
    let lengths = equations.map(|equation| (equation.span.end - equation.span.start) as usize);
    lengths.sum()
}
