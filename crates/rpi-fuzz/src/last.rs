//! The input at hand, kept in a file: a stack that overflows ends a fuzzer before it can write down what it ran.

use std::path::PathBuf;
use std::sync::OnceLock;

/// Names the file; without it nothing is kept.
const VARIABLE: &str = "RPI_FUZZ_LAST";

/// Keeps an input until the next one.
pub(crate) fn keep(input: &[u8]) {
    static FILE: OnceLock<Option<PathBuf>> = OnceLock::new();
    let file = FILE.get_or_init(|| std::env::var_os(VARIABLE).map(PathBuf::from));
    if let Some(file) = file {
        // Without it the run is worth the same, only its end is harder to explain.
        let _ = std::fs::write(file, input);
    }
}
