//! Direction of the uses between the modules of this crate.

use std::fs;
use std::path::{Path, PathBuf};

#[test]
fn the_elaboration_does_not_use_the_checker() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/elab");
    for path in rust_files(&folder) {
        let text = fs::read_to_string(&path).unwrap();
        assert!(!text.contains("crate::check"), "{}", path.display());
    }
}

fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap();
    let mut files = Vec::new();
    for path in entries.map(|entry| entry.unwrap().path()) {
        match path.is_dir() {
            true => files.extend(rust_files(&path)),
            false => files.push(path),
        }
    }
    files
}
