//! `rpic test`: tests contained in programs, and the explanation pages of the codes that it reports.

use std::process::{Command, Output};

fn rpic(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_rpic"))
        .args(args)
        .env("NO_COLOR", "1")
        .output()
        .unwrap()
}

/// Runs the tests of a program.
fn run(program: &str, options: &[&str]) -> (Option<i32>, String) {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("program.rpi");
    std::fs::write(&path, program).unwrap();
    let path = path.display().to_string();
    let output = rpic(&[&["test", &path], options].concat());
    let text = [output.stdout, output.stderr].concat();
    let text = String::from_utf8_lossy(&text).replace(&path, "program.rpi");
    (output.status.code(), text)
}

const LAMP: &str = include_str!("data/lamp.rpi");

#[test]
fn a_test_that_holds_passes() {
    let (status, text) = run(LAMP, &[]);
    assert_eq!(status, Some(0), "{text}");
    assert!(
        text.contains("ok   program.rpi: a push switches the lamp on (5 cycles)"),
        "{text}"
    );
    assert!(text.contains("2 passed, 0 failed"), "{text}");
}

#[test]
fn a_claim_that_does_not_hold_is_shown_with_cycle_and_values() {
    let (status, text) = run(&LAMP.replace("level <= 0.35", "level <= 0.25"), &[]);
    assert_eq!(status, Some(1), "{text}");
    for part in ["RPI9001", "in cycle 3", "level = 0.3", "1 passed, 1 failed"] {
        assert!(text.contains(part), "{part} in {text}");
    }
}

#[test]
fn tests_are_chosen_by_title() {
    let (status, text) = run(LAMP, &["--filter", "goes out"]);
    assert_eq!(status, Some(0), "{text}");
    assert!(
        text.contains("1 passed, 0 failed, 1 filtered out"),
        "{text}"
    );
}

#[test]
fn coverage_names_what_was_not_seen() {
    let (_, all) = run(LAMP, &["--coverage"]);
    assert!(
        all.contains("coverage: 2 of 2 fragments, 2 of 2 branches, 1 of 2 transitions"),
        "{all}"
    );
    let (_, part) = run(LAMP, &["--coverage", "--filter", "goes out"]);
    assert!(part.contains("never active: lamp.On"), "{part}");
}

/// Returns the coverage report of a program whose tests pass.
#[track_caller]
fn covered(program: &str) -> Vec<String> {
    let (status, text) = run(program, &["--coverage"]);
    assert_eq!(status, Some(0), "{text}");
    let failures = text.lines().filter(|line| !line.starts_with("ok"));
    failures.map(str::to_owned).collect()
}

#[test]
fn transitions_count_where_they_are_taken() {
    let expected = [
        "coverage: 5 of 6 fragments, 0 of 0 branches, 3 of 6 transitions",
        "  never active: k.Locked/k.Out",
        "  `open and n > 3 then Wide` never taken: program.rpi:8:13",
        "  `not open continue Shut` never taken: program.rpi:14:13",
        "  `n > 100 then Out` never taken: program.rpi:20:19",
        "2 passed, 0 failed",
    ];
    assert_eq!(covered(include_str!("data/gate.rpi")), expected);
}

/// Two automata of one body, and the same automaton in two calls, are counted separately.
#[test]
fn automata_beside_one_another_have_transitions_of_their_own() {
    let expected = [
        "coverage: 4 of 4 fragments, 0 of 0 branches, 3 of 3 transitions",
        "1 passed, 0 failed",
    ];
    assert_eq!(covered(include_str!("data/automata.rpi")), expected);
}

/// A choice by a constant or a static parameter counts like any other. Items inside a branch are counted while the
/// branch is taken. `->` and the choices of the test itself do not count. Units that no test calls are listed.
#[test]
fn branches_count_where_they_matter() {
    let expected = [
        "coverage: 1 of 4 fragments, 5 of 14 branches, 0 of 3 transitions",
        "  never active: s.Rest",
        "  `else` never taken: program.rpi:5:7",
        "  `then` never taken: program.rpi:6:14",
        "  `then` never taken: program.rpi:6:27",
        "  `else` never taken: program.rpi:6:27",
        "  `then` never taken: program.rpi:13:7",
        "  `then` never taken: program.rpi:18:29",
        "  `else` never taken: program.rpi:18:29",
        "  `fast then Rest` never taken: program.rpi:17:13",
        "  never called: node Never: program.rpi:23:6",
        "1 passed, 0 failed",
    ];
    assert_eq!(covered(include_str!("data/reach.rpi")), expected);
}

#[test]
fn a_fault_is_shown_where_it_happened() {
    let program =
        "test \"a ratio\"\nlet\n  n = 2 -> pre n - 1;\n  q = 6 div n;\n  assert q >= 0;\ntel\n";
    let (status, text) = run(program, &[]);
    assert_eq!(status, Some(1));
    for part in [
        "RPI9003",
        "integer division by zero, in cycle 2",
        "program.rpi:4:7",
    ] {
        assert!(text.contains(part), "{part} in {text}");
    }
}

#[test]
fn findings_of_tests_come_in_other_forms_too() {
    let (_, text) = run(
        &LAMP.replace("level <= 0.35", "level <= 0.25"),
        &["--format", "short"],
    );
    assert!(text.contains("error RPI9001"), "{text}");
}

#[test]
fn pages_of_failing_tests_say_what_happens() {
    for code in ["RPI9001", "RPI9002", "RPI9003"] {
        let page = String::from_utf8(rpic(&["explain", code]).stdout).unwrap();
        let (status, text) = run(fence(&page, "rpi-wrong test"), &[]);
        assert_eq!(status, Some(1), "{text}");
        assert_eq!(text.matches("error RPI").count(), 1, "{text}");
        assert!(text.contains(code), "{text}");
        let (status, text) = run(fence(&page, "rpi-right test"), &[]);
        assert_eq!(status, Some(0), "{text}");
    }
}

/// Returns the program in a fenced block of a Markdown text.
fn fence<'p>(page: &'p str, info: &str) -> &'p str {
    let (_, rest) = page
        .split_once(&format!("```{info}\n"))
        .expect("the page has it");
    rest.split_once("```").expect("it is closed").0
}

/// Runs the tests of the language semantics and of the library, which are written in RPI.
#[test]
fn what_programs_claim_of_language_and_library_holds() {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
    let mut paths = Vec::new();
    for folder in ["tests/meaning", "stdlib"] {
        let entries = std::fs::read_dir(format!("{root}/{folder}")).unwrap();
        paths.extend(entries.map(|entry| entry.unwrap().path().display().to_string()));
    }
    paths.sort();
    let paths: Vec<&str> = paths.iter().map(String::as_str).collect();
    let output = rpic(&[&["test"], &paths[..]].concat());
    let stdout = String::from_utf8_lossy(&output.stdout);
    let why = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{stdout}{why}");
    let count = stdout
        .lines()
        .filter(|line| line.starts_with("ok "))
        .count();
    assert!(count >= 20, "only {count} tests");
}

#[test]
fn other_forms_are_one_document() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.rpi");
    let test = |title: &str| {
        format!("test \"{title}\" let assert time < 0[s]; finish done when time > 2[ms]; tel\n")
    };
    std::fs::write(&path, test("one") + &test("two")).unwrap();
    let path = path.to_str().unwrap();
    let output = rpic(&["test", path, "--format", "json", "--coverage"]);
    assert_eq!(output.status.code(), Some(1));
    let document: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(document["findings"].as_array().map(Vec::len), Some(2));
}
