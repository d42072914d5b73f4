//! `cargo xtask fuzz ENTRY --seconds N`: builds and runs one fuzz target.
//!
//! libFuzzer counts edges that the compiler instruments; the flags below ask LLVM for that, which any tool chain can,
//! so that neither a nightly one nor cargo-fuzz is needed (the targets work with both). Budgets of time and memory are
//! the entries' own (`crates/rpi-fuzz/src/budget.rs`): they count what one input costs, whatever else the machine does.

use std::path::{Path, PathBuf};
use std::process::Command;

/// What makes LLVM count edges and comparisons, as cargo-fuzz does it.
const INSTRUMENTED: &[&str] = &[
    "-Cpasses=sancov-module",
    "-Cllvm-args=-sanitizer-coverage-level=4",
    "-Cllvm-args=-sanitizer-coverage-inline-8bit-counters",
    "-Cllvm-args=-sanitizer-coverage-pc-table",
    "-Cllvm-args=-sanitizer-coverage-trace-compares",
    "--cfg=fuzzing",
];

/// libFuzzer's own limits lie far above the entries' budgets: they are for what does not come back at all, and for its
/// corpus. Inputs larger than this teach nothing that smaller ones do not. What takes a second is kept as a slow unit.
const LIMITS: &[&str] = &[
    "-timeout=60",
    "-report_slow_units=1",
    "-rss_limit_mb=3000",
    "-max_len=20000",
];

/// An hour.
const SECONDS: &str = "3600";

/// Builds a target and runs it.
pub(crate) fn fuzz(args: &[String]) -> Result<(), String> {
    let (entry, seconds) = match args {
        [entry] => (entry, SECONDS),
        [entry, flag, seconds] if flag == "--seconds" => (entry, seconds.as_str()),
        _ => return Err("usage: cargo xtask fuzz ENTRY [--seconds N]".to_owned()),
    };
    let folder = root().join("fuzz");
    let corpus = folder.join("target/corpus").join(entry);
    let words = folder.join("target/words");
    seeds(entry, &corpus, &words)?;
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
        "the fuzzer found something; what it ran last is kept in {}",
        last.display()
    );
    done(&mut run, &what)?;
    std::fs::remove_file(&last).map_err(|error| error.to_string())?;
    again(entry, &found)
}

/// Runs what was slow again as users run it, without counters; keeps what is slow there, too.
fn again(entry: &str, found: &Path) -> Result<(), String> {
    let files = std::fs::read_dir(found).map_err(|error| error.to_string())?;
    let is_slow = |path: &PathBuf| {
        let name = path.file_name().and_then(|name| name.to_str());
        name.is_some_and(|name| name.starts_with("slow-unit-"))
    };
    let paths = files.filter_map(|file| Some(file.ok()?.path()));
    for path in paths.filter(is_slow) {
        let mut run = tool("rpi-fuzz-again", &["--release"]);
        run.arg(entry).arg(&path);
        done(&mut run, "an input takes longer than it may")?;
        std::fs::remove_file(&path).map_err(|error| error.to_string())?;
    }
    Ok(())
}

/// A tool of the fuzzers, to be run.
fn tool(name: &str, flags: &[&str]) -> Command {
    let mut run = Command::new(env!("CARGO"));
    run.current_dir(root())
        .args(["run", "--quiet", "--package", "rpi-fuzz", "--bin", name])
        .args(flags)
        .arg("--");
    run
}

fn root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here).to_owned()
}

fn seeds(entry: &str, corpus: &Path, words: &Path) -> Result<(), String> {
    let mut write = tool("rpi-fuzz-seeds", &[]);
    write.arg(entry).args([corpus, words]);
    done(&mut write, "no seeds")
}

/// Builds a target and tells where it lies. Flags go with `--target`, so that they do not reach build scripts.
fn build(folder: &Path, entry: &str) -> Result<PathBuf, String> {
    let host = host()?;
    let mut build = Command::new(env!("CARGO"));
    build
        .current_dir(folder)
        .env("CARGO_ENCODED_RUSTFLAGS", INSTRUMENTED.join("\u{1f}"))
        .args(["build", "--quiet", "--release", "--bin", entry])
        .args(["--target", &host, "--target-dir", "target"]);
    done(&mut build, "the target does not build")?;
    Ok(folder.join("target").join(host).join("release").join(entry))
}

/// The machine that this was built on, as the compiler names it.
fn host() -> Result<String, String> {
    let told = Command::new("rustc").arg("-vV").output();
    let told = told.map_err(|error| format!("rustc: {error}"))?.stdout;
    let told = String::from_utf8_lossy(&told).into_owned();
    let host = told.lines().find_map(|line| line.strip_prefix("host: "));
    host.map(str::to_owned)
        .ok_or("rustc names no host".to_owned())
}

fn done(command: &mut Command, otherwise: &str) -> Result<(), String> {
    let name = command.get_program().to_string_lossy().into_owned();
    match command.status() {
        Ok(status) if status.success() => Ok(()),
        Ok(_) => Err(otherwise.to_owned()),
        Err(error) => Err(format!("{name}: {error}")),
    }
}
