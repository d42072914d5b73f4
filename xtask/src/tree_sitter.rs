//! `cargo xtask tree-sitter`: tests the grammar for tree-sitter.
//!
//! The crate of the grammar is outside of the workspace, because it compiles the generated C parser and calls it, which
//! needs `unsafe`.

use std::process::Command;

use rpi_testkit::workspace_root;

use crate::task_error::TaskError;

/// Carries out `cargo xtask tree-sitter`: parses all programs of the repository with the committed parser, and checks
/// the queries.
pub(crate) fn tree_sitter(args: &[String]) -> Result<(), TaskError> {
    if !args.is_empty() {
        return Err("usage: cargo xtask tree-sitter".into());
    }
    let root = workspace_root();
    let status = Command::new(env!("CARGO"))
        .args(["test", "--quiet", "--manifest-path"])
        .arg(root.join("editor-support/tree-sitter/Cargo.toml"))
        .arg("--target-dir")
        .arg(root.join("target/tree-sitter"))
        .status()
        .map_err(|error| format!("cargo: {error}"))?;
    match status.success() {
        true => Ok(()),
        false => Err("the grammar for tree-sitter has errors".into()),
    }
}
