//! Every method of the server, once, over its pipe: the answers are in `tests/cases/methods.txt`.

use std::fmt::Write as _;
use std::path::PathBuf;

use serde_json::{Value, json};

use crate::support::{URI, connect, position};

const TEXT: &str = "\
use logic;

type Mode = enum { Slow, Fast };

--| Twice the value.
function twice (x: real[m]) returns (y: real[m])
let
  y = 2.0 * x;
tel

--| Follows the target.
node Follow (target: real[m]; mode: Mode) returns (out: real[m])
let
  step = if mode = Fast then twice(x: 1[mm]) else 1[mm];
  out = 0[m] -> pre out + step;
tel

command Run (mode: Mode)
let
  now = Follow(2[m], mode);
  fragment Late when rising(now > 1[m])
  let far = now; tel
  export now;
  finish there when now > 2[m];
tel

test \"a step is a millimetre\"
let
  finish done when Follow(1[m], Slow) >= 0[m];
tel
";

/// Method, the text at the position of the request, and further parameters.
type Row = (&'static str, &'static str, Value);

fn rows() -> Vec<Row> {
    let range = json!({
        "start": { "line": 11, "character": 0 },
        "end": { "line": 15, "character": 0 },
    });
    let options = json!({ "tabSize": 2, "insertSpaces": true });
    let on_type = json!({ "options": options, "ch": "\n" });
    vec![
        ("textDocument/hover", "step;", json!({})),
        ("textDocument/signatureHelp", "1[mm])", json!({})),
        ("textDocument/definition", "twice(x", json!({})),
        ("textDocument/typeDefinition", "mode = Fast", json!({})),
        (
            "textDocument/references",
            "twice(x",
            json!({ "context": { "includeDeclaration": true } }),
        ),
        ("textDocument/documentHighlight", "out =", json!({})),
        ("textDocument/linkedEditingRange", "Late", json!({})),
        ("textDocument/prepareRename", "Follow (", json!({})),
        (
            "textDocument/rename",
            "Follow (",
            json!({ "newName": "Track" }),
        ),
        ("textDocument/prepareCallHierarchy", "Follow (", json!({})),
        ("textDocument/documentSymbol", "", json!({})),
        ("workspace/symbol", "", json!({ "query": "fo" })),
        ("textDocument/completion", "out + step", json!({})),
        ("textDocument/formatting", "", json!({ "options": options })),
        (
            "textDocument/rangeFormatting",
            "",
            json!({ "options": options, "range": range }),
        ),
        ("textDocument/onTypeFormatting", "finish there", on_type),
        (
            "textDocument/codeAction",
            "",
            json!({ "range": range, "context": { "diagnostics": [] } }),
        ),
        ("textDocument/codeLens", "", json!({})),
        (
            "textDocument/semanticTokens/range",
            "",
            json!({ "range": range }),
        ),
        ("textDocument/inlayHint", "", json!({ "range": range })),
        ("textDocument/foldingRange", "", json!({})),
        (
            "textDocument/selectionRange",
            "",
            json!({ "positions": [position(TEXT, "pre out", 0)] }),
        ),
        ("textDocument/documentLink", "", json!({})),
        ("textDocument/diagnostic", "", json!({})),
    ]
}

#[test]
fn every_method_answers_as_recorded() {
    let mut session = connect();
    let welcome = session.client.initialize(json!({}));
    session.client.open(URI, TEXT);
    let mut out = format!("capabilities\n{}\n", compact(&welcome["capabilities"]));
    for (method, at, more) in rows() {
        let mut params = json!({ "textDocument": { "uri": URI } });
        if !at.is_empty() {
            params["position"] = position(TEXT, at, 0);
        }
        let more = more.as_object().unwrap().clone();
        params.as_object_mut().unwrap().extend(more);
        let result = session.client.result(method, params);
        writeln!(out, "\n{method} {at}\n{}", compact(&result)).unwrap();
    }
    hierarchy_and_tokens(&mut session, &mut out);
    session.shut_down().unwrap();
    compare("methods.txt", &out);
}

/// Methods that need the result of another one.
fn hierarchy_and_tokens(session: &mut crate::support::Session, out: &mut String) {
    let item = session.request_at("prepareCallHierarchy", &position(TEXT, "Follow (", 0));
    for method in ["callHierarchy/incomingCalls", "callHierarchy/outgoingCalls"] {
        let result = session.client.result(method, json!({ "item": item[0] }));
        writeln!(out, "\n{method}\n{}", compact(&result)).unwrap();
    }
    let document = json!({ "textDocument": { "uri": URI } });
    let lenses = session
        .client
        .result("textDocument/codeLens", document.clone());
    let counted = lenses
        .as_array()
        .unwrap()
        .iter()
        .find(|lens| lens["data"].is_object());
    let resolved = session
        .client
        .result("codeLens/resolve", counted.unwrap().clone());
    writeln!(out, "\ncodeLens/resolve\n{}", compact(&resolved)).unwrap();
    let full = session
        .client
        .result("textDocument/semanticTokens/full", document);
    let start = json!({ "line": 0, "character": 0 });
    let range = json!({ "start": start, "end": start });
    session.client.change(
        URI,
        2,
        json!({ "range": range, "text": "const a: int = 1;\n" }),
    );
    let params = json!({ "textDocument": { "uri": URI }, "previousResultId": full["resultId"] });
    let delta = session
        .client
        .result("textDocument/semanticTokens/full/delta", params);
    writeln!(
        out,
        "\ntextDocument/semanticTokens/full/delta\n{}",
        compact(&delta)
    )
    .unwrap();
    let params = json!({ "previousResultIds": [] });
    let all = session.client.result("workspace/diagnostic", params);
    writeln!(out, "\nworkspace/diagnostic\n{}", compact(&all)).unwrap();
}

/// Returns JSON with the parts of a list in one line each, positions as `line:column`, and no paths of the machine.
fn compact(value: &Value) -> String {
    let line = |value: &Value| positions(value).to_string();
    let text = match value {
        Value::Array(all) => all.iter().map(line).collect::<Vec<_>>().join("\n"),
        Value::Object(all) => {
            let row = |(key, value): (&String, &Value)| format!("{key}: {}", line(value));
            all.iter().map(row).collect::<Vec<_>>().join("\n")
        }
        other => line(other),
    };
    let path = without_cache_path(&text);
    path.replace(env!("CARGO_PKG_VERSION"), "VERSION")
}

/// Replaces the folder of copies of built-in texts, which depends on the machine, by `CACHE`.
fn without_cache_path(text: &str) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some(at) = rest.find("file:///") {
        let end = rest[at..]
            .find('"')
            .map_or(rest.len(), |length| at + length);
        let uri = &rest[at..end];
        let below = ["/stdlib/", "/findings/"]
            .iter()
            .find_map(|part| uri.find(part));
        out.push_str(&rest[..at]);
        match below {
            Some(start) => out.push_str(&format!("CACHE{}", &uri[start..])),
            None => out.push_str(uri),
        }
        rest = &rest[end..];
    }
    out + rest
}

/// Replaces positions in JSON by texts `line:column`, and ranges by `start-end`.
fn positions(value: &Value) -> Value {
    match value {
        Value::Array(all) => all.iter().map(positions).collect(),
        Value::Object(all) => match (
            all.get("line"),
            all.get("character"),
            all.get("start"),
            all.get("end"),
        ) {
            (Some(line), Some(column), ..) => json!(format!("{line}:{column}")),
            (_, _, Some(start), Some(end)) if all.len() == 2 => {
                let text = |value: &Value| positions(value).as_str().unwrap_or_default().to_owned();
                json!(format!("{}-{}", text(start), text(end)))
            }
            _ => all
                .iter()
                .map(|(key, value)| (key.clone(), positions(value)))
                .collect(),
        },
        other => other.clone(),
    }
}

/// Compares a text with a file of `tests/cases`, or rewrites the file if `RPI_BLESS` is set.
fn compare(file: &str, found: &str) {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("tests/cases")
        .join(file);
    if std::env::var_os("RPI_BLESS").is_some() {
        std::fs::write(&path, found).unwrap();
        return;
    }
    let expected = std::fs::read_to_string(&path).unwrap_or_default();
    for (k, (old, new)) in expected.lines().zip(found.lines()).enumerate() {
        assert_eq!(old, new, "line {} of {file}", k + 1);
    }
    assert_eq!(expected.lines().count(), found.lines().count());
}
