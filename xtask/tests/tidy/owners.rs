//! Rule 9: each third-party crate has one owner crate.

use std::collections::{BTreeMap, BTreeSet};

use xtask::packages;

/// Crates that may depend on each third-party crate. Crates with several owners are exceptions: the types of nalgebra
/// are shared vocabulary, libm is the one implementation of exactly rounded functions, and the derives of serde and clap do not expose
/// types in interfaces.
const OWNERS: &[(&str, &[&str])] = &[
    ("arrow-array", &["rpi-record"]),
    ("arrow-buffer", &["rpi-record"]),
    ("arrow-ipc", &["rpi-record"]),
    ("arrow-schema", &["rpi-record"]),
    ("base64", &["rpi-view"]),
    ("cap", &["rpi-fuzz", "rpi-testkit"]),
    ("clap", &["rpi", "rpi-cli", "rpic"]),
    ("clap_complete", &["rpi-cli"]),
    ("clap_mangen", &["rpi-cli"]),
    ("crc32fast", &["rpi-record"]),
    ("csv", &["rpi"]),
    ("flate2", &["rpi-files", "rpi-testkit", "rpi-view"]),
    ("form_urlencoded", &["rpi-serve"]),
    ("hashbrown", &["rpi-lower", "rpi-net"]),
    ("hdrhistogram", &["rpi-runtime"]),
    ("http", &["rpi-serve"]),
    ("httparse", &["rpi-serve", "rpi-view"]),
    ("lalrpop", &["rpi-syntax"]),
    ("lalrpop-util", &["rpi-syntax"]),
    ("libc", &["rpi-runtime"]),
    (
        "libm",
        &["rpi-kin", "rpi-math", "rpi-motion", "rpi-prims", "rpi-sim"],
    ),
    ("logos", &["rpi-syntax"]),
    ("lsp-server", &["rpi-lsp"]),
    ("lsp-types", &["rpi-lsp"]),
    ("mcap", &["rpi-fuzz", "rpi-record"]),
    ("miette", &["rpi-diag"]),
    ("mimalloc", &["rpic"]),
    (
        "nalgebra",
        &[
            "rpi-kin",
            "rpi-motion",
            "rpi-prims",
            "rpi-record",
            "rpi-sim",
        ],
    ),
    // Not used: they have the features that the tests unify.
    ("num-complex", &["xtask"]),
    ("num-integer", &["xtask"]),
    ("parquet", &["rpi-record"]),
    ("petgraph", &["rpi-net", "rpi-sema"]),
    ("prometheus-client", &["rpi-serve"]),
    ("pulldown-cmark", &["rpi-doc"]),
    ("quick-xml", &["rpi-serve"]),
    ("roxmltree", &["rpi-sim"]),
    ("rtrb", &["rpi-runtime", "rpi-sim"]),
    ("rustc-hash", &["rpi-lower", "rpi-net"]),
    (
        "rustix",
        &[
            "rpi",
            "rpi-bench",
            "rpi-fuzz",
            "rpi-runtime",
            "rpi-serve",
            "rpi-sim",
        ],
    ),
    ("rustls", &["rpi-client", "rpi-serve"]),
    ("seccompiler", &["rpi-runtime"]),
    (
        "serde",
        &[
            "rpi-diag",
            "rpi-driver",
            "rpi-record",
            "rpi-replay",
            "rpi-runtime",
        ],
    ),
    (
        "serde_json",
        &[
            "rpi",
            "rpi-client",
            "rpi-debug",
            "rpi-diag",
            "rpi-lsp",
            "rpi-record",
            "rpi-replay",
            "rpi-runtime",
            "rpi-serve",
            "rpi-testkit",
            "rpi-view",
            "xtask",
        ],
    ),
    ("similar", &["rpic"]),
    ("signal-hook", &["rpi"]),
    (
        "smallvec",
        &[
            "rpi-image",
            "rpi-literal",
            "rpi-lower",
            "rpi-net",
            "rpi-sema",
        ],
    ),
    ("stacker", &["rpi-syntax"]),
    ("tempfile", &["xtask"]),
    ("terminal_size", &["rpi-diag"]),
    ("thread-priority", &["rpi-runtime"]),
    ("time", &["rpi-serve"]),
    ("toml", &["rpi-driver", "rpi-sim"]),
    ("tungstenite", &["rpi-client", "rpi-serve"]),
    ("zstd", &["rpi-record"]),
    ("assert_no_alloc", &["rpi-testkit"]),
];

/// Third-party crates that any crate may use in tests and benches.
const TEST_TOOLS: &[&str] = &[
    "criterion",
    "html5ever",
    "insta",
    "markup5ever_rcdom",
    "proptest",
    "rcgen",
    "regex",
    "regex",
    "stateright",
    "tempfile",
];

#[test]
fn third_party_crates_have_the_owners_of_the_table() {
    let listed: BTreeMap<&str, BTreeSet<&str>> = OWNERS
        .iter()
        .map(|(name, owners)| (*name, owners.iter().copied().collect()))
        .collect();
    let used = used();
    let used: BTreeMap<&str, BTreeSet<&str>> = used
        .iter()
        .map(|(name, owners)| (name.as_str(), owners.iter().map(String::as_str).collect()))
        .collect();
    for name in listed.keys().chain(used.keys()) {
        assert_eq!(
            used.get(name),
            listed.get(name),
            "{name}: left are the manifests, right is the table (OWNERS in {})",
            file!()
        );
    }
}

#[test]
fn tests_use_what_is_listed_or_owned() {
    for package in packages() {
        for tool in package.third_party().filter(|d| d.is_dev) {
            let known = TEST_TOOLS.contains(&tool.name.as_str())
                || OWNERS.iter().any(|(name, _)| *name == tool.name);
            assert!(
                known,
                "{} uses {} in tests, which is not in the tables",
                package.name, tool.name
            );
        }
    }
}

/// Returns the third-party crates of the product, each with the crates that depend on it.
fn used() -> BTreeMap<String, BTreeSet<String>> {
    let mut used: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for package in packages() {
        for dependency in package.third_party().filter(|d| !d.is_dev) {
            used.entry(dependency.name.clone())
                .or_default()
                .insert(package.name.clone());
        }
    }
    used
}
