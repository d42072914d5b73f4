//! Hover, navigation and outline.

use serde_json::{Value, json};

use crate::support::{URI, open, position};

const CELL: &str = "\
use motion;

--| Where the work piece lies.
const work: Pose = pose(450[mm], 0[mm], 400[mm], 0[deg], 0[deg], 0[deg]);

--| Goes there and back.
command Go (arm: Arm; there: Pose)
let
  --| The way there.
  way = Line<<speed: 250[mm/s]>>(arm, there);
  arm.tcp = way.pose;
  fragment Late when way.done
  let slow = way.travelled / 2.0; tel
  far = Late.slow ?? 0[m];
  export far;
  finish at_end when way.done;
  fail stopped when way.stopped;
tel

task Main (arm: Arm)
let
  Go(arm, work);
tel
";

#[test]
fn the_program_of_these_tests_is_right() {
    let mut session = open(CELL);
    assert_eq!(session.client.diagnostics(URI, 1), Vec::<Value>::new());
    session.shut_down().unwrap();
}

/// Text at the cursor, its number in the program, and what hovering shows.
const HOVERS: &[(&str, usize, &[&str])] = &[
    (
        "work)",
        0,
        &[
            "work: Pose = pose(450[mm]",
            "constant",
            "Where the work piece lies.",
        ],
    ),
    (
        "Go (",
        0,
        &["command Go (arm: Arm; there: Pose)", "Goes there and back."],
    ),
    ("Go(", 0, &["command Go", "Goes there and back."]),
    ("way.done;", 0, &["flow of `Go`", "The way there."]),
    (
        "Line",
        0,
        &[
            "fragment Line",
            "A straight line of the tool from where it is to `to`",
            "stdlib/motion.rpi",
        ],
    ),
    (
        "speed",
        0,
        &["speed: real[m/s]", "static parameter of `Line`"],
    ),
    (
        "done;",
        0,
        &["done: bool", "out-port of `Line`", "always present"],
    ),
    ("slow =", 0, &["slow: real[m]", "always present"]),
    ("slow ??", 0, &["slow: real[m]?", "may be absent"]),
    ("pose;", 0, &["pose: Pose(", "out-port of `Line`"]),
    ("tcp =", 0, &["tcp: Pose(", "port of `Arm`"]),
    ("Arm;", 0, &["device Arm", "An arm with `n` joints."]),
    (
        "Late when",
        0,
        &["fragment Late when way.done", "fragment in place of `Go`"],
    ),
    ("when way.done;", 0, &["when", "keyword"]),
    ("250", 0, &["real[m/s]"]),
    ("?? 0", 0, &["real[m]"]),
    (
        "at_end",
        0,
        &["finish at_end when way.done;", "result of `Go`"],
    ),
];

#[test]
fn hovering_tells_type_unit_presence_and_documentation() {
    let mut session = open(CELL);
    for (what, n, expected) in HOVERS {
        let shown = session.hover(&position(CELL, what, *n));
        for part in *expected {
            assert!(shown.contains(part), "`{what}` shows no `{part}`:\n{shown}");
        }
    }
    session.shut_down().unwrap();
}

#[test]
fn hovering_an_operation_tells_how_it_can_fault() {
    let text = "node f (x, d: int; c: bool) returns (y, z: int)\nlet\n  y = if c then x div d else 0;\n  z = x mod 7;\ntel\n";
    let mut session = open(text);
    let shown = session.hover(&position(text, "div d", 0));
    assert!(
        shown.contains("division by zero, only where it is needed"),
        "{shown}"
    );
    let safe = session.hover(&position(text, "mod 7", 0));
    assert!(!safe.contains("fault"), "{safe}");
    session.shut_down().unwrap();
}

#[test]
fn what_is_built_in_has_words() {
    let text = "node f (x: real) returns (y: real)\nlet\n  y = hold(none, x) + time / dt \
                + Core::DoubleAdd(inFirst: x, inSecond: x);\ntel\n";
    let mut session = open(text);
    let cases = [
        ("hold", "hold(x, init)"),
        ("time", "Time since the first cycle of the command"),
        ("none", "The absent value."),
        ("Core::DoubleAdd", "primitive Core::DoubleAdd"),
        ("returns", "keyword"),
    ];
    for (what, expected) in cases {
        let shown = session.hover(&position(text, what, 0));
        assert!(shown.contains(expected), "`{what}`:\n{shown}");
    }
    assert_eq!(
        session.request_at("hover", &json!({ "line": 99, "character": 0 })),
        Value::Null
    );
    session.shut_down().unwrap();
}

#[test]
fn names_lead_to_their_declarations() {
    let mut session = open(CELL);
    let cases = [
        ("work);", "work: Pose"),
        ("Go(", "Go ("),
        ("there);", "there: Pose"),
        ("way.done;", "way = Line"),
        ("Late.slow", "Late when"),
        ("slow ??", "slow ="),
        ("far;", "far ="),
    ];
    for (from, to) in cases {
        let found = session.request_at("definition", &position(CELL, from, 0));
        assert_eq!(found["uri"], URI, "{from}");
        assert_eq!(found["range"]["start"], position(CELL, to, 0), "{from}");
    }
    session.shut_down().unwrap();
}

#[test]
fn names_of_the_library_lead_to_a_copy_of_it() {
    let mut session = open(CELL);
    for (from, declared) in [
        ("Line", "Line <<"),
        ("speed:", "speed: real"),
        ("done;", "done: bool"),
    ] {
        let found = session.request_at("definition", &position(CELL, from, 0));
        let path = found["uri"]
            .as_str()
            .unwrap()
            .strip_prefix("file://")
            .unwrap();
        assert!(path.ends_with("stdlib/motion.rpi"), "{path}");
        let text = std::fs::read_to_string(path).unwrap();
        assert!(std::fs::metadata(path).unwrap().permissions().readonly());
        let start = &found["range"]["start"];
        let line = text
            .lines()
            .nth(start["line"].as_u64().unwrap() as usize)
            .unwrap();
        let rest = &line[start["character"].as_u64().unwrap() as usize..];
        assert!(rest.starts_with(declared), "{from}: {rest}");
    }
    session.shut_down().unwrap();
}

#[test]
fn references_are_all_places_of_a_name() {
    let mut session = open(CELL);
    let found = session.request_at("references", &position(CELL, "way =", 0));
    assert_eq!(
        found.as_array().map(Vec::len),
        Some(CELL.matches("way").count() - 1)
    );
    let shown = session.request_at("documentHighlight", &position(CELL, "there);", 0));
    assert_eq!(shown.as_array().map(Vec::len), Some(2));
    session.shut_down().unwrap();
}

#[test]
fn references_from_a_declaration_are_found_in_other_open_texts() {
    let main =
        "use helper;\n\nnode N (x: int) returns (y: int)\nlet\n  y = twice(x) + twice(1);\ntel\n";
    let helper = "function twice (x: int) returns (y: int)\nlet\n  y = 2 * x;\ntel\n";
    let beside = "file:///cell/helper.rpi";
    let mut session = open(main);
    assert_eq!(session.client.diagnostics(URI, 1).len(), 1);
    session.client.open(beside, helper);
    // The module is open in the editor now.
    assert_eq!(session.client.diagnostics(URI, 1), Vec::<Value>::new());
    let params = json!({
        "textDocument": { "uri": beside },
        "position": position(helper, "twice", 0),
        "context": { "includeDeclaration": true },
    });
    let found = session.client.result("textDocument/references", params);
    assert_eq!(found.as_array().map(Vec::len), Some(3));
    session.shut_down().unwrap();
}

#[test]
fn the_outline_nests() {
    let mut session = open(CELL);
    let params = json!({ "textDocument": { "uri": URI } });
    let outline = session.client.result("textDocument/documentSymbol", params);
    let names = |list: &Value| -> Vec<String> {
        let all = list.as_array().cloned().unwrap_or_default();
        all.iter()
            .filter_map(|one| one["name"].as_str().map(str::to_owned))
            .collect()
    };
    assert_eq!(names(&outline), ["work", "Go", "Main"]);
    let inside = &outline[1]["children"];
    assert_eq!(names(inside), ["way", "Late", "far", "at_end", "stopped"]);
    assert_eq!(names(&inside[1]["children"]), ["slow"]);
    session.shut_down().unwrap();
}

#[test]
fn names_are_known_beside_faults() {
    let text = CELL.replace("  export far;\n", "  broken = = 3;\n  export far;\n");
    let mut session = open(&text);
    assert_eq!(session.client.diagnostics(URI, 1).len(), 1);
    let found = session.request_at("definition", &position(&text, "slow ??", 0));
    assert_eq!(found["range"]["start"], position(&text, "slow =", 0));
    session.shut_down().unwrap();
}
