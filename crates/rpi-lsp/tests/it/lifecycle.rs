//! Lifecycle of a session, and handling of invalid messages.

use serde_json::{Value, json};

use crate::support::{URI, connect, open};

#[test]
fn a_session_from_begin_to_end() {
    let mut session = connect();
    let welcome = session.client.initialize(json!({}));
    assert_eq!(welcome["serverInfo"]["name"], "rpic lsp");
    assert_eq!(welcome["capabilities"]["positionEncoding"], "utf-16");
    assert_eq!(welcome["capabilities"]["hoverProvider"], true);
    session.shut_down().unwrap();
}

#[test]
fn a_client_that_counts_bytes_is_served_in_bytes() {
    let mut session = connect();
    let general = json!({ "positionEncodings": ["utf-16", "utf-8"] });
    let welcome = session.client.initialize(json!({ "general": general }));
    assert_eq!(welcome["capabilities"]["positionEncoding"], "utf-8");
    session.client.open(URI, "(* \u{e4} *) const x: int = y;\n");
    let found = session.client.diagnostics(URI, 1);
    assert_eq!(
        found[0]["range"]["start"],
        json!({ "line": 0, "character": 24 })
    );
    session.shut_down().unwrap();
}

#[test]
fn a_client_that_watches_files_is_asked_to() {
    let mut session = connect();
    let watched = json!({ "didChangeWatchedFiles": { "dynamicRegistration": true } });
    session.client.initialize(json!({ "workspace": watched }));
    let request = session.client.await_method("client/registerCapability");
    assert_eq!(
        request["registrations"][0]["method"],
        "workspace/didChangeWatchedFiles"
    );
    session.shut_down().unwrap();
}

#[test]
fn the_order_of_life_is_kept() {
    let mut session = connect();
    let code = |answer: Value| answer["error"]["code"].as_i64();
    assert_eq!(
        code(session.client.request("textDocument/hover", json!({}))),
        Some(-32002)
    );
    session.client.initialize(json!({}));
    assert_eq!(
        code(session.client.request("initialize", json!({}))),
        Some(-32600)
    );
    assert_eq!(
        code(session.client.request("no/such", json!({}))),
        Some(-32601)
    );
    assert_eq!(
        code(session.client.request("textDocument/hover", json!([1]))),
        Some(-32602)
    );
    session.client.result("shutdown", Value::Null);
    assert_eq!(
        code(session.client.request("textDocument/hover", json!({}))),
        Some(-32600)
    );
    session.client.notify("exit", Value::Null);
    assert_eq!(session.client.receive(), None);
}

#[test]
fn malformed_messages_are_answered_and_the_next_one_is_read() {
    let mut session = open("const x: int = y;\n");
    assert_eq!(session.client.diagnostics(URI, 1).len(), 1);
    session.client.write_raw(b"Content-Length: 5\r\n\r\n{oops");
    assert_eq!(
        session.client.receive().map(|m| m["error"]["code"].clone()),
        Some(json!(-32700))
    );
    let nonsense = br#"{"jsonrpc":"2.0","id":99,"method":[]}"#;
    session
        .client
        .write_raw(format!("Content-Length: {}\r\n\r\n", nonsense.len()).as_bytes());
    session.client.write_raw(nonsense);
    session.client.write_raw(b"no header at all\r\n\r\n");
    session
        .client
        .notify("textDocument/didChange", json!({ "textDocument": 3 }));
    session.client.notify(
        "textDocument/didChange",
        json!({
            "textDocument": { "uri": "file:///not/open.rpi", "version": 2 },
            "contentChanges": [{ "text": "" }],
        }),
    );
    session.client.change(URI, 2, json!({ "text": "" }));
    assert_eq!(session.client.diagnostics(URI, 2), Vec::<Value>::new());
    session.shut_down().unwrap();
}

#[test]
fn a_client_that_vanishes_is_an_error() {
    assert!(open("").disconnect().is_err());
    assert!(connect().disconnect().is_err());
}

/// Returns a message in the form of the protocol.
fn framed(mut message: Value) -> Vec<u8> {
    message["jsonrpc"] = json!("2.0");
    let text = message.to_string();
    format!("Content-Length: {}\r\n\r\n{text}", text.len()).into_bytes()
}

#[test]
fn a_cancelled_request_is_answered_with_an_error() {
    let text = "node f (x: int) returns (y: int)\nlet\n  y = x;\ntel\n".repeat(200);
    let mut session = open(&text);
    session.client.diagnostics(URI, 1);
    // The change makes the next request analyse the text, which takes longer than reading the third message.
    let change = json!({
        "method": "textDocument/didChange",
        "params": {
            "textDocument": { "uri": URI, "version": 2 },
            "contentChanges": [{ "text": text.replace("y = x", "y = x + 1") }],
        },
    });
    let position = json!({ "line": 2, "character": 2 });
    let request = json!({
        "id": 77,
        "method": "textDocument/hover",
        "params": { "textDocument": { "uri": URI }, "position": position },
    });
    let cancel = json!({ "method": "$/cancelRequest", "params": { "id": 77 } });
    session
        .client
        .write_raw(&[framed(change), framed(request), framed(cancel)].concat());
    let answer = loop {
        let message = session.client.receive().unwrap();
        if message["id"] == 77 {
            break message;
        }
    };
    assert_eq!(answer["error"]["code"], -32800, "{answer}");
    session.shut_down().unwrap();
}

#[test]
fn settings_are_read_at_the_start_on_request_and_on_change() {
    let text = "node f (x: int) returns (y: int)\nlet\n  z = x;\n  y = z;\ntel\n";
    let hints = |session: &mut crate::support::Session| {
        let range = json!({
            "start": { "line": 0, "character": 0 },
            "end": { "line": 9, "character": 0 },
        });
        let params = json!({ "textDocument": { "uri": URI }, "range": range });
        let found = session.client.result("textDocument/inlayHint", params);
        found.as_array().map_or(0, Vec::len)
    };
    let mut session = connect();
    session.client.initialize_with(json!({
        "capabilities": { "workspace": { "configuration": true } },
        "initializationOptions": { "inlayHints": false },
    }));
    session.client.open(URI, text);
    assert_eq!(hints(&mut session), 0);
    let request = session.client.await_method("workspace/configuration");
    assert_eq!(request["items"][0]["section"], "rpi");
    session
        .client
        .respond(json!("configuration"), json!([{ "inlayHints": true }]));
    assert_eq!(hints(&mut session), 1);
    let settings = json!({ "settings": { "rpi": { "inlayHints": false } } });
    session
        .client
        .notify("workspace/didChangeConfiguration", settings);
    assert_eq!(hints(&mut session), 0);
    session.shut_down().unwrap();
}

#[test]
fn a_client_that_requests_diagnostics_receives_none_by_itself() {
    let mut session = connect();
    let options = json!({ "pullDiagnostics": true });
    let params = json!({ "capabilities": {}, "initializationOptions": options });
    let welcome = session.client.initialize_with(params);
    assert_eq!(
        welcome["capabilities"]["diagnosticProvider"]["workspaceDiagnostics"],
        true
    );
    session.client.open(URI, "const x: int = y;\n");
    let params = json!({ "textDocument": { "uri": URI } });
    let report = session
        .client
        .result("textDocument/diagnostic", params.clone());
    assert_eq!(report["kind"], "full");
    assert_eq!(report["items"][0]["code"], "RPI1001");
    let mut again = params;
    again["previousResultId"] = report["resultId"].clone();
    let report = session.client.result("textDocument/diagnostic", again);
    assert_eq!(report["kind"], "unchanged");
    session.client.notify("exit", Value::Null);
    assert_eq!(
        session.client.receive(),
        None,
        "no diagnostics were published"
    );
}
