//! Size limits that keep the code readable: short files, small types, short functions, and modules with a description.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use rpi_testkit::workspace_root;
use xtask::{TypePart, functions, packages, source_files, tracked_files, type_parts};

/// Maximum number of lines of a file.
const FILE_LINES: usize = 450;
/// Maximum number of methods of a type, in all its inherent `impl` blocks together.
const METHODS: usize = 40;
/// Maximum number of fields of a type.
const FIELDS: usize = 20;
/// Maximum number of lines of a function.
const FUNCTION_LINES: usize = 60;
/// Maximum of the median number of lines of a function's body.
const MEDIAN: usize = 8;
/// Maximum of the 95th percentile of the number of lines of a function's body.
const PERCENTILE_95: usize = 28;

#[test]
fn functions_are_short() {
    let mut lengths: Vec<usize> = Vec::new();
    for file in source_files() {
        lengths.extend(functions(file.without_tests()).iter().map(|f| f.body_lines));
    }
    lengths.sort_unstable();
    let (median, high) = (
        lengths[lengths.len() / 2],
        lengths[lengths.len() * 95 / 100],
    );
    let mut long: Vec<String> = Vec::new();
    for (path, text) in rust_files() {
        let functions = functions(&text);
        let longer = functions.iter().filter(|f| f.lines > FUNCTION_LINES);
        long.extend(longer.map(|f| format!("{}: {}: {} lines", path.display(), f.name, f.lines)));
    }
    assert_none("functions that are too long", &long);
    assert!(
        median <= MEDIAN,
        "half of all bodies have {median} lines or more"
    );
    assert!(
        high <= PERCENTILE_95,
        "one body of twenty has {high} lines or more"
    );
}

#[test]
fn files_hold_one_idea() {
    let lines = rust_files()
        .into_iter()
        .map(|(path, text)| (path, text.lines().count()));
    let long = lines.filter(|(_, lines)| *lines > FILE_LINES);
    let long: Vec<String> = long
        .map(|(path, lines)| format!("{}: {lines} lines", path.display()))
        .collect();
    assert_none("files that are too long", &long);
}

#[test]
fn types_have_few_fields_and_methods() {
    let mut large: Vec<String> = Vec::new();
    for ((crate_name, name, path), size) in type_sizes() {
        let limits = [
            (size.methods, METHODS, "methods"),
            (size.fields, FIELDS, "fields"),
        ];
        for (count, _, what) in limits.iter().filter(|(count, limit, _)| count > limit) {
            large.push(format!(
                "{crate_name}: {name} ({}): {count} {what}",
                path.display()
            ));
        }
    }
    assert_none("types that are too large", &large);
}

#[test]
fn modules_say_what_they_are_for() {
    let files = source_files();
    let undocumented = files.iter().filter(|f| !f.text.starts_with("//!"));
    let undocumented: Vec<String> = undocumented.map(|f| f.path.display().to_string()).collect();
    assert_none("modules without a `//!` comment", &undocumented);
}

fn assert_none(what: &str, found: &[String]) {
    assert!(
        found.is_empty(),
        "{} {what}:\n{}",
        found.len(),
        found.join("\n")
    );
}

/// Returns the Rust files of the repository with their texts. Generated code is not part of the repository.
fn rust_files() -> Vec<(PathBuf, String)> {
    let files = tracked_files().into_iter();
    let rust = files.filter(|path| path.extension().is_some_and(|extension| extension == "rs"));
    let read = rust.filter_map(|path| {
        let text = std::fs::read_to_string(workspace_root().join(&path)).ok()?;
        Some((path, text))
    });
    read.collect()
}

#[derive(Default)]
struct TypeSize {
    fields: usize,
    methods: usize,
}

/// Returns the size of each type by its crate, its name and the file of its declaration.
fn type_sizes() -> BTreeMap<(String, String, PathBuf), TypeSize> {
    let (files, packages) = (rust_files(), packages());
    let crate_name = |path: &Path| {
        let path = workspace_root().join(path);
        let owner = packages
            .iter()
            .find(|package| path.starts_with(&package.dir));
        owner.map_or_else(String::new, |package| package.name.clone())
    };
    let mut sizes: BTreeMap<(String, String, PathBuf), TypeSize> = BTreeMap::new();
    for (path, text) in &files {
        for part in type_parts(text) {
            if let TypePart::Declaration { name, fields } = part {
                let key = (crate_name(path), name.to_owned(), path.clone());
                let size = sizes.entry(key).or_default();
                size.fields = size.fields.max(fields);
            }
        }
    }
    for (path, text) in &files {
        let of_crate = crate_name(path);
        for part in type_parts(text) {
            if let TypePart::Methods { name, methods } = part {
                let mut declared = sizes
                    .iter_mut()
                    .filter(|((owner, declared, _), _)| *owner == of_crate && declared == name)
                    .collect::<Vec<_>>();
                declared.sort_by_key(|((_, _, file), _)| shared_folders(file, path));
                if let Some((_, size)) = declared.pop() {
                    size.methods += methods;
                }
            }
        }
    }
    sizes
}

/// Number of leading parts that two paths share: the declaration of a type is the one nearest to its methods.
fn shared_folders(a: &Path, b: &Path) -> usize {
    a.iter().zip(b.iter()).take_while(|(a, b)| a == b).count()
}
