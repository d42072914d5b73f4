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
pub(super) struct Allowance {
    left: usize,
    /// Units whose text has been counted.
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

/// Adds the text of a unit to the budget, the first time the unit is expanded.
pub(super) fn credit_text(elab: &mut Elab<'_>, id: UnitId) {
    if elab.budget.paid.insert(id) {
        elab.budget.left += PER_BYTE * length(&elab.units[id.0 as usize]);
    }
}

/// Returns whether one more call can be expanded. Reports the first excess.
pub(super) fn charge_call(elab: &mut Elab<'_>, span: Span) -> bool {
    charge(elab, 1, span)
}

/// Returns whether one more node of this name can be added. Reports the first excess.
pub(super) fn charge_node(elab: &mut Elab<'_>, name: &str, span: Span) -> bool {
    charge(elab, 1 + name.len() / LETTERS, span)
}

/// Returns whether a value with this many leaves can be built. Reports the first excess.
pub(super) fn charge_leaves(elab: &mut Elab<'_>, leaves: usize, span: Span) -> bool {
    charge(elab, leaves / LEAVES, span)
}

fn charge(elab: &mut Elab<'_>, cost: usize, span: Span) -> bool {
    let was_used_up = elab.budget.is_used_up;
    let may = elab.budget.spend(cost);
    if !may && !was_used_up {
        report_too_large(elab, span);
    }
    may
}

fn report_too_large(elab: &mut Elab<'_>, span: Span) {
    let message = "program is too large after all calls are expanded";
    if elab.mode == crate::elab::Mode::Constant {
        elab.fail(NotConstant::Fault(span, message.to_owned()));
        return;
    }
    let finding = Finding::new(Code::RPI1011, message).at(span, "the limit is exceeded here");
    elab.findings.push(finding.help("each call and each array element is a separate copy: name values that are used twice, or shorten arrays"));
    elab.fail(NotConstant::Faulty);
}

/// Returns the total length of a unit's equations in bytes.
fn length(unit: &Unit) -> usize {
    let equations = unit.blocks.iter().flat_map(|block| &block.equations);
    let lengths = equations.map(|equation| (equation.span.end - equation.span.start) as usize);
    lengths.sum()
}
