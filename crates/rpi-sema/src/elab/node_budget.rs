//! Size limit for a net or a constant. A short program can expand to a huge net, and each primitive costs about a
//! kilobyte at compile time.
//!
//! Counted are expanded calls, nodes with their names, and leaves of values. The text of each unit raises the limit
//! once per net, however often the unit is called.

use crate::elab::{Elaborator, NotConstantError};
use crate::hash::FastSet;
use crate::typed::{Unit, UnitId};
use rpi_diag::{Code, Diagnostic, Span};

/// Nodes allowed for every net, in addition to what its text allows.
const BASE_BUDGET: usize = 200_000;

/// Nodes allowed for each byte of an equation.
const NODES_PER_BYTE: usize = 2;

/// Number of leaves of a value that count as one node in the budget.
const LEAVES_PER_NODE: usize = 8;

/// Number of bytes of a node's name that count as one node in the budget.
const NAME_BYTES_PER_NODE: usize = 256;

/// Remaining size budget of a net or constant, in nodes.
pub(super) struct NodeBudget {
    remaining: usize,
    /// Units whose text has been added to the budget.
    counted_units: FastSet<UnitId>,
    pub(super) is_exhausted: bool,
}

impl NodeBudget {
    pub(super) fn new() -> NodeBudget {
        NodeBudget {
            remaining: BASE_BUDGET,
            counted_units: FastSet::default(),
            is_exhausted: false,
        }
    }

    fn spend(&mut self, cost: usize) -> bool {
        self.is_exhausted |= self.remaining < cost;
        self.remaining = self.remaining.saturating_sub(cost);
        !self.is_exhausted
    }
}

/// Adds the text of a unit to the budget, the first time the unit is expanded.
pub(super) fn credit_text(elab: &mut Elaborator<'_>, id: UnitId) {
    if elab.budget.counted_units.insert(id) {
        elab.budget.remaining += NODES_PER_BYTE * length(&elab.units[id.0 as usize]);
    }
}

/// Returns whether one more call can be expanded. Reports the first excess.
pub(super) fn charge_call(elab: &mut Elaborator<'_>, span: Span) -> bool {
    charge(elab, 1, span)
}

/// Returns whether one more node of this name can be added. Reports the first excess.
pub(super) fn charge_node(elab: &mut Elaborator<'_>, name: &str, span: Span) -> bool {
    charge(elab, 1 + name.len() / NAME_BYTES_PER_NODE, span)
}

/// Returns whether a value with this many leaves can be built. Reports the first excess.
pub(super) fn charge_leaves(elab: &mut Elaborator<'_>, leaves: usize, span: Span) -> bool {
    charge(elab, leaves / LEAVES_PER_NODE, span)
}

fn charge(elab: &mut Elaborator<'_>, cost: usize, span: Span) -> bool {
    let was_used_up = elab.budget.is_exhausted;
    let may = elab.budget.spend(cost);
    if !may && !was_used_up {
        report_too_large(elab, span);
    }
    may
}

fn report_too_large(elab: &mut Elaborator<'_>, span: Span) {
    let message = "program is too large after all calls are expanded";
    if elab.mode == crate::elab::ElabMode::Constant {
        elab.fail(NotConstantError::Fault(span, message.to_owned()));
        return;
    }
    let diagnostic =
        Diagnostic::new(Code::RPI1011, message).primary(span, "the limit is exceeded here");
    elab.diagnostics.push(diagnostic.help("each call and each array element is a separate copy: name values that are used twice, or shorten arrays"));
    elab.fail(NotConstantError::Reported);
}

/// Returns the total length of the equations of a unit in bytes.
fn length(unit: &Unit) -> usize {
    let equations = unit.blocks.iter().flat_map(|block| &block.equations);
    let lengths = equations.map(|equation| (equation.span.end - equation.span.start) as usize);
    lengths.sum()
}
