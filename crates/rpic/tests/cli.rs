//! Command line interface of the compiler: arguments in; text, files and exit status out.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

const PROGRAM: &str = "\
--| Twice what came in, one cycle late.
node late (x: real) returns (y: real)
let
  y = 0.0 -> pre (2.0 * x);
tel
";
const UNTIDY: &str = "node late(x:real)returns(y:real)let y=0.0->pre(2.0*x);tel";
const WRONG: &str = "node f (x: real) returns (y: real)\nlet\n  y = a + x;\n  a = y;\ntel\n";
const FIXABLE: &str = "// a comment\nnode f (x: real) returns (y: real)\nlet\n  y = x;\ntel\n";
const NET: &str = "{a=Core::Clock(Increment='1'),b=Core::DoubleAdd(inFirst=a.outValue,Second='1')}";

fn rpic(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_rpic"))
        .args(args)
        .env("NO_COLOR", "1")
        .output()
        .unwrap()
}

fn out(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn err(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Creates a folder with one file, and returns the path of the file.
fn file(name: &str, text: &str) -> (tempfile::TempDir, String) {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join(name);
    std::fs::write(&path, text).unwrap();
    let path = path.display().to_string();
    (dir, path)
}

fn example(name: &str) -> String {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    path.join(name).display().to_string()
}

#[test]
fn a_program_in_order_is_checked_in_silence() {
    let (_dir, path) = file("late.rpi", PROGRAM);
    let output = rpic(&["check", &path]);
    assert_eq!(output.status.code(), Some(0), "{}", err(&output));
    assert_eq!(err(&output), "");
}

#[test]
fn a_ring_is_drawn_and_ends_with_1() {
    let (_dir, path) = file("ring.rpi", WRONG);
    let output = rpic(&["check", &path]);
    assert_eq!(output.status.code(), Some(1));
    let text = err(&output);
    for part in [
        "RPI4001",
        "`y` reads `a` here",
        "`a` reads `y` here",
        "fix:",
    ] {
        assert!(text.contains(part), "{part} in {text}");
    }
}

#[test]
fn a_result_does_not_replace_what_it_is_made_of() {
    let (_dir, path) = file("late.rpi", PROGRAM);
    for args in [
        ["compile", "--emit=ast", &path, "-o", &path],
        ["compile", "--emit=tokens", &path, "-o", &path],
    ] {
        let output = rpic(&args);
        assert_eq!(output.status.code(), Some(2));
        assert!(
            err(&output).contains("this is the input"),
            "{}",
            err(&output)
        );
    }
    let (_dir, net) = file("clock.rpinet", NET);
    for task in ["compile", "import", "graph"] {
        let output = rpic(&[task, &net, "-o", &net]);
        assert_eq!(output.status.code(), Some(2), "{task}: {}", err(&output));
    }
    assert_eq!(std::fs::read_to_string(&path).unwrap(), PROGRAM);
    assert_eq!(std::fs::read_to_string(&net).unwrap(), NET);
}

#[test]
fn findings_come_in_the_form_that_was_asked_for() {
    let (_dir, path) = file("ring.rpi", WRONG);
    let form = |name| out(&rpic(&["check", "--format", name, &path]));
    let json: serde_json::Value = serde_json::from_str(&form("json")).expect("JSON");
    assert!(json.to_string().contains("RPI4001"));
    let sarif: serde_json::Value = serde_json::from_str(&form("sarif")).expect("SARIF is JSON");
    assert_eq!(sarif["version"], "2.1.0");
    assert!(form("github").starts_with("::error "), "{}", form("github"));
    assert!(form("short").contains("ring.rpi:4:7"), "{}", form("short"));
}

#[test]
fn sure_fixes_are_applied() {
    let (_dir, path) = file("near.rpi", FIXABLE);
    let output = rpic(&["check", "--fix", &path]);
    assert_eq!(output.status.code(), Some(0), "{}", err(&output));
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.starts_with("-- a comment"), "{text}");
}

#[test]
fn analyses_tell_what_they_found() {
    let output = rpic(&["check", "--explain-analysis", &example("first/first.rpi")]);
    assert_eq!(output.status.code(), Some(0), "{}", err(&output));
    let text = out(&output) + &err(&output);
    for analysis in ["presence", "schedule"] {
        assert!(text.contains(analysis), "{analysis} in {text}");
    }
}

/// Operations that are proved safe are not listed: divisors that a condition or a subrange keeps from 0, counters (also
/// those compared with an input or in a fragment with a condition), indices.
const CAN_FAULT: &str = "\
type Slot = subrange [1, 4] of int;
node Safe (s: Slot; x: int; a: int^5) returns (p, q, r, n, e: int)
let
  p = if a[s] > 0 then 100 div s else 0;
  q = if x = 0 then 0 else 100 div x;
  r = if x > 0 and x < 5 then a[x] else 0;
  n = 0 -> pre n + 1;
  e = (0 -> pre e + s) mod 7;
tel
node Counters (x: int) returns (m, k, f: int)
let
  m = 0 -> if x > pre m then pre m + 2 else pre m;
  k = m * 2;
  fragment Above when x > 0
  let n = 0 -> pre n + 3; tel
  f = (Above.n ?? 0) + 1;
tel
node Unsafe (x, y: int; u: real; a: int^5) returns (p, q, r, s: int; t: Slot)
let
  p = x + y;
  q = if x > 0 then 100 div y else 0;
  r = a[x];
  s = int u;
  t = y;
tel
";

#[test]
fn operations_that_can_fault_are_listed_by_place() {
    let (_dir, path) = file("faults.rpi", CAN_FAULT);
    let output = rpic(&["check", "--explain-analysis", &path]);
    let text = out(&output);
    let places = text
        .lines()
        .filter_map(|line| line.split_once("faults.rpi:"));
    let places: Vec<&str> = places.map(|(_, place)| place).collect();
    let expected = [
        "2:12: value outside of its subrange",
        "20:7: integer overflow",
        "21:21: division by zero, only where it is needed",
        "22:7: index outside of the array",
        "23:7: conversion of a real that has no integer value",
        "24:7: value outside of its subrange",
    ];
    assert_eq!(places, expected, "{text}");
}

#[test]
fn formatting_is_checked_done_and_done_once() {
    let (_dir, path) = file("untidy.rpi", UNTIDY);
    let checked = rpic(&["fmt", "--check", &path]);
    assert_eq!(checked.status.code(), Some(1));
    assert_eq!(std::fs::read_to_string(&path).unwrap(), UNTIDY);
    let changes = out(&checked);
    let first = UNTIDY.lines().next().unwrap_or_default();
    assert!(changes.contains(&format!("\n-{first}\n")), "{changes}");
    assert_eq!(rpic(&["fmt", &path]).status.code(), Some(0));
    assert_eq!(rpic(&["fmt", "--check", &path]).status.code(), Some(0));
    let tidy = std::fs::read_to_string(&path).unwrap();
    assert_eq!(out(&through_fmt(UNTIDY, &[])), tidy);
    let (_dir, path) = file("windows.rpi", &tidy.replace('\n', "\r\n"));
    assert_eq!(rpic(&["fmt", "--check", &path]).status.code(), Some(0));
    for line in tidy.lines().filter(|line| !UNTIDY.contains(line)) {
        assert!(changes.contains(&format!("\n+{line}\n")), "{changes}");
    }
}

#[test]
fn the_name_of_standard_input_tells_its_language() {
    const LUSTRE: &str = "node f (x: int) returns (y: int)\nlet\n  y = x % 2;\ntel\n";
    assert_ne!(through_fmt(LUSTRE, &[]).status.code(), Some(0));
    let named = through_fmt(LUSTRE, &["--stdin-name", "src/old.lus"]);
    assert!(out(&named).contains("y = x mod 2;"), "{}", err(&named));
}

/// Returns the output of `rpic fmt --stdin` for a text.
fn through_fmt(text: &str, options: &[&str]) -> Output {
    let mut child = Command::new(env!("CARGO_BIN_EXE_rpic"))
        .args(["fmt", "--stdin"])
        .args(options)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = child.stdin.take().unwrap();
    stdin.write_all(text.as_bytes()).unwrap();
    drop(stdin);
    child.wait_with_output().unwrap()
}

#[test]
fn a_text_that_cannot_be_read_is_not_formatted() {
    let text = "node f (";
    let (_dir, path) = file("broken.rpi", text);
    let output = rpic(&["fmt", &path]);
    assert_ne!(output.status.code(), Some(0));
    assert!(err(&output).contains("RPI0"), "{}", err(&output));
    assert_eq!(std::fs::read_to_string(&path).unwrap(), text);
}

#[test]
fn every_form_can_be_shown() {
    let program = example("first/first.rpi");
    let forms = [
        "tokens", "ast", "typed", "net", "schedule", "image", "dot", "mermaid", "rpinet", "c",
    ];
    for form in forms {
        let output = rpic(&["compile", &program, "--emit", form]);
        assert_eq!(output.status.code(), Some(0), "{form}: {}", err(&output));
        assert!(!out(&output).is_empty(), "{form}");
    }
}

#[test]
fn an_image_is_written_where_it_was_asked_for() {
    let dir = tempfile::tempdir().unwrap();
    let image = dir.path().join("first.rpib");
    let args = ["compile", &example("first/first.rpi"), "-o"];
    let output = rpic(&[&args[..], &[&image.display().to_string()]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", err(&output));
    assert!(rpi_image::Image::from_bytes(&std::fs::read(&image).unwrap()).is_ok());
}

#[test]
fn of_several_commands_one_is_to_be_chosen() {
    let dir = tempfile::tempdir().unwrap();
    let image = dir.path().join("blending.rpib").display().to_string();
    let program = example("blending/blending.rpi");
    let output = rpic(&["compile", &program, "-o", &image]);
    assert_eq!(output.status.code(), Some(2));
    assert!(err(&output).contains("MoveToA, MoveToC, MoveToE"));
    let output = rpic(&["compile", &program, "--command", "MoveToC", "-o", &image]);
    assert_eq!(output.status.code(), Some(0), "{}", err(&output));
    assert!(Path::new(&image).is_file());
}

#[test]
fn a_net_becomes_a_program_that_compiles() {
    let (dir, path) = file("small.rpinet", NET);
    let program = dir.path().join("small.rpi").display().to_string();
    let output = rpic(&["import", &path, "-o", &program]);
    assert_eq!(output.status.code(), Some(0), "{}", err(&output));
    assert_eq!(rpic(&["fmt", "--check", &program]).status.code(), Some(0));
    let output = rpic(&["compile", &program, "--emit", "rpinet"]);
    assert_eq!(output.status.code(), Some(0), "{}", err(&output));
    assert!(out(&output).contains("Core::Clock"), "{}", out(&output));
}

#[test]
fn nets_are_drawn() {
    let program = example("first/first.rpi");
    assert!(out(&rpic(&["graph", &program])).starts_with("flowchart"));
    assert!(out(&rpic(&["graph", "--format", "dot", &program])).starts_with("digraph"));
}

#[test]
fn codes_are_explained_and_unknown_ones_told() {
    let output = rpic(&["explain", "RPI4001"]);
    assert_eq!(output.status.code(), Some(0));
    assert!(out(&output).contains("pre"), "{}", out(&output));
    assert_eq!(rpic(&["explain", "4001"]).stdout, output.stdout);
    let output = rpic(&["explain", "RPI4999"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(err(&output).contains("RPI4999"), "{}", err(&output));
}

#[test]
fn all_codes_are_listed_with_their_titles() {
    let output = rpic(&["explain", "--list"]);
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(output.stdout, rpic(&["explain"]).stdout);
    for code in rpi_diag::Code::ALL {
        let line = format!("{}  {}\n", code.as_str(), code.title());
        assert!(out(&output).contains(&line), "{line}");
    }
}

#[test]
fn what_is_not_there_is_told() {
    for args in [
        &["check", "nothing.rpi"][..],
        &["compile", "nothing.rpi"],
        &["import", "nothing.rpinet"],
        &["graph", "nothing.rpi"],
        &["fmt", "nothing.rpi"],
    ] {
        let output = rpic(args);
        assert_eq!(output.status.code(), Some(2), "{args:?}: {}", err(&output));
        assert!(
            err(&output).contains("no such file"),
            "{args:?}: {}",
            err(&output)
        );
    }
}

#[cfg(target_os = "linux")]
#[test]
fn who_can_not_be_told_does_not_end_it() {
    let (_dir, path) = file("ring.rpi", WRONG);
    let full = std::fs::OpenOptions::new().write(true).open("/dev/full");
    let mut check = Command::new(env!("CARGO_BIN_EXE_rpic"));
    check.args(["check", &path]).stderr(full.unwrap());
    assert_eq!(check.status().unwrap().code(), Some(1));
}

#[test]
fn a_file_that_is_not_there_hides_nothing_of_the_others() {
    let (_dir, path) = file("ring.rpi", WRONG);
    let output = rpic(&["check", "nowhere.rpi", &path]);
    assert_eq!(output.status.code(), Some(2));
    assert!(err(&output).contains("RPI4001"), "{}", err(&output));
    assert!(err(&output).contains("nowhere.rpi"), "{}", err(&output));
}

#[test]
fn a_node_becomes_c_with_a_header_beside_it() {
    let (dir, program) = file("late.rpi", PROGRAM);
    let source = dir.path().join("late.c").display().to_string();
    let output = rpic(&[
        "compile", &program, "--emit", "c", "--node", "late", "-o", &source,
    ]);
    assert!(output.status.success(), "{}", err(&output));
    let read = |name: &str| std::fs::read_to_string(dir.path().join(name)).unwrap();
    assert!(read("late.c").contains("#include \"late.h\""));
    assert!(read("late.h").contains("int32_t late_step(late_state *s"));
    let output = rpic(&["compile", &program, "--emit", "c", "--function", "late"]);
    assert!(
        out(&output).contains("typedef struct late_in"),
        "{}",
        err(&output)
    );
}
