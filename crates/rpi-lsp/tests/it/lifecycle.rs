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
