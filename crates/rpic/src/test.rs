//! `rpic test`: runs the tests contained in programs.

use std::path::Path;

use rpi_c_target::{CCompiler, ExternalBank};
use rpi_diag::{Code, Diagnostic, Format, SourceMap, Span, with_noun};
use rpi_driver::{ClaimPolicy, CompileOptions, Compiled, Input, Test};
use rpi_image::image::TextRange;
use rpi_net::{Claim, ClaimKind, Termination};
use rpi_replay::testing::{
    ConditionVerdict, TestCase, TestCondition, TestEnd, TestReport, run_observed,
};

use crate::args::TestArgs;
use crate::c_target::TestInC;
use crate::check::{DiagnosticSet, print_diagnostics, print_text};
use crate::coverage::CoverageTotals;
use crate::outcome::{CommandResult, Exit};

/// Carries out `rpic test`: runs the tests and the examples of each file and prints the results. The exit status is 1
/// if a test fails.
pub(crate) fn test(args: &TestArgs) -> CommandResult {
    let (mut exit, mut tally) = (Exit::Success, Tally::default());
    let mut out = TestOutput {
        format: args.format,
        diagnostics: DiagnosticSet::default(),
    };
    for file in &rpi_driver::files_of(&args.files)? {
        let input = rpi_driver::read(file)?;
        let options = CompileOptions {
            // Only the tests run, so that no other nets of the commands are made.
            claims: ClaimPolicy::Report,
            marks: args.coverage,
            ..CompileOptions::default()
        };
        let compiled = rpi_driver::compile_with(&input, options)?;
        out.add_diagnostics(&compiled.diagnostics, &compiled.sources)?;
        if compiled.has_errors() {
            exit = Exit::ErrorsReported;
            continue;
        }
        let seen = run_file(file, args, &compiled, (&mut tally, &mut out))?;
        if args.coverage {
            out.say(&seen.report(&compiled.coverage_points, &compiled.sources))?;
        }
        examples(&input, args, (&mut tally, &mut out))?;
    }
    out.say(&tally.text())?;
    out.finish()?;
    Ok(match tally.failed {
        0 => exit,
        _ => Exit::ErrorsReported,
    })
}

/// Output of a run of tests. The human format is printed at once, all other formats as one document at the end.
struct TestOutput {
    format: Format,
    diagnostics: DiagnosticSet,
}

impl TestOutput {
    fn say(&self, text: &str) -> Result<(), Box<dyn std::error::Error>> {
        print_text(self.format, text)
    }

    fn add_diagnostics(
        &mut self,
        diagnostics: &[Diagnostic],
        sources: &SourceMap,
    ) -> Result<(), Box<dyn std::error::Error>> {
        if self.format == Format::Human {
            return print_diagnostics(self.format, diagnostics, sources);
        }
        self.diagnostics.add(sources, diagnostics.to_vec());
        Ok(())
    }

    fn finish(&self) -> Result<(), Box<dyn std::error::Error>> {
        match self.format {
            Format::Human => Ok(()),
            format => print_diagnostics(
                format,
                &self.diagnostics.diagnostics,
                &self.diagnostics.sources,
            ),
        }
    }
}

/// Numbers of tests that have passed, have failed, and were excluded by `--filter`.
#[derive(Default)]
struct Tally {
    passed: usize,
    failed: usize,
    filtered_out: usize,
}

impl Tally {
    fn text(&self) -> String {
        let left_out = match self.filtered_out {
            0 => String::new(),
            n => format!(", {n} filtered out"),
        };
        format!("{} passed, {} failed{left_out}\n", self.passed, self.failed)
    }
}

/// Compiles the examples in the doc comments of a program, runs their tests, and adds the results to the numbers of
/// tests. An example with an error counts as a failed test.
fn examples(
    input: &Input,
    args: &TestArgs,
    (tally, out): (&mut Tally, &mut TestOutput),
) -> Result<(), Box<dyn std::error::Error>> {
    let (text, path) = (input.text()?, &input.path);
    let mode = rpi_syntax::Dialect::from_path(&path.to_string_lossy());
    for lines in rpi_driver::examples(text, mode) {
        let begin = lines.first().map_or(0, |line| line.start);
        let title = format!(
            "example at line {}",
            1 + text[..begin].matches('\n').count()
        );
        if args.filter.as_ref().is_some_and(|f| !title.contains(f)) {
            tally.filtered_out += 1;
            continue;
        }
        let compiled = rpi_driver::compile_example(input, &lines)?;
        out.add_diagnostics(&compiled.diagnostics, &compiled.sources)?;
        let right = !compiled.has_errors();
        let word = if right { "ok  " } else { "FAIL" };
        out.say(&format!("{word} {}: {title}\n", path.display()))?;
        match right {
            true => tally.passed += 1,
            false => tally.failed += 1,
        }
        run_file(path, args, &compiled, (tally, out))?;
    }
    Ok(())
}

/// Runs the tests of a compiled program and prints their results. Returns their coverage, which is empty unless it was
/// requested.
fn run_file(
    file: &Path,
    args: &TestArgs,
    compiled: &Compiled,
    (tally, out): (&mut Tally, &mut TestOutput),
) -> Result<CoverageTotals, Box<dyn std::error::Error>> {
    let wanted = |test: &Test| args.filter.as_ref().is_none_or(|f| test.title.contains(f));
    let mut seen = CoverageTotals::default();
    for test in &compiled.tests {
        if !wanted(test) {
            tally.filtered_out += 1;
            continue;
        }
        let unlinked = match args.execution.external[..] {
            [] => rpi_driver::unlinked_functions(&test.net),
            _ => Vec::new(),
        };
        if !unlinked.is_empty() {
            out.say(&format!("FAIL {}: {}\n", file.display(), test.title))?;
            out.add_diagnostics(&unlinked, &compiled.sources)?;
            tally.failed += 1;
            continue;
        }
        let (report, difference) = report(test, args)?;
        let passed = report.passed() && difference.is_none();
        let word = if passed { "ok  " } else { "FAIL" };
        let (title, cycles) = (&test.title, with_noun(report.cycles, "cycle"));
        out.say(&format!("{word} {}: {title} ({cycles})\n", file.display()))?;
        if let Some(difference) = difference {
            rpi_diag::println_stderr!("{title}: {difference}");
        }
        match passed {
            true => tally.passed += 1,
            false => tally.failed += 1,
        }
        let mut failures = diagnostics(test, &report);
        rpi_diag::fill_quotes(&mut failures, &compiled.sources);
        out.add_diagnostics(&failures, &compiled.sources)?;
        report.coverage.iter().for_each(|own| seen.add(own));
    }
    Ok(seen)
}

/// Runs a test. Returns its report, and the first difference of the program in C from the core, if it runs there, too.
fn report(test: &Test, args: &TestArgs) -> Result<(TestReport, Option<String>), String> {
    let own: Vec<TestCondition> = own_assertions(test).map(condition).collect();
    let others = test.net.claims.iter().filter(|claim| !is_own(claim));
    let others: Vec<Claim> = others.cloned().collect();
    let image = rpi_driver::lower_for_observation(&test.net, args.period);
    let image = image.map_err(|e| e.to_string())?;
    let in_title = |why: String| format!("{}: {why}", test.title);
    let in_c = TestInC::start(&image, &args.execution);
    let mut in_c = in_c.map_err(|why| in_title(why.to_string()))?;
    let compiler = CCompiler::new(&args.execution.compiler.cc);
    let files = &args.execution.external;
    let bank = ExternalBank::without_devices(&image, files, &compiler);
    let mut bank = bank.map_err(|why| in_title(why.to_string()))?;
    let case = TestCase {
        net: &test.net,
        coverage: args.coverage,
        image,
        conditions: &own,
        claims: &others,
        cycles: args.cycles,
    };
    let report = run_observed(case, &mut bank, &mut |instance| {
        in_c.iter_mut().for_each(|in_c| in_c.cycle(instance));
    });
    let report = report.map_err(|why| in_title(why.to_string()))?;
    if let Some(error) = bank.error().take() {
        return Err(in_title(error.to_string()));
    }
    Ok((report, in_c.and_then(TestInC::difference)))
}

/// Returns whether a claim is an assertion of the test itself, and not of a node that the test calls.
fn is_own(claim: &Claim) -> bool {
    claim.path.is_empty() && claim.kind == ClaimKind::Assert
}

fn own_assertions(test: &Test) -> impl Iterator<Item = &Claim> {
    test.net.claims.iter().filter(|claim| is_own(claim))
}

fn condition(claim: &Claim) -> TestCondition {
    let reads = claim.reads.iter();
    TestCondition {
        key: claim.key.clone(),
        reads: reads
            .map(|read| (read.name.clone(), read.key.clone()))
            .collect(),
    }
}

/// Returns the diagnostics of a test: violated assertions and contracts, and an unexpected end. The list is empty for a
/// test that passed without warnings.
fn diagnostics(test: &Test, report: &TestReport) -> Vec<Diagnostic> {
    let mut diagnostics = report.violations.clone();
    for (expectation, holds) in own_assertions(test).zip(&report.verdicts) {
        let name = expectation.label.as_deref().unwrap_or("the assertion");
        match holds {
            ConditionVerdict::Held => {}
            ConditionVerdict::NeverPresent => diagnostics.push(
                Diagnostic::new(
                    Code::RPI9002,
                    match report.cycles {
                        1 => format!("{name} was absent in the only cycle"),
                        cycles => format!("{name} was absent in all {cycles} cycles"),
                    },
                )
                .primary(expectation.span, "never evaluated")
                .help("make its fragment or state active during the test, or move the assertion out of it"),
            ),
            ConditionVerdict::Violated { cycle, values } => {
                diagnostics.push(failed_assertion(name, *cycle, values, expectation.span));
            }
        }
    }
    diagnostics.extend(
        report
            .end
            .as_ref()
            .and_then(|end| end_diagnostic(test, report, end)),
    );
    diagnostics
}

fn failed_assertion(name: &str, cycle: u64, values: &[(String, String)], span: Span) -> Diagnostic {
    let diagnostic = Diagnostic::new(
        Code::RPI9001,
        format!("{name} does not hold in cycle {cycle}"),
    )
    .primary(span, "false here")
    .help("correct the assertion, or the equations of the flows that it reads");
    let values: Vec<String> = values
        .iter()
        .map(|(name, value)| format!("{name} = {value}"))
        .collect();
    match values.is_empty() {
        true => diagnostic,
        false => diagnostic.note(format!("in this cycle {}", values.join(", "))),
    }
}

fn end_diagnostic(test: &Test, report: &TestReport, end: &TestEnd) -> Option<Diagnostic> {
    let cycle = report.cycles.saturating_sub(1);
    match end {
        TestEnd::Finished => None,
        TestEnd::Unfinished => Some(
            Diagnostic::new(
                Code::RPI9001,
                format!(
                    "the test did not finish in {}",
                    with_noun(report.cycles, "cycle")
                ),
            )
            .primary(finish_span(test), "never true in these cycles")
            .help("correct the condition of this `finish`, or allow more cycles with `--cycles`"),
        ),
        TestEnd::Failed(name) => Some(
            Diagnostic::new(
                Code::RPI9001,
                format!("the test ended with `fail {name}` in cycle {cycle}"),
            )
            .primary(test.span, "this test"),
        ),
        TestEnd::Fault {
            what,
            advice,
            location: place,
        } => {
            let diagnostic = Diagnostic::new(Code::RPI9003, format!("{what}, in cycle {cycle}"));
            let diagnostic = match place {
                Some(place) => diagnostic
                    .primary(span(*place), "fault in this operation")
                    .secondary(test.span, "in this test"),
                None => diagnostic.primary(test.span, "in this test"),
            };
            Some(match advice {
                Some(advice) => diagnostic.help(advice.clone()),
                None => diagnostic,
            })
        }
    }
}

/// Returns the place of the only `finish` of a test; that of its title if there are several results.
fn finish_span(test: &Test) -> Span {
    match &test.net.termination {
        Termination::Results(results) => match &results[..] {
            [only] if !only.origin.span.is_none() => only.origin.span,
            _ => test.span,
        },
        Termination::Ports { .. } => test.span,
    }
}

fn span(range: TextRange) -> Span {
    let file = rpi_diag::FileId(range.file);
    Span {
        file,
        start: range.start,
        end: range.end,
    }
}
