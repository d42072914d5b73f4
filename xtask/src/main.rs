//! Maintenance tasks of the repository: `cargo xtask TASK`.

mod bless;
mod book;
mod draw;
mod fuzz;
mod lustre;
mod task_error;
mod test_run;
mod tree_sitter;

use std::process::ExitCode;

use task_error::TaskError;

/// Task of `cargo xtask`: name, description for the usage text, and function that carries it out with the arguments.
type Task = (
    &'static str,
    &'static str,
    fn(&[String]) -> Result<(), TaskError>,
);

const TASKS: &[Task] = &[
    (
        "gen",
        "write the files generated from the project's tables",
        generate,
    ),
    (
        "book",
        "build the book with mdBook (installed if necessary) and check the links of its pages",
        book::book,
    ),
    (
        "draw",
        "draw doc comments and diagnostics at random, to judge them: [--seed N] [--comments N] [--diagnostics N]",
        draw::draw,
    ),
    (
        "bless",
        "rewrite the expected outputs of tests: [FILTER]",
        bless::bless,
    ),
    (
        "test",
        "build and run all tests, or the test programs that are named, several at a time: [NAME ...]",
        test_run::test,
    ),
    (
        "fuzz",
        "fuzz an entry (checker, image, importer, recording, trace, cell, parser, lexer): ENTRY [--seconds N]",
        fuzz::fuzz,
    ),
    (
        "tree-sitter",
        "test the grammar for tree-sitter on the programs of the repository",
        tree_sitter::tree_sitter,
    ),
    (
        "lustre-corpus",
        "run external Lustre programs: --programs DIR, with --traces FILE.json, --reject, --kinds FILE.json or none",
        lustre::corpus,
    ),
    (
        "soak",
        "run long tests: random programs, a million steps of the core and its model, a million takeovers of two arms, an hour of misbehaving clients, a day of blending",
        soak,
    ),
];

/// Number of random histories (sequences of up to 120 steps) of the core in the long test. Together they are more than
/// a million steps.
const HISTORIES: &str = "20000";

/// Number of random programs in the long test, for each property of the language.
const PROGRAMS: &str = "10000";

/// Number of random takeovers of two arms in the long test.
const TAKEOVERS: &str = "1000000";

/// Duration of the long test with misbehaving clients: one hour, in seconds.
const HOUR: &str = "3600";

/// Simulated time of the long test of blending: one day.
const DAY: &str = "86400s";

fn main() -> ExitCode {
    let mut args = std::env::args().skip(1);
    let wanted = args.next().unwrap_or_default();
    let Some((_, _, run)) = TASKS.iter().find(|(name, _, _)| *name == wanted) else {
        eprintln!("usage: cargo xtask TASK");
        for (name, what, _) in TASKS {
            eprintln!("  {name:<14} {what}");
        }
        return ExitCode::from(2);
    };
    match run(&args.collect::<Vec<_>>()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(reason) => {
            eprintln!("{reason}");
            ExitCode::FAILURE
        }
    }
}

fn generate(_: &[String]) -> Result<(), TaskError> {
    for file in xtask::generated().iter().filter(|file| !file.is_current()) {
        file.write()
            .map_err(|error| format!("{}: {error}", file.path))?;
        println!("{}", file.path);
    }
    Ok(())
}

/// Carries out `cargo xtask soak`: runs tests with much larger parameters than in the test suite. These are random
/// programs, the core and its model, a million takeovers of two arms, all runs of the jobs, an hour of misbehaving clients,
/// and a day of blending.
fn soak(_: &[String]) -> Result<(), TaskError> {
    cargo_test(
        &["-p", "rpi-reference", "--test", "properties"],
        ("RPI_PROGRAMS", PROGRAMS),
    )?;
    cargo_test(
        &["-p", "rpi-core", "--test", "model"],
        ("RPI_HISTORIES", HISTORIES),
    )?;
    cargo_test(
        &["-p", "rpi", "--test", "soak"],
        ("RPI_TAKEOVERS", TAKEOVERS),
    )?;
    cargo_test(&["-p", "rpi", "--test", "jobs"], ("RPI_JOBS", "all"))?;
    cargo_test(&["-p", "rpi-serve", "--test", "chaos"], ("RPI_CHAOS", HOUR))?;
    cargo_test(&["-p", "rpi", "--test", "endless"], ("RPI_ENDLESS", DAY))
}

fn cargo_test(which: &[&str], (name, value): (&str, &str)) -> Result<(), TaskError> {
    let status = std::process::Command::new(env!("CARGO"))
        .args(["test", "--release"])
        .args(which)
        .args(["--", "--nocapture"])
        .env(name, value)
        .status()
        .map_err(|error| format!("cargo: {error}"))?;
    match status.success() {
        true => Ok(()),
        false => Err(format!("{} with {name}={value} failed", which.join(" ")).into()),
    }
}
