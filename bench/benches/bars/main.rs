//! Benchmarks with limits: interpreter, loading, memory and takeovers, compared with reference values in one run.
//!
//! `cargo bench -p rpi-bench --bench bars [-- NAME...]` prints one table; each NAME selects the rows that contain it.

mod emitted_c;
mod inactive;
mod interpreter;
mod loading;
mod memory;
mod recorded;
mod takeover;

use rpi_bench::table::Table;
use std::path::Path;

/// Nanoseconds in a millisecond.
const MS: u64 = 1_000_000;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [mode, path, cycles] = &arguments[..]
        && mode == inactive::CHILD
    {
        return inactive::run_cycles(Path::new(path), cycles.parse().unwrap_or(0));
    }
    if let [mode, path, rounds, switches] = &arguments[..]
        && mode == takeover::CHILD
    {
        let rounds = rounds.parse().unwrap_or(0);
        return takeover::run_rounds(Path::new(path), rounds, switches == "true");
    }
    if let [mode, path] = &arguments[..]
        && mode == memory::CHILD
    {
        return memory::load_and_print(Path::new(path));
    }
    let names = arguments.into_iter().filter(|a| !a.starts_with('-'));
    let mut table = Table::new(names.collect());
    interpreter::rows(&mut table);
    emitted_c::rows(&mut table);
    recorded::rows(&mut table);
    inactive::rows(&mut table);
    takeover::rows(&mut table);
    loading::rows(&mut table);
    memory::rows(&mut table);
    table.print();
}

/// Calls a function with the path of a new temporary folder, which is deleted afterwards. Returns `None` if the folder
/// cannot be created or the function fails.
fn with_temp_dir<T, E>(with: impl FnOnce(&Path) -> Result<T, E>) -> Option<T> {
    let dir = tempfile::tempdir().ok()?;
    with(dir.path()).ok()
}

/// Returns the text of a file of the external test data, decompressed if necessary; `None` if the data are not
/// available.
fn read_shared(path: &str) -> Option<String> {
    rpi_testkit::read_maybe_gz(rpi_testkit::external_data_path(path)?).ok()
}
