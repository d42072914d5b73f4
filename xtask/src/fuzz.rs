//! `cargo xtask fuzz ENTRY --seconds N`: builds and runs one fuzz target.
//!
//! libFuzzer needs coverage counters from the compiler. The flags below request them from LLVM on any toolchain, so
//! that neither a nightly toolchain nor cargo-fuzz is needed (the targets work with both). The limits of time and
//! memory per input are defined by the entries (`fuzz/src/budget.rs`), which measure the input alone and not
//! other load on the machine.

use crate::task_error::TaskError;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Compiler flags that make LLVM count executed edges and comparisons for libFuzzer, the same as those of cargo-fuzz.
const COVERAGE_FLAGS: &[&str] = &[
    "-Cpasses=sancov-module",
    "-Cllvm-args=-sanitizer-coverage-level=4",
    "-Cllvm-args=-sanitizer-coverage-inline-8bit-counters",
    "-Cllvm-args=-sanitizer-coverage-pc-table",
    "-Cllvm-args=-sanitizer-coverage-trace-compares",
    "--cfg=fuzzing",
];

/// Limits of libFuzzer, far above the limits of each entry point: they stop hanging inputs and bound the corpus. A
/// longer input finds no error that a shorter input does not find. An input that takes a second is saved as a slow
/// unit.
const LIMITS: &[&str] = &[
    "-timeout=60",
    "-report_slow_units=1",
    "-rss_limit_mb=3000",
    "-max_len=20000",
];

/// Duration of a fuzzer run without the option `--seconds`: one hour, in seconds.
const DEFAULT_SECONDS: &str = "3600";

/// Carries out `cargo xtask fuzz`: builds the fuzz target of an entry point, and runs it for some time.
pub(crate) fn fuzz(args: &[String]) -> Result<(), TaskError> {
    let (entry, seconds) = match args {
        [entry] => (entry, DEFAULT_SECONDS),
        [entry, flag, seconds] if flag == "--seconds" => (entry, seconds.as_str()),
        _ => return Err("usage: cargo xtask fuzz ENTRY [--seconds N]".into()),
    };
    let folder = root().join("fuzz/targets");
    let corpus = folder.join("target/corpus").join(entry);
    let words = folder.join("target/words");
    write_seeds(entry, &corpus, &words)?;
    let target = build(&folder, entry)?;
    let found = folder.join("target/found").join(entry);
    std::fs::create_dir_all(&found).map_err(|error| error.to_string())?;
    let last = found.join("last-input");
    let mut run = Command::new(target);
    run.args(LIMITS)
        .arg(format!("-max_total_time={seconds}"))
        .arg(format!("-dict={}", words.display()))
        .arg(format!("-artifact_prefix={}/", found.display()))
        .env("RPI_FUZZ_LAST", &last)
        .arg(corpus);
    let what = format!(
        "the fuzzer found a failure; the last input is kept in {}",
        last.display()
    );
    run_checked(&mut run, &what)?;
    std::fs::remove_file(&last).map_err(|error| error.to_string())?;
    rerun_slow(entry, &found)
}

/// Runs the slow inputs in the folder `found` again, in a release build without counters. Returns an error for an input
/// that is slow there, too, and deletes the others.
fn rerun_slow(entry: &str, found: &Path) -> Result<(), TaskError> {
    let files = std::fs::read_dir(found).map_err(|error| error.to_string())?;
    let is_slow = |path: &PathBuf| {
        let name = path.file_name().and_then(|name| name.to_str());
        name.is_some_and(|name| name.starts_with("slow-unit-"))
    };
    let paths = files.filter_map(|file| Some(file.ok()?.path()));
    for path in paths.filter(is_slow) {
        let mut run = tool_command("rpi-fuzz-again", &["--release"]);
        run.arg(entry).arg(&path);
        run_checked(&mut run, "an input exceeds the time limit")?;
        std::fs::remove_file(&path).map_err(|error| error.to_string())?;
    }
    Ok(())
}

/// Returns the command that runs the program `name` of the package `rpi-fuzz`. `flags` are arguments of `cargo run`.
fn tool_command(name: &str, flags: &[&str]) -> Command {
    let mut run = Command::new(env!("CARGO"));
    run.current_dir(root())
        .args(["run", "--quiet", "--package", "rpi-fuzz", "--bin", name])
        .args(flags)
        .arg("--");
    run
}

/// Returns the path of the root folder of the workspace.
pub(crate) fn root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here).to_owned()
}

fn write_seeds(entry: &str, corpus: &Path, words: &Path) -> Result<(), TaskError> {
    let mut write = tool_command("rpi-fuzz-seeds", &[]);
    write.arg(entry).args([corpus, words]);
    run_checked(&mut write, "cannot write the seeds")
}

/// Builds the fuzz target of an entry point and returns the path of the program. The option `--target` prevents that
/// the coverage flags apply to build scripts, too.
fn build(folder: &Path, entry: &str) -> Result<PathBuf, TaskError> {
    let host = host()?;
    let mut build = Command::new(env!("CARGO"));
    build
        .current_dir(folder)
        .env("CARGO_ENCODED_RUSTFLAGS", COVERAGE_FLAGS.join("\u{1f}"))
        .args(["build", "--quiet", "--release", "--bin", entry])
        .args(["--target", &host, "--target-dir", "target"]);
    run_checked(&mut build, "cannot build the target")?;
    Ok(folder.join("target").join(host).join("release").join(entry))
}

/// Returns the target triple of this machine as `rustc` reports it, such as `x86_64-unknown-linux-gnu`.
fn host() -> Result<String, TaskError> {
    let version = Command::new("rustc").arg("-vV").output();
    let version = version.map_err(|error| format!("rustc: {error}"))?.stdout;
    let version = String::from_utf8_lossy(&version).into_owned();
    let host = version.lines().find_map(|line| line.strip_prefix("host: "));
    host.map(str::to_owned)
        .ok_or("rustc does not report a host".into())
}

fn run_checked(command: &mut Command, otherwise: &str) -> Result<(), TaskError> {
    let name = command.get_program().to_string_lossy().into_owned();
    match command.status() {
        Ok(status) if status.success() => Ok(()),
        Ok(_) => Err(otherwise.into()),
        Err(error) => Err(format!("{name}: {error}").into()),
    }
}
