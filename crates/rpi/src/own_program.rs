//! The program of this process, for processes that it starts.

use std::io;
use std::path::{Path, PathBuf};

/// Returns the path of this program.
///
/// # Errors
/// If the system does not know it.
pub(crate) fn own_program() -> io::Result<PathBuf> {
    // On Linux, this path is the running program even after its file was replaced by another version.
    let own = Path::new("/proc/self/exe");
    match cfg!(target_os = "linux") && own.exists() {
        true => Ok(own.to_owned()),
        false => std::env::current_exe(),
    }
}
