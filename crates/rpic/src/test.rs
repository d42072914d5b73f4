//! `rpic test`: runs the tests contained in programs.

use std::path::Path;

use rpi_diag::{Code, Finding, Format, SourceMap, Span, counted};
use rpi_driver::{Asked, Claims, Compiled, Input, Test};
use rpi_image::image::TextRange;
use rpi_net::{Claim, ClaimKind};
use rpi_replay::testing::{Case, Condition, Ended, Holds, Report, run};

use crate::args::TestArgs;
use crate::check::{Report as Told, say, show};
use crate::coverage::Seen;
use crate::outcome::{Exit, Outcome};

/// Runs the tests of each file. The exit status is 1 if a test fails.
pub(crate) fn test(args: &TestArgs) -> Outcome {
    let (mut exit, mut tally) = (Exit::Good, Tally::default());
    let mut out = Out {
        format: args.format,
        told: Told::default(),
    };
    for file in &rpi_driver::files_of(&args.files)? {
        let input = rpi_driver::read(file)?;
        let asked = Asked {
            claims: Claims::Off,
            marks: args.coverage,
            ..Asked::default()
        };
        let compiled = rpi_driver::compile_with(&input, asked)?;
        out.findings(&compiled.findings, &compiled.sources)?;
        if compiled.has_errors() {
            exit = Exit::Found;
            continue;
        }
        let seen = one_file(file, args, &compiled, (&mut tally, &mut out))?;
        if args.coverage {
            out.say(&seen.text(&compiled.marks, &compiled.sources))?;
        }
        examples(&input, args, (&mut tally, &mut out))?;
    }
    out.say(&tally.text())?;
    out.end()?;
    Ok(match tally.failed {
        0 => exit,
        _ => Exit::Found,
    })
}

/// Output of the test run. The human format is printed immediately, the others as one document at the end.
struct Out {
    format: Format,
    told: Told,
}

impl Out {
    fn say(&self, text: &str) -> Result<(), Box<dyn std::error::Error>> {
        say(self.format, text)
    }

    fn findings(
        &mut self,
        findings: &[Finding],
        sources: &SourceMap,
    ) -> Result<(), Box<dyn std::error::Error>> {
        if self.format == Format::Human {
            return show(self.format, findings, sources);
        }
        self.told.add(sources, findings.to_vec());
        Ok(())
    }

    fn end(&self) -> Result<(), Box<dyn std::error::Error>> {
        match self.format {
            Format::Human => Ok(()),
            format => show(format, &self.told.findings, &self.told.sources),
        }
    }
}

/// Number of tests by result.
#[derive(Default)]
struct Tally {
    passed: usize,
    failed: usize,
    left_out: usize,
}

impl Tally {
    fn text(&self) -> String {
        let left_out = match self.left_out {
            0 => String::new(),
            n => format!(", {n} filtered out"),
        };
        format!("{} passed, {} failed{left_out}\n", self.passed, self.failed)
    }
}

/// Compiles and runs the examples in the doc comments of a program.
fn examples(
    input: &Input,
    args: &TestArgs,
    (tally, out): (&mut Tally, &mut Out),
) -> Result<(), Box<dyn std::error::Error>> {
    let (text, path) = (input.text()?, &input.path);
    let mode = rpi_syntax::Mode::of_path(&path.to_string_lossy());
    for lines in rpi_driver::examples(text, mode) {
        let begin = lines.first().map_or(0, |line| line.start);
        let title = format!(
            "example at line {}",
            1 + text[..begin].matches('\n').count()
        );
        if args.filter.as_ref().is_some_and(|f| !title.contains(f)) {
            tally.left_out += 1;
            continue;
        }
        let compiled = rpi_driver::compile_example(input, &lines)?;
        out.findings(&compiled.findings, &compiled.sources)?;
        let right = !compiled.has_errors();
        let word = if right { "ok  " } else { "FAIL" };
        out.say(&format!("{word} {}: {title}\n", path.display()))?;
        match right {
            true => tally.passed += 1,
            false => tally.failed += 1,
        }
        one_file(path, args, &compiled, (tally, out))?;
    }
    Ok(())
}

/// Runs the tests of a program and returns their coverage, if it was recorded.
fn one_file(
    file: &Path,
    args: &TestArgs,
    compiled: &Compiled,
    (tally, out): (&mut Tally, &mut Out),
) -> Result<Seen, Box<dyn std::error::Error>> {
    let wanted = |test: &Test| args.filter.as_ref().is_none_or(|f| test.title.contains(f));
    let mut seen = Seen::default();
    for test in &compiled.tests {
        if !wanted(test) {
            tally.left_out += 1;
            continue;
        }
        let report = report(test, args)?;
        let passed = report.passed();
        let word = if passed { "ok  " } else { "FAIL" };
        let (title, cycles) = (&test.title, counted(report.cycles, "cycle"));
        out.say(&format!("{word} {}: {title} ({cycles})\n", file.display()))?;
        match passed {
            true => tally.passed += 1,
            false => tally.failed += 1,
        }
        out.findings(&findings(test, &report), &compiled.sources)?;
        report.coverage.iter().for_each(|own| seen.add(own));
    }
    Ok(seen)
}

fn report(test: &Test, args: &TestArgs) -> Result<Report, String> {
    let own: Vec<Condition> = own(test).map(condition).collect();
    let others = test.net.claims.iter().filter(|claim| !is_own(claim));
    let others: Vec<Claim> = others.cloned().collect();
    run(Case {
        net: &test.net,
        coverage: args.coverage,
        image: rpi_driver::lower_to_look(&test.net, args.period)?,
        conditions: &own,
        claims: &others,
        cycles: args.cycles,
    })
    .map_err(|why| format!("{}: {why}", test.title))
}

/// Returns whether a claim is an assertion of the test itself, not of a called unit.
fn is_own(claim: &Claim) -> bool {
    claim.path.is_empty() && claim.kind == ClaimKind::Assert
}

fn own(test: &Test) -> impl Iterator<Item = &Claim> {
    test.net.claims.iter().filter(|claim| is_own(claim))
}

fn condition(claim: &Claim) -> Condition {
    let reads = claim.reads.iter();
    Condition {
        key: claim.key.clone(),
        reads: reads
            .map(|read| (read.name.clone(), read.key.clone()))
            .collect(),
    }
}

/// Returns the diagnostics of a test.
fn findings(test: &Test, report: &Report) -> Vec<Finding> {
    let mut findings = report.broken.clone();
    for (expectation, holds) in own(test).zip(&report.verdicts) {
        let name = expectation.label.as_deref().unwrap_or("the assertion");
        match holds {
            Holds::Always => {}
            Holds::Never => findings.push(
                Finding::new(
                    Code::RPI9002,
                    match report.cycles {
                        1 => format!("{name} was absent in the only cycle"),
                        cycles => format!("{name} was absent in all {cycles} cycles"),
                    },
                )
                .at(expectation.span, "never evaluated"),
            ),
            Holds::Broken { cycle, values } => {
                findings.push(broken(name, *cycle, values, expectation.span));
            }
        }
    }
    findings.extend(report.end.as_ref().and_then(|end| ended(test, report, end)));
    findings
}

fn broken(name: &str, cycle: u64, values: &[(String, String)], span: Span) -> Finding {
    let finding = Finding::new(
        Code::RPI9001,
        format!("{name} does not hold in cycle {cycle}"),
    )
    .at(span, "false here");
    let values: Vec<String> = values
        .iter()
        .map(|(name, value)| format!("{name} = {value}"))
        .collect();
    match values.is_empty() {
        true => finding,
        false => finding.note(format!("in this cycle {}", values.join(", "))),
    }
}

fn ended(test: &Test, report: &Report, end: &Ended) -> Option<Finding> {
    let cycle = report.cycles.saturating_sub(1);
    match end {
        Ended::Finished => None,
        Ended::Unfinished => Some(
            Finding::new(
                Code::RPI9001,
                format!(
                    "the test did not finish in {}",
                    counted(report.cycles, "cycle")
                ),
            )
            .at(test.span, "this test has a `finish`")
            .help("correct its condition, or allow more cycles with `--cycles`"),
        ),
        Ended::Failed(name) => Some(
            Finding::new(
                Code::RPI9001,
                format!("the test ended with `fail {name}` in cycle {cycle}"),
            )
            .at(test.span, "this test"),
        ),
        Ended::Fault { what, place } => {
            let finding = Finding::new(Code::RPI9003, format!("{what}, in cycle {cycle}"));
            Some(match place {
                Some(place) => finding
                    .at(span(*place), "here")
                    .also(test.span, "in this test"),
                None => finding.at(test.span, "in this test"),
            })
        }
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
