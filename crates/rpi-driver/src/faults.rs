//! Operations that can fault at run time: for the summary of the analyses, for editors, and as a warning about operands
//! with state.

use std::collections::BTreeSet;

use rpi_diag::{Code, Diagnostic, Quote, SourceMap, Span};
use rpi_net::Net;
use rpi_net::passes::{Analysis, FaultKind, PossibleFault, possible_faults, unguarded_operations};
use rpi_sema::elab::LazyOperand;

/// Location of an operation that can fault at run time, because the compiler could not prove the contrary.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct FaultLocation {
    /// Location of the operation in the source.
    pub span: Span,
    /// Kind of fault, such as an overflow or an index outside of its array.
    pub kind: FaultKind,
    /// Whether the operation is in a branch that is evaluated only in the cycles in which the result of the branch is
    /// needed.
    pub guarded: bool,
}

impl FaultLocation {
    /// Returns a description of the possible fault.
    #[must_use]
    pub fn text(&self) -> String {
        match self.guarded {
            true => format!("{}, only where it is needed", self.kind),
            false => self.kind.to_string(),
        }
    }
}

/// Returns the operations of a net that can fault at run time; an empty list if the net has no order of evaluation.
pub(crate) fn faults_of_net(analysis: &Analysis) -> Vec<PossibleFault> {
    let schedule = analysis.schedule.as_ref();
    schedule.map_or_else(Vec::new, |schedule| {
        possible_faults(&analysis.net, schedule)
    })
}

/// Returns the source locations of operations that can fault, without duplicates, in source order.
pub(crate) fn locations(found: &[PossibleFault]) -> BTreeSet<FaultLocation> {
    let place = |one: &PossibleFault| FaultLocation {
        span: one.span,
        kind: one.kind,
        guarded: one.is_guarded,
    };
    found.iter().map(place).collect()
}

/// Returns lines of a summary about operations that can fault: their number, and one line per location. Each line has
/// the name of the analysis and a text.
pub(crate) fn lines(found: &[PossibleFault], sources: &SourceMap) -> Vec<(&'static str, String)> {
    let places = locations(found);
    let count = match places.len() {
        0 => "no operation can fault".to_owned(),
        count => format!("{} can fault", rpi_diag::with_noun(count, "operation")),
    };
    let place = |place: &FaultLocation| {
        let at = sources.line_col(place.span);
        let name = sources.name(place.span.file);
        let text = format!("{name}:{}:{}: {}", at.line, at.col, place.text());
        ("faults", text)
    };
    let all = places.iter().map(place);
    std::iter::once(("faults", count)).chain(all).collect()
}

/// Returns whether [`stateful_operand_warnings`] may warn about these operands. This needs no analysis of the net's values.
pub(crate) fn may_warn(operands: &[LazyOperand], net: &Net) -> bool {
    if operands.is_empty() {
        return false;
    }
    let operations = unguarded_operations(net);
    operands.iter().any(|operand| {
        let first = operations.partition_point(|node| node.0 < operand.nodes.start);
        operations
            .get(first)
            .is_some_and(|node| node.0 < operand.nodes.end)
    })
}

/// Returns warnings about operations that can fault in operands with state. The operators do not always need these
/// operands, but must evaluate them in every cycle because of their state. There is one warning per operation.
pub(crate) fn stateful_operand_warnings(
    operands: &[LazyOperand],
    found: &[PossibleFault],
) -> Vec<Diagnostic> {
    let mut warned = BTreeSet::new();
    let mut diagnostics = Vec::new();
    for operand in operands {
        let first = found.partition_point(|one| one.node.0 < operand.nodes.start);
        let inside = found[first..].iter();
        let inside = inside.take_while(|one| one.node.0 < operand.nodes.end);
        // An operation in nested operands is reported for the inner operand only.
        for one in inside.filter(|one| !one.is_guarded) {
            if warned.insert(one.node) {
                diagnostics.push(diagnostic(operand, one));
            }
        }
    }
    diagnostics
}

fn diagnostic(operand: &LazyOperand, fault: &PossibleFault) -> Diagnostic {
    let message =
        "this operand has state, so it is evaluated and can fault even when it is not needed";
    let help = match operand.span.contains(fault.span) {
        true => format!(
            "write the condition around the operation: `if ... then {} else ...`",
            Quote::text(fault.span)
        ),
        false => "write a condition around the operation in the node, or run the node only when it is needed: `(activate ... every ... initial default ...)(...)`".to_owned(),
    };
    Diagnostic::new(Code::RPI3008, message)
        .primary(operand.span, "evaluated in every cycle")
        .secondary(fault.span, format!("can fault: {}", fault.kind))
        .help(help)
}
