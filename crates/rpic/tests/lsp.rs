//! `rpic lsp` as an editor runs it: a process with the protocol on standard input and output.

use std::process::{Child, Command, Stdio};

use rpi_testkit::LspClient;
use serde_json::{Value, json};

const PROGRAM: &str = "\
use motion;

--| Goes there.
command Go (arm: Arm; there: Pose)
let
  way = Line(arm, there);
  arm.tcp = way.pose;
  finish at_end when way.done;
  fail stopped when way.stopped;
tel
";

/// Starts the server and a client that is connected to it.
fn start() -> (Child, LspClient) {
    let mut server = Command::new(env!("CARGO_BIN_EXE_rpic"))
        .arg("lsp")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let (input, output) = (server.stdout.take().unwrap(), server.stdin.take().unwrap());
    (server, LspClient::new(input, output))
}

/// Returns the parameters of a request at the position of `what`.
fn at(uri: &str, what: &str) -> Value {
    let before = &PROGRAM[..PROGRAM.find(what).unwrap()];
    let column = before.rsplit('\n').next().unwrap_or("").len();
    let position = json!({ "line": before.matches('\n').count(), "character": column });
    json!({ "textDocument": { "uri": uri }, "position": position })
}

#[test]
fn an_editor_is_served_from_its_first_message_to_its_last() {
    let dir = tempfile::tempdir().unwrap();
    let uri = format!("file://{}", dir.path().join("go.rpi").display());
    let (mut server, mut client) = start();
    let welcome = client.initialize(json!({}));
    assert_eq!(welcome["capabilities"]["documentFormattingProvider"], true);

    client.open(&uri, PROGRAM);
    assert_eq!(client.diagnostics(&uri, 1), Vec::<Value>::new());
    client.write_raw(b"Content-Length: 3\r\n\r\n{x}");
    let hover = client.result("textDocument/hover", at(&uri, "there);"));
    assert!(
        hover["contents"]["value"]
            .as_str()
            .unwrap()
            .contains("there: Pose")
    );
    let found = client.result("textDocument/definition", at(&uri, "way.done"));
    assert_eq!(
        found["range"]["start"],
        json!({ "line": 5, "character": 2 })
    );
    let list = client.result("textDocument/completion", at(&uri, "arm.tcp"));
    let items = list["items"].as_array().unwrap();
    assert!(items.iter().any(|item| item["label"] == "arm"));

    let untidy = PROGRAM
        .replace("  way =", "way=")
        .replace("use motion;", "// arms\nuse motion;");
    client.change(&uri, 2, json!({ "text": untidy }));
    let codes: Vec<Value> = client
        .diagnostics(&uri, 2)
        .iter()
        .map(|d| d["code"].clone())
        .collect();
    assert_eq!(codes, ["RPI0013"]);
    let everywhere =
        json!({ "start": { "line": 0, "character": 0 }, "end": { "line": 9, "character": 0 } });
    let document = json!({ "uri": uri });
    let context = json!({ "diagnostics": [] });
    let params = json!({ "textDocument": document, "range": everywhere, "context": context });
    let actions = client.result("textDocument/codeAction", params);
    assert_eq!(actions[0]["edit"]["changes"][&uri][0]["newText"], "--");
    let options = json!({ "tabSize": 2, "insertSpaces": true });
    let params = json!({ "textDocument": document, "options": options });
    let edits = client.result("textDocument/formatting", params);
    assert!(
        edits[0]["newText"]
            .as_str()
            .unwrap()
            .contains("  way = Line"),
        "{edits}"
    );

    client.shutdown();
    assert_eq!(server.wait().unwrap().code(), Some(0));
}

#[test]
fn an_editor_that_vanishes_leaves_no_server_behind() {
    let (mut server, mut client) = start();
    client.initialize(json!({}));
    drop(client);
    assert_eq!(server.wait().unwrap().code(), Some(2));
}
