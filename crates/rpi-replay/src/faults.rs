//! Diagnostics for faults in a cycle, with the cause of each fault.

use std::collections::BTreeMap;

use rpi_diag::{Code, Diagnostic, FileId, SourceMap, Span};
use rpi_prims::FaultCode;
use rpi_runtime::run::{CommandEnd, FaultOrigin, Outcome, RunEnd, fault_message};

/// A fault in a cycle: its cause and the diagnostic that reports it.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct ReportedFault {
    /// Cause of the fault, as the core reports it.
    cause: FaultCode,
    /// Cycle of the fault and name of the faulty command: the start of the message.
    place: String,
    diagnostic: Diagnostic,
}

impl ReportedFault {
    /// Reports a fault with its source location and cycle number. `command` is the name of the faulty command if the
    /// message must name it.
    pub(crate) fn new(origin: &FaultOrigin, command: Option<&str>) -> ReportedFault {
        let command = command.map_or_else(String::new, |name| format!(" of `{name}`"));
        let place = format!("cycle {}{command}", origin.cycle);
        let span = origin.text.map(|text| Span {
            file: FileId(text.file),
            start: text.start,
            end: text.end,
        });
        // The suffix after `#` numbers the parts of an expression. It is not part of the flow's name.
        let label = origin.flow.as_deref().map_or_else(String::new, |flow| {
            let name = flow.split('#').next().unwrap_or(flow);
            format!("for `{name}`")
        });
        let message = format!("{place}: {}", fault_message(origin.code, origin.values));
        let diagnostic = Diagnostic::new(Code::RPI9011, message);
        let diagnostic = diagnostic.primary(span.unwrap_or(Span::NONE), label);
        ReportedFault {
            cause: origin.code,
            place,
            diagnostic: match fault_help(origin.code) {
                Some(help) => diagnostic.help(help),
                None => diagnostic,
            },
        }
    }

    /// Returns true if the fault was raised by an assertion at this location.
    pub(crate) fn is_assertion_at(&self, span: Span) -> bool {
        self.cause == FaultCode::AssertionFailed && self.diagnostic.span() == span
    }

    /// Replaces the description of the fault by the violation of a claim: `sentence` states the violation, and
    /// `violation` has its labels and notes.
    pub(crate) fn explain(&mut self, sentence: &str, violation: Diagnostic) {
        self.diagnostic.message = format!("{}: {sentence}", self.place);
        self.diagnostic.labels = violation.labels;
        self.diagnostic.notes = violation.notes;
        self.diagnostic.help = violation.help;
    }

    /// Returns the diagnostic of the fault.
    pub(crate) fn into_diagnostic(self) -> Diagnostic {
        self.diagnostic
    }
}

/// Returns how a program avoids a fault of its own; `None` for the faults of devices.
fn fault_help(code: FaultCode) -> Option<&'static str> {
    match code {
        FaultCode::IndexOutOfRange => {
            Some("limit the index first: `a[min(max(k, 0), n - 1)]` for an array of `n` elements")
        }
        FaultCode::OutsideSubrange => Some(
            "limit the value first, for example by `min` and `max`, or declare a wider subrange",
        ),
        FaultCode::DivisionByZero => {
            Some("test the divisor first: `if b <> 0 then a div b else 0`")
        }
        FaultCode::IntegerOverflow => Some("limit the operands first, or compute with reals"),
        FaultCode::LossyConversion => {
            Some("limit the real number first, and test for NaN by `x = x`")
        }
        _ => None,
    }
}

/// Reported faults of the commands of a run, by the index of the command in the outcome.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Faults(pub(crate) BTreeMap<usize, ReportedFault>);

impl Faults {
    /// Creates the reports of the faults that ended commands of a run.
    #[must_use]
    pub fn from_outcome(outcome: &Outcome) -> Faults {
        let commands = outcome.commands.iter().enumerate();
        let fault = |(index, command): (usize, &CommandEnd)| match &command.end {
            RunEnd::Fault { origin, .. } => {
                Some((index, ReportedFault::new(origin, Some(&command.name))))
            }
            _ => None,
        };
        Faults(commands.filter_map(fault).collect())
    }

    /// Adds the source locations to the faults in the outcome and returns the diagnostics of the faults with a known
    /// location.
    #[must_use]
    pub fn locate(self, outcome: &mut Outcome, sources: &SourceMap) -> Vec<Diagnostic> {
        let mut diagnostics = Vec::new();
        for (index, fault) in self.0 {
            let diagnostic = fault.into_diagnostic();
            let span = diagnostic.span();
            let command = outcome.commands.get_mut(index).filter(|_| !span.is_none());
            if let Some(RunEnd::Fault { at, .. }) = command.map(|command| &mut command.end) {
                *at = Some(format!(
                    "{}:{}",
                    sources.name(span.file),
                    sources.line_col(span)
                ));
                diagnostics.push(diagnostic);
            }
        }
        diagnostics
    }
}
