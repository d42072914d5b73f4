//! Incremental checks give exactly the diagnostics of a check from nothing, after any edit.
//!
//! Programs of the examples, of the standard library and of the other tests are edited at random. `RPI_INCREMENTAL_EDITS` is
//! the number of edits (the default is short), `RPI_INCREMENTAL_SEED` selects another sequence.

mod edits;

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use edits::{Random, edit};
use rpi_diag::FileId;
use rpi_driver::{CheckSession, DiskLoader, FileLoader, Inspection, inspect};
use rpi_testkit::files_below;

/// Number of edits of the short run.
const EDITS: usize = 160;

/// Number of edits of one program, one after the other.
const EDITS_PER_PROGRAM: usize = 16;

/// Files with changed texts; the others are on disk.
struct EditedFiles(RefCell<BTreeMap<PathBuf, String>>);

impl FileLoader for EditedFiles {
    fn text(&self, path: &Path) -> Option<String> {
        let changed = self.0.borrow().get(path).cloned();
        changed.or_else(|| DiskLoader.text(path))
    }
}

fn number(variable: &str, default: usize) -> usize {
    let given = std::env::var(variable).ok();
    given.and_then(|text| text.parse().ok()).unwrap_or(default)
}

/// Returns the programs that are edited. Every second one is an example, a module of the library or the cell beside this
/// test, because these are the longest.
fn programs() -> Vec<PathBuf> {
    let collect = |folders: &[&str]| -> Vec<PathBuf> {
        let files = folders
            .iter()
            .map(|folder| files_below(folder, &["rpi", "lus"]));
        files.flatten().collect()
    };
    let long = collect(&["crates/rpi-driver/tests/incremental", "examples", "stdlib"]);
    let short = collect(&["tests/ui", "tests/meaning", "tests/first-mistakes"]);
    let long = long.iter().cycle().cloned();
    short
        .into_iter()
        .zip(long)
        .flat_map(|(short, long)| [long, short])
        .collect()
}

/// Edits one program and the modules that it uses, and compares both checks after each edit.
fn edit_program(path: &Path, random: &mut Random, count: usize) {
    let mut text = std::fs::read_to_string(path).expect("a program");
    let mut history = vec![text.clone()];
    let (mut session, files) = (CheckSession::default(), EditedFiles(RefCell::default()));
    session.inspect(path, &text, &files);
    for k in 0..count {
        let whole = inspect(path, &text, &files);
        let others = whole
            .sources
            .files()
            .skip(1)
            .map(|id| whole.sources.name(id));
        let others: Vec<PathBuf> = others
            .map(PathBuf::from)
            .filter(|path| path.is_file())
            .collect();
        if !others.is_empty() && random.below(4) == 0 {
            let other = &others[random.below(others.len())];
            let old = files.text(other).unwrap_or_default();
            files
                .0
                .borrow_mut()
                .insert(other.clone(), edit(&old, random));
        } else if random.below(8) == 0 {
            text = history[random.below(history.len())].clone();
        } else {
            text = edit(&text, random);
        }
        history.push(text.clone());
        compare(&mut session, (path, &text), &files, k);
    }
}

fn compare(session: &mut CheckSession, (path, text): (&Path, &str), files: &EditedFiles, k: usize) {
    let (from_nothing, seen) = (
        inspect(path, text, files),
        session.inspect(path, text, files),
    );
    if k.is_multiple_of(EDITS_PER_PROGRAM / 2) {
        compare_types(&seen, &from_nothing);
    }
    let (expected, found) = (from_nothing.diagnostics, seen.diagnostics);
    if found == expected {
        return;
    }
    let kept = std::env::temp_dir().join("rpi-incremental-failure.rpi");
    std::fs::write(&kept, text).expect("a file in the temporary folder");
    let first = found.iter().zip(&expected).position(|(a, b)| a != b);
    let first = first.unwrap_or(found.len().min(expected.len()));
    panic!(
        "{} differs after edit {k}, text in {}:\n{} and {} diagnostics, the first different ones are\n{:#?}\nand from nothing\n{:#?}",
        path.display(),
        kept.display(),
        found.len(),
        expected.len(),
        found.get(first),
        expected.get(first),
    );
}

/// Compares the types of all flows of the edited file, which editors show.
fn compare_types(found: &Inspection, expected: &Inspection) {
    let all = |seen: &Inspection| -> Vec<String> {
        let defs = seen.index().defs_in(FileId(0));
        let types =
            defs.map(|(_, def)| format!("{} {:?} {:?}", def.name, def.span, seen.types_of(def)));
        types.collect()
    };
    assert_eq!(
        all(found),
        all(expected),
        "{}",
        found.sources.name(FileId(0))
    );
}

#[test]
fn incremental_checks_give_the_diagnostics_of_checks_from_nothing() {
    let edits = number("RPI_INCREMENTAL_EDITS", EDITS);
    let seed = number("RPI_INCREMENTAL_SEED", 1);
    let mut random = Random::new(seed as u64);
    let programs = programs();
    for _ in 0..edits.div_ceil(EDITS_PER_PROGRAM) {
        let path = &programs[random.below(programs.len())];
        edit_program(path, &mut random, EDITS_PER_PROGRAM);
    }
}
