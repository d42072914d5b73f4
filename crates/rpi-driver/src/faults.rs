//! What can still fault in a running command: for the analyses in words, for an editor, and as a warning where the operand of
//! a choice has state.

use std::collections::BTreeSet;

use rpi_diag::{Code, Finding, SourceMap, Span};
use rpi_net::passes::{Analysis, CanFault, FaultKind, can_fault};
use rpi_sema::elab::Operand;

/// An operation that nothing proves never to fault.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct FaultPlace {
    /// Its place.
    pub span: Span,
    /// How it can fault.
    pub kind: FaultKind,
    /// Whether it is computed only in the cycles in which its result is needed.
    pub guarded: bool,
}

impl FaultPlace {
    /// How it can fault, in words.
    #[must_use]
    pub fn text(&self) -> String {
        match self.guarded {
            true => format!("{}, only where it is needed", self.kind),
            false => self.kind.to_string(),
        }
    }
}

/// What can fault in a net.
pub(crate) fn of(analysis: &Analysis) -> Vec<CanFault> {
    let schedule = analysis.schedule.as_ref();
    schedule.map_or_else(Vec::new, |schedule| can_fault(&analysis.net, schedule))
}

/// The places of what can fault, each once, in the order of the text.
pub(crate) fn places(found: &[CanFault]) -> BTreeSet<FaultPlace> {
    let place = |one: &CanFault| FaultPlace {
        span: one.span,
        kind: one.kind,
        guarded: one.guarded,
    };
    found.iter().map(place).collect()
}

/// What can fault, in words: a line for each place.
pub(crate) fn lines(found: &[CanFault], sources: &SourceMap) -> Vec<(&'static str, String)> {
    let places = places(found);
    let count = match places.len() {
        0 => "no operation can fault".to_owned(),
        count => format!("{} can fault", rpi_diag::counted(count, "operation")),
    };
    let place = |place: &FaultPlace| {
        let at = sources.line_col(place.span);
        let name = sources.name(place.span.file);
        let text = format!("{name}:{}:{}: {}", at.line, at.col, place.text());
        ("faults", text)
    };
    let all = places.iter().map(place);
    std::iter::once(("faults", count)).chain(all).collect()
}

/// Operands that are not always needed, have state and can fault: one warning for each place that can.
pub(crate) fn of_operands(operands: &[Operand], found: &[CanFault]) -> Vec<Finding> {
    let mut warned = BTreeSet::new();
    let mut findings = Vec::new();
    for operand in operands {
        let first = found.partition_point(|one| one.node.0 < operand.nodes.start);
        let inside = found[first..].iter();
        let inside = inside.take_while(|one| one.node.0 < operand.nodes.end);
        // One that is told of an inner operand is not told of the outer one again.
        for one in inside.filter(|one| !one.guarded) {
            if warned.insert(one.node) {
                findings.push(finding(operand, one));
            }
        }
    }
    findings
}

fn finding(operand: &Operand, fault: &CanFault) -> Finding {
    let message = "this operand has state, so it also runs and can fault where it is not needed";
    Finding::new(Code::RPI3008, message)
        .at(operand.span, "runs in every cycle")
        .also(fault.span, format!("can fault: {}", fault.kind))
        .help("choose what it reads instead of what it gives; or run it by `activate ... every`")
}
