//! Renaming: in all programs of a project, with the conflicts that it must report.

use std::path::PathBuf;

use serde_json::{Value, json};

use crate::edits::{apply, changes};
use crate::support::{Session, connect, position};

/// Project in a temporary folder, opened by a session.
pub(crate) struct Project {
    pub(crate) dir: tempfile::TempDir,
    pub(crate) session: Session,
}

impl Project {
    pub(crate) fn new(files: &[(&str, &str)]) -> Project {
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

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }

    fn uri(&self, name: &str) -> String {
        format!("file://{}", self.path(name).display())
    }

    fn text(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap()
    }

    pub(crate) fn open(&mut self, name: &str) {
        let (uri, text) = (self.uri(name), self.text(name));
        self.session.client.open(&uri, &text);
    }

    /// Returns the response to the request to rename the name at a position.
    pub(crate) fn rename(&mut self, name: &str, position: &Value, new: &str) -> Value {
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
