//! Diagnostics for faults in a cycle.

use std::collections::BTreeMap;

use rpi_diag::{Code, Diagnostic, FileId, SourceMap, Span};
use rpi_runtime::run::{FaultOrigin, Outcome, RunEnd, fault_text};

/// Returns the diagnostic for a fault, with its source location and cycle number. `of` names the faulty command if the
/// message must name it.
pub(crate) fn fault_diagnostic(origin: &FaultOrigin, of: Option<&str>) -> Diagnostic {
    let (what, cycle) = (fault_text(origin.code), origin.cycle);
    let of = of.map_or_else(String::new, |of| format!(" of `{of}`"));
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
    Diagnostic::new(Code::RPI9011, format!("cycle {cycle}{of}: {what}"))
        .primary(span.unwrap_or(Span::NONE), label)
}

/// Diagnostics for the commands of a run that ended with a fault, by the index of the command in the outcome.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Faults(pub(crate) BTreeMap<usize, Diagnostic>);

impl Faults {
    /// Returns the diagnostics for the faults of a run.
    #[must_use]
    pub fn of(outcome: &Outcome) -> Faults {
        let commands = outcome.commands.iter().enumerate();
        let diagnostic =
            |(index, command): (usize, &rpi_runtime::run::CommandEnd)| match &command.end {
                RunEnd::Fault { origin, .. } => {
                    Some((index, fault_diagnostic(origin, Some(&command.name))))
                }
                _ => None,
            };
        Faults(commands.filter_map(diagnostic).collect())
    }

    /// Adds the source locations to the faults in the outcome and returns the diagnostics of the faults with a known
    /// location.
    #[must_use]
    pub fn locate(self, outcome: &mut Outcome, sources: &SourceMap) -> Vec<Diagnostic> {
        let mut found = Vec::new();
        for (index, diagnostic) in self.0 {
            let span = diagnostic.span();
            let command = outcome.commands.get_mut(index).filter(|_| !span.is_none());
            if let Some(RunEnd::Fault { at, .. }) = command.map(|command| &mut command.end) {
                *at = Some(format!(
                    "{}:{}",
                    sources.name(span.file),
                    sources.line_col(span)
                ));
                found.push(diagnostic);
            }
        }
        found
    }
}
