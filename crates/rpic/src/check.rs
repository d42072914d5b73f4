//! `rpic check`: reports the diagnostics of programs and nets.

use std::collections::BTreeMap;
use std::io::IsTerminal;
use std::path::Path;

use rpi_diag::{Code, Finding, Format, Severity, SourceMap, Span, Style, render_as};
use rpi_driver::{Asked, Claims, Compiled};

use crate::args::CheckArgs;
use crate::mend::mend;
use crate::outcome::{Exit, Outcome, put};

/// Checks each file. The exit status is that of the worst one.
pub(crate) fn check(args: &CheckArgs) -> Outcome {
    let mut report = Report::default();
    let mut all_read = true;
    for file in &rpi_driver::files_of(&args.files)? {
        let compiled = match args.fix {
            true => mend(file, args.explain_analysis),
            false => compile(file, args.explain_analysis),
        };
        let compiled = match compiled {
            Ok(compiled) => compiled,
            // A file that cannot be read does not prevent checking the others.
            Err(error) => {
                rpi_diag::tell_line!("error: {error}");
                all_read = false;
                continue;
            }
        };
        if args.explain_analysis {
            say(args.format, &explained(&compiled))?;
        }
        report.add(&compiled.sources, compiled.findings);
    }
    show(args.format, &report.findings, &report.sources)?;
    Ok(match (all_read, has_errors(&report.findings)) {
        (false, _) => Exit::BadInput,
        (true, true) => Exit::Found,
        (true, false) => Exit::Good,
    })
}

/// Compiles a file; `told` requests the summary of each analysis.
pub(crate) fn compile(path: &Path, told: bool) -> Result<Compiled, Box<dyn std::error::Error>> {
    let input = rpi_driver::read(path)?;
    Ok(rpi_driver::compile_with(
        &input,
        Asked {
            claims: Claims::Off,
            told,
            ..Asked::default()
        },
    )?)
}

/// Diagnostics of several files, without duplicates from files that several programs use.
#[derive(Default)]
pub(crate) struct Report {
    pub(crate) findings: Vec<Finding>,
    pub(crate) sources: SourceMap,
    /// Indices into `findings` by code and location. The index keeps the search for duplicates fast: there can be a
    /// hundred thousand diagnostics.
    told: BTreeMap<(Code, Span), Vec<usize>>,
}

impl Report {
    pub(crate) fn add(&mut self, sources: &SourceMap, findings: Vec<Finding>) {
        let files = self.sources.absorb(sources);
        for finding in findings {
            self.tell(finding.renumbered(&files));
        }
    }

    fn tell(&mut self, finding: Finding) {
        let here = self.told.entry((finding.code, finding.span())).or_default();
        if here.iter().all(|told| self.findings[*told] != finding) {
            here.push(self.findings.len());
            self.findings.push(finding);
        }
    }
}

/// Prints diagnostics in the given format: the human format to standard error, the others to standard output.
pub(crate) fn show(
    format: Format,
    findings: &[Finding],
    sources: &SourceMap,
) -> Result<(), Box<dyn std::error::Error>> {
    let style = Style::of(&std::io::stderr());
    let text = render_as(format, findings, sources, style);
    match format {
        Format::Human if findings.is_empty() => {
            if std::io::stderr().is_terminal() {
                rpi_diag::tell_line!("no errors or warnings");
            }
            Ok(())
        }
        Format::Human => {
            rpi_diag::tell!("{text}");
            Ok(())
        }
        _ => put(None, text.as_bytes()),
    }
}

/// Writes text for people to standard output, or to standard error if the format needs standard output for its one
/// document.
pub(crate) fn say(format: Format, text: &str) -> Result<(), Box<dyn std::error::Error>> {
    match format {
        Format::Human => put(None, text.as_bytes()),
        _ => {
            rpi_diag::tell!("{text}");
            Ok(())
        }
    }
}

/// Formats the summary of each analysis for each compiled command and node.
fn explained(compiled: &Compiled) -> String {
    let mut out = String::new();
    for told in &compiled.told {
        out.push_str(&format!("{}\n", told.name));
        for (pass, line) in &told.lines {
            out.push_str(&format!("  {pass:<14} {line}\n"));
        }
    }
    out
}

/// Returns whether one of the diagnostics is an error.
pub(crate) fn has_errors(findings: &[Finding]) -> bool {
    findings.iter().any(|f| f.severity() == Severity::Error)
}
