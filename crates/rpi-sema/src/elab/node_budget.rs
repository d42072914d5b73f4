//! Size limit for a net or a constant. A short program can expand to a huge net, and each primitive costs about a
//! kilobyte at compile time.
//!
//! Counted are expanded calls, nodes with their names, and leaves of values. The text of each unit raises the limit
//! once per net, however often the unit is called.

use crate::elab::{Elaborator, NotConstantError};
use crate::hash::FastSet;
use crate::typed::{Unit, UnitId};
use rpi_diag::{Code, Diagnostic, Span};

/// Number of nodes that every net may have, in addition to those that the length of its text allows.
const BASE_BUDGET: usize = 200_000;

/// Number of net nodes allowed for each byte in the text of a program's equations.
const NODES_PER_BYTE: usize = 2;

/// Number of leaves (scalar parts) of a value that cost as much of the budget as one node.
const LEAVES_PER_NODE: usize = 8;

/// Number of bytes in a node's name that cost as much of the budget as one node.
const NAME_BYTES_PER_NODE: usize = 256;

/// Number of nodes that may still be added to a net, or used for evaluating a constant.
pub(super) struct NodeBudget {
    remaining: usize,
    /// Units whose text length has been added to the budget.
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

/// Adds nodes for the length of a unit's equations to the budget, the first time that the unit is inlined.
pub(super) fn credit_text(elab: &mut Elaborator<'_>, id: UnitId) {
    if elab.budget.counted_units.insert(id) {
        elab.budget.remaining += NODES_PER_BYTE * length(&elab.units[id.0 as usize]);
    }
}

/// Subtracts one call from the budget and returns whether it can be inlined. Reports the first excess.
pub(super) fn charge_call(elab: &mut Elaborator<'_>, span: Span) -> bool {
    charge(elab, 1, span)
}

/// Subtracts one net node with this name from the budget and returns whether it can be added. Reports the first excess.
pub(super) fn charge_node(elab: &mut Elaborator<'_>, name: &str, span: Span) -> bool {
    charge(elab, 1 + name.len() / NAME_BYTES_PER_NODE, span)
}

/// Subtracts a value with this many leaves (scalar parts) from the budget and returns whether it can be built. Reports
/// the first excess.
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
    elab.diagnostics.push(diagnostic.help(size_help(elab)));
    elab.fail(NotConstantError::Reported);
}

/// Returns the advice for a program that is too large: for a recursion over static parameters, to call the node once.
fn size_help(elab: &Elaborator<'_>) -> String {
    // The name of an instance contains its static arguments.
    // The name of an instance contains its static arguments.
    let names = || {
        let calls = elab.inlining.call_stack.iter();
        calls.filter_map(|id| elab.units[id.0 as usize].name.split("<<").next())
    };
    let innermost = names().next_back();
    match innermost.filter(|name| names().filter(|other| other == name).count() > 2) {
        Some(name) => format!(
            "each call of `{name}` is a separate copy, which contains its own calls of `{name}`: call it once in its body, or start with a smaller static argument"
        ),
        None => "each call and each array element is a separate copy: name values that are used twice, or shorten arrays".to_owned(),
    }
}

/// Returns the total length of the equations of a unit in bytes of source text.
fn length(unit: &Unit) -> usize {
    let equations = unit.blocks.iter().flat_map(|block| &block.equations);
    let lengths = equations.map(|equation| (equation.span.end - equation.span.start) as usize);
    lengths.sum()
}
