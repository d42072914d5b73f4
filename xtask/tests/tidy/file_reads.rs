//! Files are read within limits: a device file has no end, and would take all memory of the machine.

use xtask::source_files;

/// Calls that read a file without a limit.
const READS: &[&str] = &["fs::read(", "read_to_string(", "File::open("];

/// Files that may contain such a call, with the reason.
const ALLOWED: &[(&str, &str)] = &[
    ("crates/rpi-files/src/lib.rs", "has the limits"),
    (
        "crates/rpi-record/src/mcap/completion.rs",
        "reads records within limits of each",
    ),
    (
        "crates/rpi-record/src/mcap/part_source.rs",
        "reads records within limits of each",
    ),
    (
        "crates/rpi-serve/src/client_token.rs",
        "has a limit of its own, and checks who may read the file",
    ),
    (
        "crates/rpi-serve/src/state/log_file.rs",
        "opens the log to write; a test reads it",
    ),
    (
        "crates/rpi-lsp/src/builtin_documents.rs",
        "reads a file of its own",
    ),
    (
        "crates/rpic/src/outcome.rs",
        "compares an output with the file that it replaces",
    ),
    ("crates/rpi/src/interrupt.rs", "reads a file of the kernel"),
    ("crates/rpi/src/node.rs", "reads rows within limits of each"),
];

#[test]
fn files_are_read_within_limits() {
    for file in source_files() {
        let path = file.path.to_string_lossy().replace('\\', "/");
        let is_product = path.contains("/src/") && !path.contains("rpi-testkit");
        let is_product =
            is_product && (path.starts_with("crates/") || path.starts_with("clients/"));
        if !is_product || ALLOWED.iter().any(|(allowed, _)| *allowed == path) {
            continue;
        }
        let reads = |line: &&str| READS.iter().any(|read| line.contains(read));
        let found = file.text.lines().find(reads);
        assert_eq!(found, None, "{path}: use `rpi_files`, which has limits");
    }
}

#[test]
fn each_exception_is_needed() {
    let files = source_files();
    for (allowed, reason) in ALLOWED {
        let file = files.iter().find(|file| file.path.ends_with(allowed));
        let file = file.unwrap_or_else(|| panic!("{allowed} is gone"));
        assert!(
            READS.iter().any(|read| file.text.contains(read)),
            "{allowed}: {reason}"
        );
    }
}
