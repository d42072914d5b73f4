//! The crates of the workspace and what they depend on, as `cargo metadata` tells it.

use std::path::PathBuf;
use std::process::Command;

use rpi_testkit::workspace_root;
use serde_json::Value;

/// A crate of the workspace.
#[derive(Clone, Debug)]
pub struct Package {
    /// The name that `cargo -p` takes.
    pub name: String,
    /// The folder of its manifest.
    pub dir: PathBuf,
    /// Its dependencies, sorted by name.
    pub dependencies: Vec<Dependency>,
}

/// One dependency of a [`Package`].
#[derive(Clone, Debug)]
pub struct Dependency {
    /// The name of the crate depended on.
    pub name: String,
    /// Whether it is a crate of this workspace.
    pub ours: bool,
    /// Whether only tests, benches and examples see it.
    pub dev: bool,
    /// Whether its default features are on.
    pub default_features: bool,
}

impl Package {
    /// The crates of this workspace that it is built on, tests apart.
    pub fn edges(&self) -> Vec<&str> {
        let kept = self.dependencies.iter().filter(|d| d.ours && !d.dev);
        kept.map(|d| d.name.as_str()).collect()
    }

    /// The third-party crates that it uses, in tests too.
    pub fn third_party(&self) -> impl Iterator<Item = &Dependency> {
        self.dependencies.iter().filter(|d| !d.ours)
    }
}

/// All crates of the workspace, sorted by name.
///
/// # Panics
///
/// If cargo cannot be run: the tests were started by it, so that is a fault of the machine.
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
        ours: value.get("path").is_some_and(Value::is_string),
        dev: value["kind"] == "dev",
        default_features: value["uses_default_features"] == true,
    }
}

fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

fn text(value: &Value) -> String {
    value.as_str().unwrap_or_default().to_owned()
}
