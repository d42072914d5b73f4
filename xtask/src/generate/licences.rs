//! Generator of the list of third-party crates in the two tools, with their licences, from `cargo metadata`.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::process::Command;

use rpi_testkit::workspace_root;
use serde_json::Value;

use super::GENERATED_NOTICE;

/// Names of the packages that are shipped as programs; their dependencies are listed.
const SHIPPED: [&str; 2] = ["rpi", "rpic"];

pub(super) fn chapter() -> String {
    let metadata = metadata();
    let packages = metadata["packages"]
        .as_array()
        .map_or(&[][..], Vec::as_slice);
    let packages: BTreeMap<&str, &Value> = packages.iter().map(|p| (text(&p["id"]), p)).collect();
    let mut out = format!("{GENERATED_NOTICE}# Third-party licences\n\n");
    out.push_str(
        "Crates from other sources in the programs `rpi` and `rpic` for Linux, with all features. The licences are those of the manifests \
         of the crates; `Cargo.lock` has the versions, and the sources contain the licence texts. `cargo deny check licenses` compares \
         them with the licences that `deny.toml` allows.\n\n| crate | licence | source |\n|---|---|---|\n",
    );
    let shipped = shipped(&metadata, &packages);
    let rows: BTreeSet<String> = shipped
        .iter()
        .filter_map(|id| row(packages.get(id)?))
        .collect();
    rows.iter().for_each(|row| out.push_str(row));
    out
}

/// Returns the row of the licence table for a third-party package, from its metadata; `None` for a package of the
/// workspace.
fn row(package: &Value) -> Option<String> {
    package["source"].as_str()?;
    let (name, licence) = (text(&package["name"]), text(&package["license"]));
    let source = package["repository"].as_str();
    let mut row = String::new();
    let link = source.map_or(String::new(), |url| format!("<{url}>"));
    // Old manifests separate alternatives with a slash.
    let alternatives: Vec<&str> = licence.split('/').map(str::trim).collect();
    let licence = alternatives.join(" OR ");
    // Writing to a string does not fail.
    let _ = writeln!(row, "| `{name}` | {licence} | {link} |");
    Some(row)
}

/// Returns the identifiers of all packages that are linked into the shipped programs, without packages that only tests
/// or builds use.
fn shipped<'m>(metadata: &'m Value, packages: &BTreeMap<&str, &'m Value>) -> BTreeSet<&'m str> {
    let nodes = metadata["resolve"]["nodes"].as_array();
    let nodes = nodes.into_iter().flatten();
    let nodes: BTreeMap<&str, &Value> = nodes.map(|node| (text(&node["id"]), node)).collect();
    let is_shipped = |p: &&&Value| p["source"].is_null() && SHIPPED.contains(&text(&p["name"]));
    let mut open: Vec<&str> = packages
        .values()
        .filter(is_shipped)
        .map(|p| text(&p["id"]))
        .collect();
    let mut found = BTreeSet::new();
    while let Some(id) = open.pop() {
        if found.insert(id) {
            let node = nodes.get(id).copied();
            open.extend(node.into_iter().flat_map(dependencies));
        }
    }
    found
}

/// Returns the identifiers of the packages that the package of a node of the dependency graph links, without
/// dependencies of tests and builds.
fn dependencies(node: &Value) -> Vec<&str> {
    let all = node["deps"].as_array().into_iter().flatten();
    let linked = all.filter(|dependency| {
        let kinds = dependency["dep_kinds"].as_array();
        kinds
            .into_iter()
            .flatten()
            .any(|kind| kind["kind"].is_null())
    });
    linked.map(|dependency| text(&dependency["pkg"])).collect()
}

/// Returns the output of `cargo metadata` for Linux: all packages and the dependency graph. The network is not used.
fn metadata() -> Value {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let arguments = [
        "metadata",
        "--offline",
        "--locked",
        "--all-features",
        "--format-version=1",
        "--filter-platform=x86_64-unknown-linux-gnu",
    ];
    let mut command = Command::new(cargo);
    command.args(arguments).current_dir(workspace_root());
    let output = command.output().expect("cargo runs");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "cargo metadata: {errors}");
    serde_json::from_slice(&output.stdout).expect("cargo metadata prints JSON")
}

fn text(value: &Value) -> &str {
    value.as_str().unwrap_or_default()
}
