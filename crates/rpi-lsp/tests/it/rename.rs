//! Renaming: in all programs of a project, with the conflicts that it must report.

use std::path::{Path, PathBuf};

use rpi_driver::{Compiled, compile, emit, read};
use rpi_testkit::{files_below, workspace_root};
use serde_json::{Value, json};

use crate::edits::{apply, changes};
use crate::support::{Session, connect, position, position_of};

/// Project in a temporary folder, opened by a session.
struct Project {
    dir: tempfile::TempDir,
    session: Session,
}

impl Project {
    fn new(files: &[(&str, &str)]) -> Project {
        let dir = tempfile::tempdir().unwrap();
        for (name, text) in files {
            std::fs::write(dir.path().join(name), text).unwrap();
        }
        let mut session = connect();
        let root = format!("file://{}", dir.path().display());
        let folder = json!({ "uri": root, "name": "project" });
        session
            .client
            .initialize_with(json!({ "capabilities": {}, "workspaceFolders": [folder] }));
        Project { dir, session }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }

    fn uri(&self, name: &str) -> String {
        format!("file://{}", self.path(name).display())
    }

    fn text(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap()
    }

    fn open(&mut self, name: &str) {
        let (uri, text) = (self.uri(name), self.text(name));
        self.session.client.open(&uri, &text);
    }

    /// Returns the response to the request to rename the name at a position.
    fn rename(&mut self, name: &str, position: &Value, new: &str) -> Value {
        let params = json!({
            "textDocument": { "uri": self.uri(name) },
            "position": position,
            "newName": new,
        });
        self.session.client.request("textDocument/rename", params)
    }

    /// Returns the message of the error with which a rename is rejected.
    #[track_caller]
    fn rejection(&mut self, name: &str, at: &str, new: &str) -> String {
        let position = position(&self.text(name), at, 0);
        let answer = self.rename(name, &position, new);
        let message = answer["error"]["message"].as_str();
        message.unwrap_or_else(|| panic!("{answer}")).to_owned()
    }
}

const PARTS: &str = "\
--| Twice the value, see [`twice`].
function twice (x: int) returns (y: int)
let
  y = 2 * x;
tel

const n: int = 3;
";

const MAIN: &str = "\
use parts;

node Main (a: int) returns (b: int)
var c: int;
let
  c = twice(x: a);
  b = twice(x: n) + c;
tel
";

const OTHER: &str = "\
use parts;

node Other (a: int) returns (b: int)
let
  b = parts::twice(a);
tel
";

const FILES: &[(&str, &str)] = &[
    ("parts.rpi", PARTS),
    ("main.rpi", MAIN),
    ("other.rpi", OTHER),
];

#[test]
fn a_rename_reaches_closed_files_links_and_argument_names() {
    let mut project = Project::new(FILES);
    project.open("parts.rpi");
    let at = position(PARTS, "twice (", 0);
    let answer = project.rename("parts.rpi", &at, "double");
    let edits = changes(&answer["result"]);
    assert_eq!(edits.len(), 3, "{answer}");
    for (name, old) in FILES {
        let uri = project.uri(name);
        let (_, edits) = edits.iter().find(|(of, _)| *of == uri).unwrap();
        assert_eq!(apply(old, edits), old.replace("twice", "double"), "{name}");
    }
    let at = position(PARTS, "x: int", 0);
    let answer = project.rename("parts.rpi", &at, "value");
    let edits = changes(&answer["result"]);
    let (_, main) = edits
        .iter()
        .find(|(uri, _)| uri.ends_with("main.rpi"))
        .unwrap();
    assert_eq!(apply(MAIN, main), MAIN.replace("x:", "value:"));
    assert!(edits.iter().all(|(uri, _)| !uri.ends_with("other.rpi")));
    project.session.shut_down().unwrap();
}

#[test]
fn references_are_found_in_closed_files() {
    let mut project = Project::new(FILES);
    project.open("parts.rpi");
    let params = json!({
        "textDocument": { "uri": project.uri("parts.rpi") },
        "position": position(PARTS, "twice (", 0),
        "context": { "includeDeclaration": false },
    });
    let found = project
        .session
        .client
        .result("textDocument/references", params);
    let found: Vec<&str> = found
        .as_array()
        .unwrap()
        .iter()
        .map(|one| one["uri"].as_str().unwrap())
        .collect();
    let count = |name: &str| found.iter().filter(|uri| uri.ends_with(name)).count();
    assert_eq!(
        (count("main.rpi"), count("other.rpi"), count("parts.rpi")),
        (2, 1, 0)
    );
    let symbols = project
        .session
        .client
        .result("workspace/symbol", json!({ "query": "oth" }));
    assert_eq!(symbols[0]["name"], "Other");
    project.session.shut_down().unwrap();
}

#[test]
fn a_rename_that_would_change_the_meaning_is_rejected_with_the_reason() {
    let mut project = Project::new(FILES);
    project.open("main.rpi");
    project.open("parts.rpi");
    let cases = [
        ("main.rpi", "c: int", "a", "error"),
        ("main.rpi", "c: int", "n", "conflicts"),
        ("main.rpi", "c: int", "if", "not a name"),
        ("main.rpi", "c: int", "two words", "not a name"),
        ("main.rpi", "c: int", "", "not a name"),
        ("parts.rpi", "n:", "twice", "error"),
        ("main.rpi", "parts;", "pieces", "rename the file"),
        ("main.rpi", "node", "other", "part of the language"),
    ];
    for (file, at, new, reason) in cases {
        let message = project.rejection(file, at, new);
        assert!(message.contains(reason), "{at} to `{new}`: {message}");
    }
    project.session.shut_down().unwrap();
}

const MOTION: &str = "\
use motion;

command Go (arm: Arm; there: Pose)
let
  way = Line(arm, there);
  arm.tcp = way.pose;
  finish at_end when way.done;
  fail stopped when way.stopped;
  fail stopped when arm.error;
tel

task Main (arm: Arm; home: Pose)
let
  again: Go(arm, home) on stopped then again;
tel
";

#[test]
fn names_of_the_library_and_of_files_are_rejected_before_typing() {
    let mut project = Project::new(&[("cell.rpi", MOTION)]);
    project.open("cell.rpi");
    for (at, reason) in [
        ("Line", "standard library"),
        ("done;", "standard library"),
        ("Arm;", "standard library"),
    ] {
        let params = json!({
            "textDocument": { "uri": project.uri("cell.rpi") },
            "position": position(MOTION, at, 0),
        });
        let answer = project
            .session
            .client
            .request("textDocument/prepareRename", params);
        let message = answer["error"]["message"].as_str().unwrap_or_default();
        assert!(message.contains(reason), "{at}: {answer}");
    }
    let params = json!({
        "textDocument": { "uri": project.uri("cell.rpi") },
        "position": position(MOTION, "way.done", 0),
    });
    let prepared = project
        .session
        .client
        .result("textDocument/prepareRename", params);
    assert_eq!(prepared["placeholder"], "way");
    project.session.shut_down().unwrap();
}

#[test]
fn a_result_is_renamed_in_all_its_statements() {
    let mut project = Project::new(&[("cell.rpi", MOTION)]);
    project.open("cell.rpi");
    let at = position(MOTION, "stopped then", 0);
    let answer = project.rename("cell.rpi", &at, "halted");
    let edits = changes(&answer["result"]);
    let new = apply(MOTION, &edits[0].1);
    let expected = MOTION
        .replace("fail stopped", "fail halted")
        .replace("on stopped", "on halted");
    assert_eq!(new, expected);
    project.session.shut_down().unwrap();
}

const HANDOVER: &str = "\
command Measure
let
  length = 20[mm] * (1.0 + time / 1[s]);
  export length;
  finish measured when time > 3[ms];
tel

command Cut given (length: real[m] = 5[mm])
let
  finish cut when length <= time * 1[m/s];
tel

task Both
let
  Measure();
  Cut();
tel
";

#[test]
fn values_that_a_command_takes_over_keep_the_name_of_the_export() {
    let mut project = Project::new(&[("cut.rpi", HANDOVER)]);
    project.open("cut.rpi");
    for at in ["length =", "length:", "length <="] {
        let position = position(HANDOVER, at, 0);
        let answer = project.rename("cut.rpi", &position, "size");
        let edits = changes(&answer["result"]);
        assert_eq!(
            apply(HANDOVER, &edits[0].1),
            HANDOVER.replace("length", "size"),
            "{at}"
        );
    }
    project.session.shut_down().unwrap();
}

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
            for (offset, old) in declared_names(&project.path(name), text) {
                seen += 1;
                if seen % step == 0 {
                    renamed += 1;
                    check_rename(&mut project, (name, text), (offset, &old), &before);
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
    (offset, old): (usize, &str),
    before: &[CompiledText],
) {
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
        let images = after.images.replace(SUFFIX, "");
        assert_eq!(
            first_difference(&before.images, &images, sorted_words),
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

/// Returns the words of a text in order, without the numbers of slots. Steps without a dependency between them are
/// ordered by the names in the program, so that a new name may change the order and the number of steps in a row.
fn sorted_words(text: &str) -> Vec<String> {
    let is_separator = |c: char| c.is_whitespace() || ",;()".contains(c);
    let is_slot = |word: &str| {
        let digits = word.trim_start_matches(['v', 'x', 's', 'c', '#', '%', '@']);
        digits.chars().all(|c| c.is_ascii_digit())
    };
    let plain = |word: &str| match word.split_once(':') {
        Some((slot, name)) if is_slot(slot) => name.to_owned(),
        _ => word.to_owned(),
    };
    let words = text.split(is_separator).map(plain);
    let mut words: Vec<String> = words
        .filter(|word| !is_slot(word) && !word.contains("::"))
        .collect();
    words.sort();
    words
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

/// Returns the place and the text of every name that a program declares and that can be renamed.
fn declared_names(path: &Path, text: &str) -> Vec<(usize, String)> {
    let seen = rpi_driver::inspect(path, text, &rpi_driver::DiskLoader);
    let defs = seen
        .index()
        .defs_in(rpi_diag::FileId(0))
        .map(|(_, def)| def);
    use rpi_sema::query::DefKind::{Module, Primitive, Test};
    let named = defs.filter(|def| !matches!(def.kind, Module | Primitive | Test));
    let mut names: Vec<(usize, String)> = named
        .map(|def| (def.span.start as usize, def.name.to_string()))
        .collect();
    names.sort();
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
