//! File with the current input. A stack overflow ends the fuzzer before it can write down the input itself.

use std::path::PathBuf;
use std::sync::OnceLock;

/// Environment variable with the path of the file to which each input is saved. If it is unset, no input is saved.
const VARIABLE: &str = "RPI_FUZZ_LAST";

/// Saves an input to the file that the environment variable names, in place of the previous input. After a crash, the
/// file contains the input that caused the crash.
pub(crate) fn save(input: &[u8]) {
    static FILE: OnceLock<Option<PathBuf>> = OnceLock::new();
    let file = FILE.get_or_init(|| std::env::var_os(VARIABLE).map(PathBuf::from));
    if let Some(file) = file {
        // A write error is ignored: the run remains valid, only a crash would be harder to reproduce.
        let _ = std::fs::write(file, input);
    }
}
