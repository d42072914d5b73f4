//! The data beside the project: nets and traces too large, or not ours, to lie in it.
//!
//! They are expected in a folder `shared` next to the checkout or next to any folder above it;
//! `RPI_SHARED` names another place. Tests that need them skip loudly where they are missing:
//!
//! ```
//! let Some(nets) = rpi_testkit::shared_path("nets") else { return };
//! ```

use std::path::{Path, PathBuf};

use crate::workspace_root;

/// The folder of the data beside the project, if it is there.
pub fn shared_dir() -> Option<PathBuf> {
    if let Some(dir) = std::env::var_os("RPI_SHARED") {
        return Some(PathBuf::from(dir)).filter(|dir| is_shared(dir));
    }
    let root = workspace_root();
    let mut above = root.ancestors().skip(1);
    above.find_map(|dir| Some(dir.join("shared")).filter(|dir| is_shared(dir)))
}

/// A file or folder of the data beside the project. Where it is missing, says so and returns nothing:
/// the test then returns, skipped.
pub fn shared_path(relative: &str) -> Option<PathBuf> {
    let path = shared_dir()
        .map(|dir| dir.join(relative))
        .filter(|path| path.exists());
    if path.is_none() {
        report_skip(&format!("../shared/{relative} is not there"));
    }
    path
}

/// Says on standard error, past the test harness that captures prints, which test is skipped and why.
pub fn report_skip(reason: &str) {
    let thread = std::thread::current();
    let test = thread.name().unwrap_or("a test");
    let line = format!(
        "SKIPPED: {test}: {reason} (data beside the project; RPI_SHARED names another place)\n"
    );
    // Captured prints are shown for failing tests only, and a skipped test does not fail.
    let _ = std::io::Write::write_all(&mut std::io::stderr(), line.as_bytes());
}

fn is_shared(dir: &Path) -> bool {
    dir.join("README.md").is_file() && dir.join("nets").is_dir()
}
