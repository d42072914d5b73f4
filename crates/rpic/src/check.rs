//! `rpic check`: reports the diagnostics of programs and nets.

use std::collections::BTreeMap;
use std::io::IsTerminal;
use std::path::Path;

use rpi_diag::{Code, Diagnostic, Format, Severity, SourceMap, Span, Style, render_as};
use rpi_driver::{ClaimPolicy, CompileOptions, Compiled};

use crate::args::CheckArgs;
use crate::fix::fix_file;
use crate::outcome::{CommandResult, Exit, write_output};

/// Carries out `rpic check`: checks each file and prints the diagnostics. The exit status is that of the worst file.
pub(crate) fn check(args: &CheckArgs) -> CommandResult {
    let mut report = DiagnosticSet::default();
    let mut all_read = true;
    for file in &rpi_driver::files_of(&args.files)? {
        let compiled = match args.fix {
            true => fix_file(file, args.explain_analysis),
            false => compile(file, args.explain_analysis),
        };
        let compiled = match compiled {
            Ok(compiled) => compiled,
            // A file that cannot be read does not prevent checking the others.
            Err(error) => {
                rpi_diag::println_stderr!("error: {error}");
                all_read = false;
                continue;
            }
        };
        if args.explain_analysis {
            print_text(args.format, &analysis_summary(&compiled))?;
        }
        report.add(&compiled.sources, compiled.diagnostics);
    }
    print_diagnostics(args.format, &report.diagnostics, &report.sources)?;
    Ok(match (all_read, has_errors(&report.diagnostics)) {
        (false, _) => Exit::BadInput,
        (true, true) => Exit::ErrorsReported,
        (true, false) => Exit::Success,
    })
}

/// Reads and compiles a program or net. `with_summaries` is true if the result shall contain a summary of each
/// analysis.
pub(crate) fn compile(
    path: &Path,
    with_summaries: bool,
) -> Result<Compiled, Box<dyn std::error::Error>> {
    let input = rpi_driver::read(path)?;
    Ok(rpi_driver::compile_with(
        &input,
        CompileOptions {
            // The nets of the analysis; other nets need not be made.
            claims: ClaimPolicy::Report,
            summaries: with_summaries,
            ..CompileOptions::default()
        },
    )?)
}

/// Diagnostics of several files. A diagnostic about a file that several programs use is contained only once.
#[derive(Default)]
pub(crate) struct DiagnosticSet {
    pub(crate) diagnostics: Vec<Diagnostic>,
    pub(crate) sources: SourceMap,
    /// Indices into `diagnostics` by code and location. This map makes the search for duplicates fast, because there
    /// can be a hundred thousand diagnostics.
    index: BTreeMap<(Code, Span), Vec<usize>>,
}

impl DiagnosticSet {
    pub(crate) fn add(&mut self, sources: &SourceMap, diagnostics: Vec<Diagnostic>) {
        let files = self.sources.absorb(sources);
        for diagnostic in diagnostics {
            self.push_unique(diagnostic.renumbered(&files));
        }
    }

    fn push_unique(&mut self, diagnostic: Diagnostic) {
        let here = self
            .index
            .entry((diagnostic.code, diagnostic.span()))
            .or_default();
        if here
            .iter()
            .all(|index| self.diagnostics[*index] != diagnostic)
        {
            here.push(self.diagnostics.len());
            self.diagnostics.push(diagnostic);
        }
    }
}

/// Prints diagnostics in the given format: the human format to standard error, all other formats to standard output.
pub(crate) fn print_diagnostics(
    format: Format,
    diagnostics: &[Diagnostic],
    sources: &SourceMap,
) -> Result<(), Box<dyn std::error::Error>> {
    let style = Style::for_stream(&std::io::stderr());
    let text = render_as(format, diagnostics, sources, style);
    match format {
        Format::Human if diagnostics.is_empty() => {
            if std::io::stderr().is_terminal() {
                rpi_diag::println_stderr!("no errors or warnings");
            }
            Ok(())
        }
        Format::Human => {
            rpi_diag::print_stderr!("{text}");
            Ok(())
        }
        _ => write_output(None, text.as_bytes()),
    }
}

/// Prints a text for people to standard output. If `format` writes a document such as JSON to standard output, the text
/// goes to standard error.
pub(crate) fn print_text(format: Format, text: &str) -> Result<(), Box<dyn std::error::Error>> {
    match format {
        Format::Human => write_output(None, text.as_bytes()),
        _ => {
            rpi_diag::print_stderr!("{text}");
            Ok(())
        }
    }
}

/// Returns a text with the summary of each analysis of each compiled command and node.
fn analysis_summary(compiled: &Compiled) -> String {
    let mut out = String::new();
    for summary in &compiled.summaries {
        out.push_str(&format!("{}\n", summary.name));
        for (pass, line) in &summary.lines {
            out.push_str(&format!("  {pass:<14} {line}\n"));
        }
    }
    out
}

/// Returns whether a list of diagnostics contains an error, and not only warnings and notes.
pub(crate) fn has_errors(diagnostics: &[Diagnostic]) -> bool {
    diagnostics.iter().any(|f| f.severity() == Severity::Error)
}
