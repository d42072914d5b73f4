//! Diagnostics, code actions and formatting.

use rpi_testkit::LspClient;
use serde_json::{Value, json};

use crate::support::{Session, URI, connect, open, position};

const DEPENDENCY_CYCLE: &str = "\
node f (x: real) returns (y: real)
let
  y = a + x;
  a = y;
tel
";

fn codes(found: &[Value]) -> Vec<&str> {
    found
        .iter()
        .filter_map(|one| one["code"].as_str())
        .collect()
}

#[test]
fn a_finding_comes_with_all_its_places_and_its_page() {
    let mut session = open(DEPENDENCY_CYCLE);
    let found = session.client.diagnostics(URI, 1);
    assert_eq!(codes(&found), ["RPI4001"]);
    assert_eq!(
        (&found[0]["severity"], &found[0]["source"]),
        (&json!(1), &json!("rpic"))
    );
    let related = found[0]["relatedInformation"].as_array().unwrap();
    assert!(related.len() >= 2, "{related:?}");
    assert!(related.iter().all(|one| one["location"]["uri"] == URI));
    let page = found[0]["codeDescription"]["href"].as_str().unwrap();
    let page = std::fs::read_to_string(page.strip_prefix("file://").unwrap()).unwrap();
    assert!(page.starts_with("# RPI4001"), "{page}");
    session.shut_down().unwrap();
}

#[test]
fn findings_follow_the_writer() {
    let mut session = open(DEPENDENCY_CYCLE);
    assert_eq!(session.client.diagnostics(URI, 1).len(), 1);
    let at = position(DEPENDENCY_CYCLE, "y;\n", 0);
    let end = json!({ "line": at["line"], "character": at["character"].as_u64().unwrap() + 1 });
    let range = json!({ "start": at, "end": end });
    session
        .client
        .change(URI, 2, json!({ "range": range, "text": "0.0 -> pre y" }));
    assert_eq!(session.client.diagnostics(URI, 2), Vec::<Value>::new());
    session
        .client
        .change(URI, 3, json!({ "text": "const x: int = nothing;" }));
    assert_eq!(codes(&session.client.diagnostics(URI, 3)), ["RPI1001"]);
    let close = json!({ "textDocument": { "uri": URI } });
    session.client.notify("textDocument/didClose", close);
    let shown = session
        .client
        .await_method("textDocument/publishDiagnostics");
    assert_eq!(shown["diagnostics"], json!([]));
    session.shut_down().unwrap();
}

#[test]
fn places_count_utf16_units() {
    let text = "(* \u{1f916} *) const x: int = nothing;\n";
    let mut session = open(text);
    let found = session.client.diagnostics(URI, 1);
    let expected = json!({ "start": position(text, "nothing", 0), "end": position(text, ";", 0) });
    assert_eq!(found[0]["range"], expected);
    assert_eq!(found[0]["range"]["start"]["character"], 24);
    session.shut_down().unwrap();
}

/// Creates a folder with a module and opens a program that uses it. Returns the folder and both URIs.
fn two_files(client: &mut LspClient) -> (tempfile::TempDir, String, String) {
    let dir = tempfile::tempdir().unwrap();
    let uri = |name: &str| format!("file://{}", dir.path().join(name).display());
    std::fs::write(dir.path().join("parts.rpi"), "const n: int = 3;\n").unwrap();
    let (main, parts) = (uri("main.rpi"), uri("parts.rpi"));
    client.initialize(json!({}));
    client.open(&main, "use parts;\nconst m: int = n + k;\n");
    (dir, main, parts)
}

#[test]
fn what_is_not_saved_yet_counts() {
    let mut session = connect();
    let (_dir, main, parts) = two_files(&mut session.client);
    assert_eq!(codes(&session.client.diagnostics(&main, 1)), ["RPI1001"]);
    session.client.open(&parts, "const n: int = 3;\n");
    session
        .client
        .change(&parts, 2, json!({ "text": "const n, k: int = 3;\n" }));
    assert_eq!(session.client.diagnostics(&main, 1), Vec::<Value>::new());
    session.shut_down().unwrap();
}

#[test]
fn a_file_that_changes_on_disk_is_read_again() {
    let mut session = connect();
    let (dir, main, parts) = two_files(&mut session.client);
    assert_eq!(codes(&session.client.diagnostics(&main, 1)), ["RPI1001"]);
    std::fs::write(dir.path().join("parts.rpi"), "const n, k: int = 3;\n").unwrap();
    let changes = json!({ "changes": [{ "uri": parts, "type": 2 }] });
    session
        .client
        .notify("workspace/didChangeWatchedFiles", changes);
    assert_eq!(session.client.diagnostics(&main, 1), Vec::<Value>::new());
    session.shut_down().unwrap();
}

#[test]
fn errors_in_other_files_are_shown_there() {
    let mut session = connect();
    let (dir, _main, parts) = two_files(&mut session.client);
    std::fs::write(dir.path().join("parts.rpi"), "const n, k: int = 3 +;\n").unwrap();
    let changes = json!({ "changes": [{ "uri": parts, "type": 2 }] });
    session
        .client
        .notify("workspace/didChangeWatchedFiles", changes);
    let found = loop {
        let shown = session
            .client
            .await_method("textDocument/publishDiagnostics");
        if shown["uri"] == parts.as_str() {
            break shown["diagnostics"].clone();
        }
    };
    assert_eq!(found[0]["code"], "RPI0001");
    session.shut_down().unwrap();
}

/// Returns the code actions for a whole text.
fn actions(session: &mut Session, only: Value) -> Vec<Value> {
    let range =
        json!({ "start": { "line": 0, "character": 0 }, "end": { "line": 99, "character": 0 } });
    let context = match only {
        Value::Null => json!({ "diagnostics": [] }),
        only => json!({ "diagnostics": [], "only": only }),
    };
    let params = json!({ "textDocument": { "uri": URI }, "range": range, "context": context });
    let result = session.client.result("textDocument/codeAction", params);
    result.as_array().cloned().unwrap_or_default()
}

/// Returns the text after the edits of an action. The edited lines must be ASCII.
fn edited(text: &str, action: &Value) -> String {
    let edits = action["edit"]["changes"][URI].as_array().expect("edits");
    let mut edits: Vec<Value> = edits.clone();
    let offset = |at: &Value| {
        let line = at["line"].as_u64().unwrap() as usize;
        let before: usize = text.split_inclusive('\n').take(line).map(str::len).sum();
        before + at["character"].as_u64().unwrap() as usize
    };
    edits.sort_by_key(|edit| std::cmp::Reverse(offset(&edit["range"]["start"])));
    let mut text = text.to_owned();
    for edit in edits {
        let range = offset(&edit["range"]["start"])..offset(&edit["range"]["end"]);
        text.replace_range(range, edit["newText"].as_str().unwrap());
    }
    text
}

#[test]
fn sure_fixes_are_preferred_and_applied_together_if_asked() {
    let text = "// one\nconst a: int = 1\nconst b: int = 2;\n";
    let mut session = open(text);
    let all = actions(&mut session, Value::Null);
    let preferred: Vec<&Value> = all.iter().filter(|a| a["isPreferred"] == true).collect();
    assert!(!preferred.is_empty(), "{all:?}");
    assert!(preferred.iter().all(|action| action["kind"] == "quickfix"));
    let fix_all = actions(&mut session, json!(["source.fixAll"]));
    assert_eq!(fix_all.len(), 1);
    let fixed = edited(text, &fix_all[0]);
    session.client.change(URI, 2, json!({ "text": fixed }));
    assert_eq!(
        session.client.diagnostics(URI, 2),
        Vec::<Value>::new(),
        "{fixed}"
    );
    session.shut_down().unwrap();
}

#[test]
fn other_fixes_are_offered_and_not_preferred() {
    let text = "const speed: int = 1;\nconst a: int = sped;\n";
    let mut session = open(text);
    let all = actions(&mut session, json!(["quickfix"]));
    assert_eq!(all[0]["isPreferred"], false);
    assert!(edited(text, &all[0]).contains("= speed;"));
    session.shut_down().unwrap();
}

#[test]
fn edits_name_the_version_that_they_are_for_where_the_client_reads_it() {
    let mut session = connect();
    let edits = json!({ "workspaceEdit": { "documentChanges": true } });
    session.client.initialize(json!({ "workspace": edits }));
    session
        .client
        .open(URI, "const speed: int = 1;\nconst a: int = sped;\n");
    let all = actions(&mut session, Value::Null);
    let document = &all[0]["edit"]["documentChanges"][0]["textDocument"];
    assert_eq!(
        (&document["uri"], &document["version"]),
        (&json!(URI), &json!(1))
    );
    session.shut_down().unwrap();
}

#[test]
fn formatting_touches_only_what_is_out_of_style() {
    let text = "const a: int = 1;\nconst   b : int=2;\nconst c: int = 3;\n";
    let mut session = open(text);
    let params = json!({
        "textDocument": { "uri": URI },
        "options": { "tabSize": 2, "insertSpaces": true },
    });
    let edits = session
        .client
        .result("textDocument/formatting", params.clone());
    let expected = json!([{
        "range": { "start": { "line": 1, "character": 0 }, "end": { "line": 2, "character": 0 } },
        "newText": "const b: int = 2;\n",
    }]);
    assert_eq!(edits, expected);
    let in_style = "const a: int = 1;\r\n(* of two\r\nlines *)\r\n";
    session.client.change(URI, 2, json!({ "text": in_style }));
    let edits = session
        .client
        .result("textDocument/formatting", params.clone());
    assert_eq!(edits, json!([]));
    session
        .client
        .change(URI, 3, json!({ "text": "const = ;" }));
    assert_eq!(
        session.client.result("textDocument/formatting", params),
        Value::Null
    );
    session.shut_down().unwrap();
}
