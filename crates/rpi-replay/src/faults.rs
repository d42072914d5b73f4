//! Diagnostics for faults in a cycle, with the cause of each fault.

use std::collections::BTreeMap;

use rpi_diag::{Code, Diagnostic, FileId, Quote, SourceMap, Span};
use rpi_prims::{FaultCode, FaultValues};
use rpi_runtime::run::{CommandEnd, FaultOrigin, Outcome, RunEnd, fault_message};

/// A fault (error at run time) of a command in a cycle, with the diagnostic that reports it.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct ReportedFault {
    /// Kind of the fault, such as a division by zero, as the core reports it.
    cause: FaultCode,
    /// Beginning of the message: number of the cycle and name of the command.
    place: String,
    diagnostic: Diagnostic,
}

impl ReportedFault {
    /// Creates the report of a fault from its location and cycle number. `command` is the name of the faulty command if
    /// the message must name it.
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
            format!("value of `{name}`")
        });
        let message = format!("{place}: {}", fault_message(origin.code, origin.values));
        let diagnostic = Diagnostic::new(Code::RPI9011, message);
        let diagnostic = diagnostic.primary(span.unwrap_or(Span::NONE), label);
        ReportedFault {
            cause: origin.code,
            place,
            diagnostic: match fault_help(origin, span) {
                Some(help) => diagnostic.help(help),
                None => diagnostic,
            },
        }
    }

    /// Returns true if the fault was raised by the assertion at this location in the source.
    pub(crate) fn is_assertion_at(&self, span: Span) -> bool {
        self.cause == FaultCode::AssertionFailed && self.diagnostic.span() == span
    }

    /// Replaces the description of the fault by that of the violated claim (assertion or contract) which raised it:
    /// `sentence` states the violation, and `violation` has its labels and notes.
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

/// Returns advice how a program avoids a fault of its own; `None` for the faults of devices. `span` is the location of
/// the operation with the fault.
fn fault_help(origin: &FaultOrigin, span: Option<Span>) -> Option<String> {
    let text = match (origin.code, origin.values) {
        (FaultCode::IndexOutOfRange, FaultValues::Index { length, .. }) if length > 0 => {
            let last = length - 1;
            return Some(format!(
                "limit the index to the range from 0 to {last}, for example by `min(max(..., 0), {last})`"
            ));
        }
        (FaultCode::IndexOutOfRange, _) => "limit the index to the size of the array",
        (FaultCode::OutsideSubrange, _) => {
            "limit the value first, for example by `min` and `max`, give other inputs, or declare a wider subrange"
        }
        (FaultCode::DivisionByZero, _) => {
            let quotient = span.map_or("...".to_owned(), |span| Quote::text(span).to_string());
            return Some(format!(
                "test the divisor first: `if ... <> 0 then {quotient} else 0`"
            ));
        }
        (FaultCode::IntegerOverflow, _) => "limit the operands first, or compute with reals",
        (FaultCode::LossyConversion, _) => {
            "limit the real number first; NaN is the only number that differs from itself"
        }
        _ => return None,
    };
    Some(text.to_owned())
}

/// Reported faults of the commands of a run, by the index of the command in the outcome.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Faults(pub(crate) BTreeMap<usize, ReportedFault>);

impl Faults {
    /// Creates the reports of the faults that ended commands of the run with this outcome.
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
        rpi_diag::fill_quotes(&mut diagnostics, sources);
        diagnostics
    }
}
