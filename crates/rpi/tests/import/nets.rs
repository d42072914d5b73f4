//! Lists of the recorded nets, and parallel processing of them.

use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Returns all nets in a shared folder by name; none if the folder does not exist.
pub(crate) fn below(folder: &str) -> Vec<PathBuf> {
    let Some(folder) = rpi_testkit::external_data_path("nets").map(|nets| nets.join(folder)) else {
        return Vec::new();
    };
    let files = folder.read_dir().expect("a folder of nets");
    let mut paths: Vec<PathBuf> = files.map(|file| file.expect("a file").path()).collect();
    paths.retain(|path| name(path).ends_with(".rpinet.gz"));
    paths.sort();
    assert!(!paths.is_empty(), "{} holds no nets", folder.display());
    paths
}

/// Returns the name of a file.
pub(crate) fn name(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default();
    name.to_string_lossy().into_owned()
}

/// Applies `f` to all items on all processors and returns the results in order. The last items of the folders take
/// longest and start first.
pub(crate) fn in_parallel<T: Sync, R: Send>(items: &[T], f: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let next = AtomicUsize::new(0);
    let done = Mutex::new(Vec::new());
    let work = || {
        while let Some(k) = items
            .len()
            .checked_sub(1 + next.fetch_add(1, Ordering::Relaxed))
        {
            let result = f(&items[k]);
            done.lock().expect("no thread failed").push((k, result));
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(2, usize::from) {
            scope.spawn(work);
        }
    });
    let mut done = done.into_inner().expect("no thread failed");
    done.sort_by_key(|(k, _)| *k);
    done.into_iter().map(|(_, result)| result).collect()
}

/// Panics with all errors if there are any.
pub(crate) fn none_wrong(paths: &[PathBuf], outcomes: Vec<Result<(), String>>) {
    let all = paths.iter().zip(outcomes);
    let wrong: Vec<String> = all
        .filter_map(|(path, outcome)| Some(format!("{}: {}", name(path), outcome.err()?)))
        .collect();
    let (few, many) = (wrong.len(), paths.len());
    assert!(
        wrong.is_empty(),
        "{few} of {many} nets\n{}",
        wrong.join("\n")
    );
}
