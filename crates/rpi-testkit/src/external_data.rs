//! External test data: nets and traces that are too large or not licensed for the repository.
//!
//! They are expected in a folder `shared` next to the checkout or next to one of its parent folders; `RPI_SHARED`
//! overrides the location. Tests that need the data are skipped with a message if it is missing:
//!
//! ```
//! let Some(nets) = rpi_testkit::external_data_path("nets") else { return };
//! ```

use std::path::{Path, PathBuf};

use crate::workspace_root;

/// Returns the folder of the external test data (nets and traces outside of the repository); `None` if it does not
/// exist.
pub fn external_data_dir() -> Option<PathBuf> {
    if let Some(dir) = std::env::var_os("RPI_SHARED") {
        return Some(PathBuf::from(dir)).filter(|dir| is_shared(dir));
    }
    let root = workspace_root();
    let mut above = root.ancestors().skip(1);
    above.find_map(|dir| Some(dir.join("shared")).filter(|dir| is_shared(dir)))
}

/// Returns the path of a file or folder of the external test data. `relative` is its path in the folder of that data.
/// If it is missing, prints a message and returns `None`, so that the test can return.
pub fn external_data_path(relative: &str) -> Option<PathBuf> {
    let path = external_data_dir()
        .map(|dir| dir.join(relative))
        .filter(|path| path.exists());
    if path.is_none() {
        report_skip(&format!("../shared/{relative} not found"));
    }
    path
}

/// Prints the name of the running test and the reason why it is skipped to standard error, even if the test harness
/// captures output.
pub fn report_skip(reason: &str) {
    let thread = std::thread::current();
    let test = thread.name().unwrap_or("a test");
    let line = format!(
        "SKIPPED: {test}: {reason} (external test data; RPI_SHARED overrides its location)\n"
    );
    // Captured output is shown for failing tests only, and a skipped test does not fail.
    let _ = std::io::Write::write_all(&mut std::io::stderr(), line.as_bytes());
}

fn is_shared(dir: &Path) -> bool {
    dir.join("README.md").is_file() && dir.join("nets").is_dir()
}
