//! `cargo xtask bless [FILTER]`: rewrites the expected outputs of tests.

use crate::task_error::TaskError;
use std::process::Command;

/// Group of tests that compare an output with files of the repository. `cargo xtask bless` rewrites these files.
struct Suite {
    /// Name of the group, which the filter of `cargo xtask bless` selects.
    name: &'static str,
    /// Description of the files that are rewritten, which the filter selects, too.
    files: &'static str,
    /// Arguments of `cargo build` for the tools that the tests run; empty if the tests need no tool.
    tools: &'static [&'static str],
    /// Arguments of `cargo test` that select the tests of the group.
    tests: &'static [&'static str],
}

/// All groups of tests with expected outputs. Each group can be run alone, so that a change of one message rewrites no
/// other file.
const SUITES: &[Suite] = &[
    Suite {
        name: "ui",
        files: "tests/ui/**/*.stderr (checks)",
        tools: &[],
        tests: &["-p", "xtask", "--test", "tidy", "ui::programs_give"],
    },
    Suite {
        name: "ui-run",
        files: "tests/ui/running/*.stderr",
        tools: &[],
        tests: &["-p", "rpi", "--test", "ui"],
    },
    Suite {
        name: "ui-compile",
        files: "tests/ui/testing/*.stderr, tests/ui/emitting*/*.stderr",
        tools: &[],
        tests: &["-p", "rpic", "--test", "ui"],
    },
    Suite {
        name: "book",
        files: "outputs of commands in documents",
        tools: &["-p", "rpi", "-p", "rpic"],
        tests: &[
            "-p",
            "xtask",
            "--test",
            "tidy",
            "book::commands_in_documents",
        ],
    },
    Suite {
        name: "syntax",
        files: "crates/rpi-syntax/tests/broken",
        tools: &[],
        tests: &["-p", "rpi-syntax", "--test", "it", "diagnostics::"],
    },
    Suite {
        name: "doc",
        files: "crates/rpi-doc/tests/data/belt.html",
        tools: &[],
        tests: &["-p", "rpi-doc", "--test", "pages", "a_page_is_what_it_was"],
    },
    Suite {
        name: "editor",
        files: "crates/rpi-lsp/tests/cases",
        tools: &[],
        tests: &["-p", "rpi-lsp", "--test", "it", "recorded"],
    },
    Suite {
        name: "snapshots",
        files: "**/*.snap",
        tools: &[],
        tests: &["-p", "rpi-diag", "--test", "render"],
    },
];

/// Carries out `cargo xtask bless`: rewrites the expected outputs of the test groups whose name or files contain the
/// filter; without a filter, of all groups.
pub(crate) fn bless(args: &[String]) -> Result<(), TaskError> {
    let filter = match args {
        [] => "",
        [filter] => filter.as_str(),
        _ => return Err(usage().into()),
    };
    let chosen = |suite: &&Suite| suite.name.contains(filter) || suite.files.contains(filter);
    let chosen: Vec<&Suite> = SUITES.iter().filter(chosen).collect();
    if chosen.is_empty() {
        return Err(usage().into());
    }
    chosen.into_iter().try_for_each(run)
}

fn usage() -> String {
    let suites = SUITES
        .iter()
        .map(|suite| format!("\n  {:<12} {}", suite.name, suite.files));
    format!(
        "usage: cargo xtask bless [FILTER]{}",
        suites.collect::<String>()
    )
}

fn run(suite: &Suite) -> Result<(), TaskError> {
    println!("{}: {}", suite.name, suite.files);
    if !suite.tools.is_empty() {
        cargo("build", suite.tools)?;
    }
    cargo("test", suite.tests)
}

/// Runs `cargo build` or `cargo test` in the environment in which tests rewrite their expected outputs: `RPI_BLESS` for
/// the tests of the project, `INSTA_*` for snapshots, and without `CI`, which would forbid snapshots to be written.
fn cargo(task: &str, args: &[&str]) -> Result<(), TaskError> {
    let status = Command::new(env!("CARGO"))
        .args([task, "--quiet"])
        .args(args)
        .env("RPI_BLESS", "1")
        .env("INSTA_UPDATE", "always")
        .env("INSTA_FORCE_PASS", "1")
        .env_remove("CI")
        .status()
        .map_err(|error| format!("cargo: {error}"))?;
    match status.success() {
        true => Ok(()),
        false => Err(format!("cargo {task} {} failed", args.join(" ")).into()),
    }
}
