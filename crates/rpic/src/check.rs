//! `rpic check`: what is wrong with programs and nets.

use std::io::IsTerminal;
use std::path::Path;

use rpi_diag::{Finding, Format, Severity, SourceMap, Style, render_as};
use rpi_diag::{apply, sure_edits};
use rpi_driver::Compiled;

use crate::args::CheckArgs;
use crate::outcome::{Exit, Outcome, put};

/// Checks each file; the worst of them decides.
pub(crate) fn check(args: &CheckArgs) -> Outcome {
    let mut exit = Exit::Good;
    for file in &args.files {
        let mut compiled = rpi_driver::compile(&rpi_driver::read(file)?)?;
        if args.fix && fix(file, &compiled)? {
            compiled = rpi_driver::compile(&rpi_driver::read(file)?)?;
        }
        if args.explain_analysis {
            explain(&compiled)?;
        }
        show(args.format, &compiled.findings, &compiled.sources)?;
        if compiled.has_errors() {
            exit = Exit::Found;
        }
    }
    Ok(exit)
}

/// Prints findings in the form asked for: for people to standard error, for programs to standard output.
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
                eprintln!("nothing found");
            }
            Ok(())
        }
        Format::Human => {
            eprint!("{text}");
            Ok(())
        }
        _ => put(None, text.as_bytes()),
    }
}

/// Applies the sure fixes to the file itself; true if there were any.
fn fix(path: &Path, compiled: &Compiled) -> Result<bool, Box<dyn std::error::Error>> {
    let sources = &compiled.sources;
    let name = path.display().to_string();
    let Some(file) = sources.files().find(|id| sources.name(*id) == name) else {
        return Ok(false);
    };
    let edits = sure_edits(&compiled.findings);
    let here: Vec<_> = edits.iter().filter(|edit| edit.span.file == file).collect();
    if here.is_empty() {
        return Ok(false);
    }
    let text = apply(sources.text(file), here.iter().copied());
    put(Some(path), text.as_bytes())?;
    eprintln!("{name}: {} applied", plural(here.len(), "edit"));
    Ok(true)
}

/// What each analysis established about each thing that can be run.
fn explain(compiled: &Compiled) -> Result<(), Box<dyn std::error::Error>> {
    let mut out = String::new();
    for told in &compiled.told {
        out.push_str(&format!("{}\n", told.name));
        for (pass, line) in &told.lines {
            out.push_str(&format!("  {pass:<14} {line}\n"));
        }
    }
    put(None, out.as_bytes())
}

fn plural(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}

/// True if something was found that is an error.
pub(crate) fn has_errors(findings: &[Finding]) -> bool {
    findings.iter().any(|f| f.severity() == Severity::Error)
}
