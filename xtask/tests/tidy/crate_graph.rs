//! Rule 1: dependencies between crates have one direction.

use std::collections::{BTreeMap, BTreeSet};

use xtask::{Package, packages};

/// Allowed dependencies of each crate. A new edge is a decision: add it here and to `ARCHITECTURE.md`.
const EDGES: &[(&str, &[&str])] = &[
    ("rpi-image", &[]),
    ("rpi-device", &["rpi-image"]),
    (
        "rpi-prims",
        &["rpi-device", "rpi-image", "rpi-kin", "rpi-math"],
    ),
    ("rpi-core", &["rpi-device", "rpi-image", "rpi-prims"]),
    ("rpi-codegen", &["rpi-image", "rpi-prims"]),
    (
        "rpi-c-target",
        &[
            "rpi-codegen",
            "rpi-core",
            "rpi-device",
            "rpi-files",
            "rpi-image",
            "rpi-prims",
        ],
    ),
    ("rpi-math", &[]),
    ("rpi-kin", &["rpi-math"]),
    ("rpi-motion", &["rpi-kin", "rpi-math"]),
    (
        "rpi-sim",
        &[
            "rpi-device",
            "rpi-files",
            "rpi-image",
            "rpi-kin",
            "rpi-math",
            "rpi-motion",
        ],
    ),
    ("rpi-files", &[]),
    ("rpi-words", &[]),
    ("rpi-diag", &["rpi-words"]),
    ("rpi-syntax", &["rpi-diag"]),
    ("rpi-literal", &["rpi-image", "rpi-prims", "rpi-words"]),
    (
        "rpi-net",
        &["rpi-diag", "rpi-image", "rpi-literal", "rpi-prims"],
    ),
    (
        "rpi-sema",
        &[
            "rpi-diag",
            "rpi-image",
            "rpi-net",
            "rpi-prims",
            "rpi-syntax",
        ],
    ),
    (
        "rpi-lower",
        &["rpi-diag", "rpi-image", "rpi-net", "rpi-prims"],
    ),
    (
        "rpi-driver",
        &[
            "rpi-codegen",
            "rpi-diag",
            "rpi-files",
            "rpi-image",
            "rpi-literal",
            "rpi-lower",
            "rpi-net",
            "rpi-prims",
            "rpi-sema",
            "rpi-sim",
            "rpi-syntax",
        ],
    ),
    (
        "rpi-runtime",
        &[
            "rpi-core",
            "rpi-device",
            "rpi-image",
            "rpi-literal",
            "rpi-prims",
            "rpi-sim",
            "rpi-words",
        ],
    ),
    (
        "rpi-record",
        &[
            "rpi-core",
            "rpi-device",
            "rpi-diag",
            "rpi-files",
            "rpi-image",
            "rpi-kin",
            "rpi-literal",
            "rpi-math",
            "rpi-runtime",
            "rpi-sim",
            "rpi-words",
        ],
    ),
    ("rpi-graph", &[]),
    (
        "rpi-replay",
        &[
            "rpi-core",
            "rpi-device",
            "rpi-diag",
            "rpi-graph",
            "rpi-image",
            "rpi-literal",
            "rpi-lower",
            "rpi-net",
            "rpi-prims",
            "rpi-record",
            "rpi-runtime",
            "rpi-sim",
        ],
    ),
    (
        "rpi-debug",
        &[
            "rpi-core",
            "rpi-diag",
            "rpi-driver",
            "rpi-files",
            "rpi-image",
            "rpi-literal",
            "rpi-net",
            "rpi-record",
            "rpi-runtime",
            "rpi-syntax",
        ],
    ),
    ("rpi-view", &["rpi-graph", "rpi-image", "rpi-record"]),
    ("rpi-client", &[]),
    (
        "rpi-serve",
        &[
            "rpi-core",
            "rpi-device",
            "rpi-diag",
            "rpi-driver",
            "rpi-image",
            "rpi-kin",
            "rpi-literal",
            "rpi-net",
            "rpi-prims",
            "rpi-record",
            "rpi-runtime",
            "rpi-sim",
        ],
    ),
    (
        "rpi-lsp",
        &[
            "rpi-diag",
            "rpi-driver",
            "rpi-files",
            "rpi-image",
            "rpi-prims",
            "rpi-sema",
            "rpi-syntax",
        ],
    ),
    (
        "rpi-doc",
        &[
            "rpi-diag",
            "rpi-driver",
            "rpi-graph",
            "rpi-sema",
            "rpi-syntax",
        ],
    ),
    ("rpi-cli", &["rpi-diag"]),
    (
        "rpic",
        &[
            "rpi-c-target",
            "rpi-cli",
            "rpi-core",
            "rpi-diag",
            "rpi-doc",
            "rpi-driver",
            "rpi-files",
            "rpi-image",
            "rpi-lsp",
            "rpi-net",
            "rpi-replay",
            "rpi-runtime",
            "rpi-syntax",
        ],
    ),
    (
        "rpi",
        &[
            "rpi-c-target",
            "rpi-cli",
            "rpi-client",
            "rpi-core",
            "rpi-debug",
            "rpi-diag",
            "rpi-driver",
            "rpi-files",
            "rpi-graph",
            "rpi-image",
            "rpi-net",
            "rpi-record",
            "rpi-replay",
            "rpi-runtime",
            "rpi-serve",
            "rpi-sim",
            "rpi-view",
        ],
    ),
    ("rpi-reference", &["rpi-image", "rpi-sema", "rpi-syntax"]),
    (
        "rpi-nostd",
        &[
            "rpi-core",
            "rpi-device",
            "rpi-image",
            "rpi-kin",
            "rpi-prims",
        ],
    ),
    ("rpi-testkit", &["rpi-files"]),
    (
        "rpi-bench",
        &[
            "rpi-codegen",
            "rpi-core",
            "rpi-device",
            "rpi-diag",
            "rpi-image",
            "rpi-lower",
            "rpi-net",
            "rpi-prims",
            "rpi-testkit",
        ],
    ),
    (
        "rpi-fuzz",
        &[
            "rpi-core",
            "rpi-diag",
            "rpi-driver",
            "rpi-files",
            "rpi-image",
            "rpi-record",
            "rpi-runtime",
            "rpi-serve",
            "rpi-sim",
            "rpi-syntax",
            "rpi-testkit",
        ],
    ),
    (
        "xtask",
        &[
            "rpi-device",
            "rpi-diag",
            "rpi-image",
            "rpi-prims",
            "rpi-sim",
            "rpi-syntax",
            "rpi-testkit",
        ],
    ),
];

/// Crates whose code runs, or may run, on the cycle thread.
const NO_STD: &[&str] = &[
    "rpi-core",
    "rpi-device",
    "rpi-image",
    "rpi-kin",
    "rpi-math",
    "rpi-motion",
    "rpi-prims",
];

/// Crates of the compiler, which the real-time crates must not depend on.
const COMPILER: &[&str] = &[
    "rpi-codegen",
    "rpi-diag",
    "rpi-doc",
    "rpi-driver",
    "rpi-lower",
    "rpi-lsp",
    "rpi-net",
    "rpi-sema",
    "rpi-syntax",
    "rpic",
];

/// Crates that run images and record runs. They must not depend on the representations of a program in the compiler.
const RUNTIME: &[&str] = &["rpi-runtime", "rpi-record"];

/// The representations of a program and the passes between them.
const REPRESENTATIONS: &[&str] = &[
    "rpi-driver",
    "rpi-lower",
    "rpi-net",
    "rpi-sema",
    "rpi-syntax",
];

/// Third-party crates that the real-time crates may use; all of them work without `std`.
const NO_STD_THIRD_PARTY: &[&str] = &["libm", "nalgebra", "smallvec"];

#[test]
fn edges_are_as_drawn() {
    let drawn: BTreeMap<&str, BTreeSet<&str>> = EDGES
        .iter()
        .map(|(name, to)| (*name, to.iter().copied().collect()))
        .collect();
    let packages = packages();
    let real: BTreeMap<&str, BTreeSet<&str>> = packages
        .iter()
        .map(|p| {
            (
                p.name.as_str(),
                p.workspace_dependencies().into_iter().collect(),
            )
        })
        .collect();
    for name in drawn.keys().chain(real.keys()) {
        assert_eq!(
            real.get(name),
            drawn.get(name),
            "{name}: left is the manifest, right is the table (EDGES in {})",
            file!()
        );
    }
}

#[test]
fn the_real_time_side_sees_no_compiler() {
    for name in NO_STD {
        let seen = reachable(name);
        let bad: Vec<_> = COMPILER.iter().filter(|c| seen.contains(**c)).collect();
        assert!(bad.is_empty(), "{name} depends on {bad:?}");
        let std: Vec<_> = seen.iter().filter(|c| !NO_STD.contains(c)).collect();
        assert!(
            std.is_empty(),
            "{name} must not need std but depends on {std:?}"
        );
    }
}

/// The runtime takes images only. The errors of recordings are diagnostics, so `rpi-record` may see `rpi-diag`.
#[test]
fn the_runtime_sees_no_compiler() {
    for name in RUNTIME {
        let seen = reachable(name);
        let bad: Vec<_> = REPRESENTATIONS
            .iter()
            .filter(|c| seen.contains(**c))
            .collect();
        assert!(bad.is_empty(), "{name} sees {bad:?}");
    }
    let seen = reachable("rpi-runtime");
    let bad: Vec<_> = COMPILER.iter().filter(|c| seen.contains(**c)).collect();
    assert!(bad.is_empty(), "rpi-runtime sees {bad:?}");
}

/// The proof is `cargo check -p rpi-nostd --features proof` in `.ci/run`; this test fails earlier and with a clearer
/// message.
#[test]
fn the_real_time_side_is_no_std() {
    for package in real_time_packages() {
        let lib = std::fs::read_to_string(package.dir.join("src/lib.rs")).unwrap_or_default();
        assert!(
            lib.contains("\n#![no_std]\n"),
            "{}: `#![no_std]` is missing",
            package.name
        );
        for dependency in package.third_party().filter(|d| !d.is_dev) {
            let (name, crate_name) = (&dependency.name, &package.name);
            assert!(
                NO_STD_THIRD_PARTY.contains(&name.as_str()),
                "{crate_name} must not use {name}"
            );
            let plain = dependency.name == "libm" || !dependency.default_features;
            assert!(
                plain,
                "{crate_name}: the default features of {name} need std"
            );
        }
    }
}

#[test]
fn only_tests_use_the_test_kit() {
    let tools = ["rpi-bench", "rpi-fuzz", "xtask"];
    for package in packages()
        .iter()
        .filter(|p| !tools.contains(&p.name.as_str()))
    {
        let edges = package.workspace_dependencies();
        assert!(
            !edges.contains(&"rpi-testkit"),
            "{} depends on rpi-testkit",
            package.name
        );
        assert!(
            !edges.contains(&"xtask"),
            "{} depends on xtask",
            package.name
        );
    }
}

fn real_time_packages() -> Vec<Package> {
    packages()
        .into_iter()
        .filter(|p| NO_STD.contains(&p.name.as_str()))
        .collect()
}

/// Returns every crate that `from` depends on, directly or indirectly, according to the table.
fn reachable(from: &'static str) -> BTreeSet<&'static str> {
    let mut seen = BTreeSet::new();
    let mut next: Vec<&str> = vec![from];
    while let Some(name) = next.pop() {
        let edges = EDGES
            .iter()
            .find(|(drawn, _)| *drawn == name)
            .map_or(&[][..], |(_, to)| to);
        next.extend(edges.iter().filter(|to| seen.insert(**to)));
    }
    seen
}
