//! Operations that can fault at run time: for the summary of the analyses, for editors, and as a warning about operands
//! with state.

use std::collections::BTreeSet;

use rpi_diag::{Code, Diagnostic, SourceMap, Span};
use rpi_net::passes::{Analysis, FaultKind, PossibleFault, possible_faults};
use rpi_sema::elab::LazyOperand;

/// Operation that was not proved free of faults.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct FaultLocation {
    /// Location of the operation.
    pub span: Span,
    /// Cause of the fault, such as an overflow or an index outside of its array.
    pub kind: FaultKind,
    /// Whether the operation is in a branch that is evaluated only in the cycles in which its result is needed.
    pub guarded: bool,
}

impl FaultLocation {
    /// Returns a description of the fault.
    #[must_use]
    pub fn text(&self) -> String {
        match self.guarded {
            true => format!("{}, only where it is needed", self.kind),
            false => self.kind.to_string(),
        }
    }
}

/// Returns the operations of a net that can fault.
pub(crate) fn faults_of_net(analysis: &Analysis) -> Vec<PossibleFault> {
    let schedule = analysis.schedule.as_ref();
    schedule.map_or_else(Vec::new, |schedule| {
        possible_faults(&analysis.net, schedule)
    })
}

/// Returns the locations of the operations, without duplicates, in source order.
pub(crate) fn locations(found: &[PossibleFault]) -> BTreeSet<FaultLocation> {
    let place = |one: &PossibleFault| FaultLocation {
        span: one.span,
        kind: one.kind,
        guarded: one.is_guarded,
    };
    found.iter().map(place).collect()
}

/// Returns the summary of the operations that can fault: their number, and one line per location.
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

/// Returns warnings about operations that can fault in operands that are not always needed but have state, and are
/// therefore evaluated in every cycle. One warning per operation.
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
    Diagnostic::new(Code::RPI3008, message)
        .primary(operand.span, "evaluated in every cycle")
        .secondary(fault.span, format!("can fault: {}", fault.kind))
        .help(
            "apply the condition to its inputs, or run it conditionally with `activate ... every`",
        )
}
