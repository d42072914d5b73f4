//! Maintenance tasks of the repository: `cargo xtask TASK`.

mod bless;
mod book;
mod draw;
mod fuzz;
mod lustre;

use std::process::ExitCode;

/// Task of `cargo xtask`: name, description, function.
type Task = (
    &'static str,
    &'static str,
    fn(&[String]) -> Result<(), String>,
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
        "fuzz",
        "fuzz an entry (checker, image, importer, parser, lexer): ENTRY [--seconds N]",
        fuzz::fuzz,
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

/// Number of random histories of the core that the long test runs, each of up to 120 steps; together more than a
/// million steps.
const HISTORIES: &str = "20000";

/// Number of random programs for each property of the language.
const PROGRAMS: &str = "10000";

const TAKEOVERS: &str = "1000000";

/// One hour, in seconds.
const HOUR: &str = "3600";

/// One day of the cell's simulated time.
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

fn generate(_: &[String]) -> Result<(), String> {
    for file in xtask::generated().iter().filter(|file| !file.is_current()) {
        file.write()
            .map_err(|error| format!("{}: {error}", file.path))?;
        println!("{}", file.path);
    }
    Ok(())
}

/// Carries out `cargo xtask soak`: runs tests with much larger parameters than in the test suite, namely random
/// programs, the core and its model, a million takeovers of two arms, an hour of misbehaving clients, and a day of
/// blending.
fn soak(_: &[String]) -> Result<(), String> {
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
    cargo_test(&["-p", "rpi-serve", "--test", "chaos"], ("RPI_CHAOS", HOUR))?;
    cargo_test(&["-p", "rpi", "--test", "endless"], ("RPI_ENDLESS", DAY))
}

fn cargo_test(which: &[&str], (name, value): (&str, &str)) -> Result<(), String> {
    let status = std::process::Command::new(env!("CARGO"))
        .args(["test", "--release"])
        .args(which)
        .args(["--", "--nocapture"])
        .env(name, value)
        .status()
        .map_err(|error| format!("cargo: {error}"))?;
    match status.success() {
        true => Ok(()),
        false => Err(format!("{} with {name}={value} failed", which.join(" "))),
    }
}
