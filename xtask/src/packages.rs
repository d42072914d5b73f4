//! Crates of the workspace and their dependencies, from `cargo metadata`.

use std::path::PathBuf;
use std::process::Command;

use rpi_testkit::workspace_root;
use serde_json::Value;

/// Crate of the workspace, with its dependencies.
#[derive(Clone, Debug)]
pub struct Package {
    /// Name of the crate, as used by `cargo -p`.
    pub name: String,
    /// Folder that contains the `Cargo.toml` of the crate.
    pub dir: PathBuf,
    /// Dependencies of the crate of all kinds, sorted by name.
    pub dependencies: Vec<Dependency>,
}

/// Dependency of a crate of the workspace ([`Package`]).
#[derive(Clone, Debug)]
pub struct Dependency {
    /// Name of the crate on which the package depends.
    pub name: String,
    /// True if that crate belongs to this workspace, false for a third-party crate.
    pub is_workspace: bool,
    /// True if only tests, benches and examples of the package use the dependency.
    pub is_dev: bool,
    /// True if the default features of the dependency are enabled.
    pub default_features: bool,
}

impl Package {
    /// Returns the names of the workspace crates on which this crate depends, without development dependencies.
    pub fn workspace_dependencies(&self) -> Vec<&str> {
        let kept = self
            .dependencies
            .iter()
            .filter(|d| d.is_workspace && !d.is_dev);
        kept.map(|d| d.name.as_str()).collect()
    }

    /// Returns the third-party dependencies of this crate, including development dependencies.
    pub fn third_party(&self) -> impl Iterator<Item = &Dependency> {
        self.dependencies.iter().filter(|d| !d.is_workspace)
    }
}

/// Returns all crates of the workspace, sorted by name.
///
/// # Panics
///
/// Panics if cargo cannot be run. Cargo runs the tests, so this indicates a broken installation.
pub fn packages() -> Vec<Package> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = Command::new(cargo)
        .args([
            "metadata",
            "--no-deps",
            "--offline",
            "--format-version",
            "1",
        ])
        .current_dir(workspace_root())
        .output()
        .expect("cargo runs");
    let metadata: Value =
        serde_json::from_slice(&output.stdout).expect("cargo metadata prints JSON");
    let mut packages: Vec<Package> = list(&metadata["packages"]).iter().map(package).collect();
    packages.sort_by(|a, b| a.name.cmp(&b.name));
    packages
}

fn package(value: &Value) -> Package {
    let manifest = PathBuf::from(text(&value["manifest_path"]));
    let mut dependencies: Vec<Dependency> = list(&value["dependencies"])
        .iter()
        .map(dependency)
        .collect();
    dependencies.sort_by(|a, b| a.name.cmp(&b.name));
    Package {
        name: text(&value["name"]),
        dir: manifest.parent().map(Into::into).unwrap_or_default(),
        dependencies,
    }
}

fn dependency(value: &Value) -> Dependency {
    Dependency {
        name: text(&value["name"]),
        is_workspace: value.get("path").is_some_and(Value::is_string),
        is_dev: value["kind"] == "dev",
        default_features: value["uses_default_features"] == true,
    }
}

fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

fn text(value: &Value) -> String {
    value.as_str().unwrap_or_default().to_owned()
}
