//! Renaming of the names of real programs, one at a time: the programs compile to the same images.

use std::path::{Path, PathBuf};

use rpi_driver::{Compiled, compile, emit, read};
use rpi_testkit::{files_below, workspace_root};

use crate::edits::{apply, changes};
use crate::rename::Project;
use crate::support::position_of;

/// Suffix of the new names, which no program contains.
const SUFFIX: &str = "_zq";

/// Number of names of which one is renamed, in the order of the programs. `RPI_ALL_NAMES=1` renames every one, which
/// takes several minutes.
const SAMPLE: usize = 40;

/// Every name of every example and of the library, one at a time: the project compiles to the same units and images but
/// for the renamed name.
#[test]
fn renamed_programs_compile_to_the_same_images() {
    let step = match std::env::var_os("RPI_ALL_NAMES") {
        Some(_) => 1,
        None => SAMPLE,
    };
    let (mut seen, mut renamed) = (0, 0);
    for folder in project_folders() {
        let files = files_in(&folder);
        let texts: Vec<(String, String)> = files.iter().map(|path| named_text(path)).collect();
        let texts: Vec<(&str, &str)> = texts
            .iter()
            .map(|(a, b)| (a.as_str(), b.as_str()))
            .collect();
        let mut project = Project::new(&texts);
        let before = images(project.dir.path());
        for (name, text) in texts.iter().filter(|(name, _)| name.ends_with(".rpi")) {
            project.open(name);
            for declared in declared_names(&project.path(name), text) {
                seen += 1;
                if seen % step == 0 {
                    renamed += 1;
                    check_rename(&mut project, (name, text), &declared, &before);
                }
            }
        }
        project.session.shut_down().unwrap();
    }
    assert!(renamed > 20, "{renamed} of {seen} names");
    println!("{renamed} of {seen} names renamed");
}

fn check_rename(
    project: &mut Project,
    (file, text): (&str, &str),
    declared: &DeclaredName,
    before: &[CompiledText],
) {
    let (offset, old) = (declared.offset, &declared.text);
    let new = format!("{old}{SUFFIX}");
    let answer = project.rename(file, &position_of(text, offset), &new);
    assert!(
        answer.get("error").is_none(),
        "{file}: `{old}` at {offset}: {answer}"
    );
    let mut kept = Vec::new();
    for (uri, edits) in changes(&answer["result"]) {
        let path = PathBuf::from(uri.strip_prefix("file://").unwrap());
        let text = std::fs::read_to_string(&path).unwrap();
        std::fs::write(&path, apply(&text, &edits)).unwrap();
        kept.push((path, text));
    }
    assert!(!kept.is_empty(), "{file}: `{old}` at {offset} has no edits");
    let after = images(project.dir.path());
    for (path, text) in kept {
        std::fs::write(path, text).unwrap();
    }
    let place = format!("after the rename of `{old}` at {offset} in {file}");
    assert_eq!(before.len(), after.len(), "{place}");
    for (before, after) in before.iter().zip(&after) {
        let units = after.units.replace(SUFFIX, "");
        assert_eq!(
            first_difference(&before.units, &units, sorted_lines),
            None,
            "units {place}"
        );
        if declared.is_device {
            continue;
        }
        let images = after.images.replace(SUFFIX, "");
        assert_eq!(
            first_difference(&before.images, &images, sorted_names),
            None,
            "images {place}"
        );
    }
}

/// Returns the first parts of two texts that differ; an empty part if one text has more of them.
fn first_difference(
    before: &str,
    after: &str,
    parts: fn(&str) -> Vec<String>,
) -> Option<(String, String)> {
    let (mut before, mut after) = (parts(before), parts(after));
    let length = before.len().max(after.len());
    before.resize(length, String::new());
    after.resize(length, String::new());
    before.into_iter().zip(after).find(|(a, b)| a != b)
}

/// Returns the lines of a text in order: some tables are sorted by name.
fn sorted_lines(text: &str) -> Vec<String> {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    lines.sort();
    lines
}

/// Returns the distinct names in the text of an image, in order, without the numbers of slots. Steps without a dependency
/// between them are ordered by the names in the program, so that a new name may change the order, and how many steps form
/// a row.
fn sorted_names(text: &str) -> Vec<String> {
    let is_separator = |c: char| !c.is_alphanumeric() && !matches!(c, '_' | '\'');
    let is_slot = |word: &str| word.chars().skip(1).all(|c| c.is_ascii_digit());
    let words = text.split(is_separator).filter(|word| !is_slot(word));
    let names: std::collections::BTreeSet<String> = words.map(str::to_owned).collect();
    names.into_iter().collect()
}

fn project_folders() -> Vec<PathBuf> {
    let root = workspace_root();
    let files = files_below("examples", &[".rpi"]);
    let mut folders: Vec<PathBuf> = files
        .iter()
        .map(|path| path.parent().unwrap().to_owned())
        .collect();
    folders.push(root.join("stdlib"));
    folders.sort();
    folders.dedup();
    folders
}

fn files_in(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> = entries.filter(|path| path.is_file()).collect();
    files.sort();
    files
}

fn named_text(path: &Path) -> (String, String) {
    let name = path.file_name().unwrap().to_string_lossy().into_owned();
    (name, std::fs::read_to_string(path).unwrap())
}

/// Name that a program declares.
struct DeclaredName {
    offset: usize,
    text: String,
    /// True for a parameter of a device type. A command that is run directly uses the device of the same name, so that
    /// its image is that of another device after a rename.
    is_device: bool,
}

/// Returns every name that a program declares and that can be renamed, in text order.
fn declared_names(path: &Path, text: &str) -> Vec<DeclaredName> {
    use rpi_sema::query::Def;
    use rpi_sema::query::DefKind::{Device, Module, Param, Primitive, Test};
    let seen = rpi_driver::inspect(path, text, &rpi_driver::DiskLoader);
    let index = seen.index();
    let defs = index.defs_in(rpi_diag::FileId(0)).map(|(_, def)| def);
    // The ports of a primitive have the names of its declaration in the core.
    let is_of_primitive = |def: &Def| {
        def.parent
            .is_some_and(|parent| index.def(parent).kind == Primitive)
    };
    let named =
        defs.filter(|def| !matches!(def.kind, Module | Primitive | Test) && !is_of_primitive(def));
    let is_device_type = |ty| {
        let names = index.references_in(ty);
        names
            .first()
            .is_some_and(|name| index.def(name.def).kind == Device)
    };
    let names = named.map(|def| DeclaredName {
        offset: def.span.start as usize,
        text: def.name.to_string(),
        is_device: def.kind == Param && def.ty.is_some_and(is_device_type),
    });
    let mut names: Vec<DeclaredName> = names.collect();
    names.sort_by_key(|name| name.offset);
    names
}

/// Program after compilation, as text: its typed units, and the images of its commands and tests.
struct CompiledText {
    units: String,
    images: String,
}

/// Compiles all programs in a folder, in the order of their names.
fn images(folder: &Path) -> Vec<CompiledText> {
    let files = files_in(folder).into_iter();
    let programs = files.filter(|path| path.extension().is_some_and(|e| e == "rpi"));
    let text = |path: PathBuf| {
        let input = read(&path).unwrap();
        let compiled: Compiled = compile(&input).unwrap();
        let faults = &compiled.diagnostics;
        assert!(!compiled.has_errors(), "{}: {faults:?}", path.display());
        let tests = compiled.tests.iter().map(|test| &test.net);
        let nets = compiled.nets().iter().chain(tests);
        CompiledText {
            units: emit::typed(&input).unwrap(),
            images: nets
                .map(|net| emit::image(net, 1_000_000).unwrap())
                .collect(),
        }
    };
    programs.map(text).collect()
}
