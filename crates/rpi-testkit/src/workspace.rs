//! Paths within the checkout.

use std::path::{Path, PathBuf};

/// Returns the path of the root folder of the workspace in which the tests were compiled.
pub fn workspace_root() -> PathBuf {
    let crate_dir = Path::new(env!("CARGO_MANIFEST_DIR"));
    crate_dir.ancestors().nth(2).unwrap_or(crate_dir).to_owned()
}

/// Returns all files below the folder `dir` (relative to the root of the workspace) whose names end in one of
/// `extensions`, sorted by path. Build output, installed packages and hidden folders are skipped; a missing folder has no files.
pub fn files_below(dir: &str, extensions: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    collect(&workspace_root().join(dir), extensions, &mut found);
    found.sort();
    found
}

fn collect(dir: &Path, extensions: &[&str], found: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(dir) else {
        return;
    };
    for path in entries.flatten().map(|entry| entry.path()) {
        let name = path
            .file_name()
            .and_then(|name| name.to_str())
            .unwrap_or("");
        let is_skipped = name.starts_with('.') || ["target", "node_modules"].contains(&name);
        if path.is_dir() && !is_skipped {
            collect(&path, extensions, found);
        } else if extensions.iter().any(|extension| name.ends_with(extension)) {
            found.push(path);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_root_holds_the_workspace() {
        let manifest = std::fs::read_to_string(workspace_root().join("Cargo.toml")).unwrap();
        assert!(manifest.contains("[workspace]"));
    }

    #[test]
    fn files_are_found_sorted_and_build_output_is_left_out() {
        let found = files_below("", &["Cargo.toml"]);
        assert!(found.windows(2).all(|pair| pair[0] < pair[1]));
        assert!(found.contains(&workspace_root().join("crates/rpi-testkit/Cargo.toml")));
        assert!(found.iter().all(|path| {
            !path
                .strip_prefix(workspace_root())
                .unwrap()
                .starts_with("target")
        }));
        assert!(files_below("no-such-folder", &["rs"]).is_empty());
    }
}
