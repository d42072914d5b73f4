//! Completion: the edits of its items. The offered names are in `cases.rs`.

use serde_json::{Value, json};

use crate::support::{URI, cursor, open};

/// Returns the labels of the completion items at `|`.
fn labels(marked: &str) -> Vec<String> {
    let (text, position) = cursor(marked);
    let mut session = open(&text);
    let labels = session.labels(&position);
    session.shut_down().unwrap();
    labels
}

const HEAD: &str = "use motion;\n\
    type Phase = enum { Idle, Busy };\n\
    type Pair = struct { left: real; right: real };\n\
    command Go (arm: Arm; there: Pose)\nlet\n  way = Line(arm, there);\n\
    \x20 fragment F when way.done\n  let inside = 1.0; tel\n";

fn in_body(line: &str) -> String {
    format!("{HEAD}  {line}\n  finish at_end when way.done;\ntel\n")
}

#[test]
fn nothing_is_offered_in_comments() {
    assert_eq!(labels(&in_body("-- wa|")), Vec::<String>::new());
}

#[test]
fn what_is_not_used_yet_brings_its_use() {
    let (text, position) =
        cursor("const far: real = 1.0;\nfragment F () returns (y: bool)\nlet\n  y = cro|\ntel\n");
    let mut session = open(&text);
    let list = session.request_at("completion", &position);
    let items = list["items"].as_array().unwrap();
    let crosses = items
        .iter()
        .find(|item| item["label"] == "crosses")
        .unwrap();
    let start = json!({ "line": 0, "character": 0 });
    let expected =
        json!([{ "range": { "start": start, "end": start }, "newText": "use motion;\n\n" }]);
    assert_eq!(crosses["additionalTextEdits"], expected);
    session.shut_down().unwrap();
}

#[test]
fn an_item_replaces_what_is_written_of_it() {
    let (text, position) = cursor(&in_body("x = Core::Double|"));
    let mut session = open(&text);
    let list = session.request_at("completion", &position);
    let items = list["items"].as_array().unwrap();
    let add = items
        .iter()
        .find(|item| item["label"] == "Core::DoubleAdd")
        .unwrap();
    assert_eq!(add["textEdit"]["newText"], "Core::DoubleAdd");
    assert_eq!(add["textEdit"]["range"]["start"]["character"], json!(6));
    session.shut_down().unwrap();
}

#[test]
fn lustre_has_its_own_words() {
    let mut session = open("");
    let uri = URI.replace(".rpi", ".lus");
    session.client.open(
        &uri,
        "node f (x: int) returns (y: int);\nlet\n  y = \ntel\n",
    );
    let params =
        json!({ "textDocument": { "uri": uri }, "position": { "line": 2, "character": 6 } });
    let list = session.client.result("textDocument/completion", params);
    let labels: Vec<&Value> = list["items"]
        .as_array()
        .unwrap()
        .iter()
        .map(|i| &i["label"])
        .collect();
    assert!(labels.contains(&&json!("x")) && labels.contains(&&json!("pre")));
    assert!(!labels.contains(&&json!("command")) && !labels.contains(&&json!("Line")));
    session.shut_down().unwrap();
}
