//! `cargo xtask test`: builds all tests of the workspace and runs their programs, several at a time.
//!
//! `cargo test` runs one program after another, and many of ours have one long test, so that a core waits. The programs
//! are the same, with the environment that `cargo test` gives them. Those that mostly wait, for a browser or the clock,
//! run beside the others, as the examples in the documentation do.

use std::collections::VecDeque;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};
use std::sync::Mutex;
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::task_error::TaskError;

/// Number of programs that need a core and run at the same time. Each has as many threads as `cargo test` would give it.
const AT_ONCE: usize = 2;

/// Programs that take longest, the longest first: they start first, so that no long one is left at the end.
const LONGEST: &[&str] = &[
    "tidy",
    "properties",
    "entries",
    "takeovers",
    "primitives",
    "c_target",
    "endless",
    "jobs",
    "motion",
    "import",
];

/// Programs that mostly wait, the longest first: they need about a third of a core. They run one after the other, beside
/// the rest.
const WAITING: &[&str] = &["python", "view", "rtde", "server", "teach"];

/// Programs that measure how soon a server answers under load, let its cycle run beside many clients, or send set-points in
/// real time to a controller that brakes when they are late. They run last, one after the other.
const ALONE: &[&str] = &["attacks", "chaos", "udp_arm"];

/// Number of programs in the list of the slowest.
const SLOWEST: usize = 12;

/// Test program of a package.
struct Program {
    /// Name of the test target, such as `takeovers`.
    name: String,
    package: String,
    executable: PathBuf,
    manifest: PathBuf,
}

/// Test program that has run.
struct Finished {
    program: Program,
    output: std::io::Result<Output>,
    took: Duration,
}

impl Finished {
    fn has_passed(&self) -> bool {
        self.output
            .as_ref()
            .is_ok_and(|output| output.status.success())
    }
}

/// Test programs by the way in which they run.
struct Lanes {
    /// Programs that use a core each.
    busy: Vec<Program>,
    waiting: Vec<Program>,
    alone: Vec<Program>,
}

impl Lanes {
    fn sort(programs: Vec<Program>) -> Lanes {
        let (alone, rest): (Vec<_>, Vec<_>) = programs
            .into_iter()
            .partition(|program| rank(program, ALONE).is_some());
        let (mut waiting, mut busy): (Vec<_>, Vec<_>) = rest
            .into_iter()
            .partition(|program| rank(program, WAITING).is_some());
        for (lane, longest) in [(&mut busy, LONGEST), (&mut waiting, WAITING)] {
            lane.sort_by_key(|program| rank(program, longest).unwrap_or(longest.len()));
        }
        Lanes {
            busy,
            waiting,
            alone,
        }
    }
}

/// Returns the place of a program in a list; `None` if the list does not contain it.
fn rank(program: &Program, list: &[&str]) -> Option<usize> {
    list.iter().position(|name| *name == program.name)
}

/// Carries out `cargo xtask test`: builds and runs all tests, or those of the programs that are named, then the examples in
/// the documentation. Prints the output of each program when it ends.
pub(crate) fn test(args: &[String]) -> Result<(), TaskError> {
    let mut programs = build()?;
    if !args.is_empty() {
        programs.retain(|program| args.contains(&program.name));
    }
    let count = programs.len();
    let (finished, examples) = run_lanes(Lanes::sort(programs), args.is_empty());
    print_slowest(&finished);
    let failed = finished.iter().filter(|finished| !finished.has_passed());
    let failed: Vec<&str> = failed
        .map(|finished| finished.program.name.as_str())
        .collect();
    let programs = match failed.is_empty() {
        true => {
            println!("all {count} test programs have passed");
            Ok(())
        }
        false => Err(format!(
            "{} of {count} test programs failed: {}",
            failed.len(),
            failed.join(", ")
        )
        .into()),
    };
    programs.and(examples)
}

/// Builds all tests and returns their programs.
fn build() -> Result<Vec<Program>, TaskError> {
    let mut cargo = Command::new(env!("CARGO"));
    let arguments = ["test", "--workspace", "--locked", "--no-run"];
    let built = cargo
        .args(arguments)
        .arg("--message-format=json-render-diagnostics")
        .stderr(Stdio::inherit())
        .output()?;
    if !built.status.success() {
        return Err("the tests do not compile".into());
    }
    let text = String::from_utf8_lossy(&built.stdout);
    let messages = text
        .lines()
        .filter_map(|line| serde_json::from_str(line).ok());
    Ok(messages.filter_map(|message| program(&message)).collect())
}

/// Returns the test program that a message of cargo reports.
fn program(message: &Value) -> Option<Program> {
    let is_test = message["profile"]["test"].as_bool()?;
    let manifest = PathBuf::from(message["manifest_path"].as_str()?);
    let package = manifest
        .parent()?
        .file_name()?
        .to_string_lossy()
        .into_owned();
    is_test.then_some(Program {
        name: message["target"]["name"].as_str()?.to_owned(),
        package,
        executable: message["executable"].as_str()?.into(),
        manifest,
    })
}

/// Runs the programs of all lanes, and the examples in the documentation if `has_examples` is true. Returns the programs,
/// and the result of the examples.
fn run_lanes(lanes: Lanes, has_examples: bool) -> (Vec<Finished>, Result<(), TaskError>) {
    std::thread::scope(|scope| {
        let waiting = scope.spawn(|| {
            let finished = run_all(lanes.waiting, 1);
            let examples = if has_examples {
                run_doc_tests()
            } else {
                Ok(())
            };
            (finished, examples)
        });
        let mut finished = run_all(lanes.busy, AT_ONCE);
        let (waited, examples) = waiting
            .join()
            .unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        finished.extend(waited);
        finished.extend(run_all(lanes.alone, 1));
        (finished, examples)
    })
}

/// Runs programs, some of them at the same time, and prints the output of each.
fn run_all(programs: Vec<Program>, at_once: usize) -> Vec<Finished> {
    let waiting = Mutex::new(VecDeque::from(programs));
    let finished = Mutex::new(Vec::new());
    let take = || waiting.lock().ok()?.pop_front();
    std::thread::scope(|scope| {
        for _ in 0..at_once {
            scope.spawn(|| {
                while let Some(program) = take() {
                    let done = run(program);
                    if let Ok(mut finished) = finished.lock() {
                        print(&done);
                        finished.push(done);
                    }
                }
            });
        }
    });
    finished.into_inner().unwrap_or_default()
}

fn run(program: Program) -> Finished {
    let start = Instant::now();
    let folder = program
        .manifest
        .parent()
        .map_or_else(PathBuf::new, PathBuf::from);
    let output = Command::new(&program.executable)
        .arg("-q")
        .current_dir(&folder)
        .env("CARGO_MANIFEST_DIR", &folder)
        .stdin(Stdio::null())
        .output();
    Finished {
        program,
        output,
        took: start.elapsed(),
    }
}

/// Prints the output of a program.
fn print(finished: &Finished) {
    let (program, took) = (&finished.program, finished.took.as_secs_f64());
    println!(
        "\n     Running {} of {} ({took:.1} s)",
        program.name, program.package
    );
    match &finished.output {
        Ok(output) => {
            print!("{}", String::from_utf8_lossy(&output.stdout));
            eprint!("{}", String::from_utf8_lossy(&output.stderr));
        }
        Err(error) => println!("cannot be started: {error}"),
    }
}

fn print_slowest(finished: &[Finished]) {
    let mut slowest: Vec<&Finished> = finished.iter().collect();
    slowest.sort_by_key(|finished| std::cmp::Reverse(finished.took));
    println!("\nslowest test programs:");
    for finished in slowest.iter().take(SLOWEST) {
        println!(
            "{:>7.1} s  {}",
            finished.took.as_secs_f64(),
            finished.program.name
        );
    }
}

/// Runs the examples in the documentation of the crates.
fn run_doc_tests() -> Result<(), TaskError> {
    let mut cargo = Command::new(env!("CARGO"));
    let status = cargo
        .args(["test", "--workspace", "--locked", "--doc", "--quiet"])
        .status()?;
    match status.success() {
        true => Ok(()),
        false => Err("examples in the documentation failed".into()),
    }
}
