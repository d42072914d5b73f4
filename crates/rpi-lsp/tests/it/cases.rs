//! Cases of one line: a text with the cursor at `$0`, and what the server answers there.
//!
//! A file of `tests/cases` consists of templates, which give the text around the line of a case, and of cases
//! `TEMPLATE: LINE => ANSWER`. `\n` in a line is a line break. `RPI_BLESS=1` rewrites the answers.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::PathBuf;

use serde_json::{Value, json};

use crate::edits::{apply, changes};
use crate::support::{Session, URI, connect, position_of};

/// Number of labels that a case of completion shows. The others are counted.
const SHOWN: usize = 8;

/// Returns what the server answers in a text at a range of bytes.
type Answer = fn(&mut Session, &str, std::ops::Range<usize>) -> String;

#[test]
fn completion_cases_answer_as_recorded() {
    run("completion.txt", completions);
}

#[test]
fn action_cases_answer_as_recorded() {
    run("actions.txt", actions);
}

#[test]
fn signature_cases_answer_as_recorded() {
    run("signatures.txt", signature);
}

fn completions(session: &mut Session, text: &str, at: std::ops::Range<usize>) -> String {
    let labels = session.labels(&position_of(text, at.start));
    match labels.len() {
        0 => "nothing".to_owned(),
        many if many > SHOWN => format!("{} ({many})", labels[..SHOWN].join(" ")),
        _ => labels.join(" "),
    }
}

/// Returns the title of each refactoring at a range and the lines that it changes.
fn actions(session: &mut Session, text: &str, at: std::ops::Range<usize>) -> String {
    let [start, end] = [at.start, at.end].map(|offset| position_of(text, offset));
    let params = json!({
        "textDocument": { "uri": URI },
        "range": { "start": start, "end": end },
        "context": { "diagnostics": [], "only": ["refactor"] },
    });
    let found = session.client.result("textDocument/codeAction", params);
    let found = found.as_array().cloned().unwrap_or_default();
    let shown = found.iter().map(|action| {
        let edits = changes(&action["edit"]);
        let edits = edits
            .iter()
            .find(|(uri, _)| uri == URI)
            .map(|(_, edits)| edits);
        let new = apply(text, edits.map_or(&[], Vec::as_slice));
        let title = action["title"].as_str().unwrap_or_default();
        format!("{title} {{ {} }}", changed_lines(text, &new))
    });
    match found.is_empty() {
        true => "nothing".to_owned(),
        false => shown.collect::<Vec<_>>().join(" | "),
    }
}

/// Returns the lines of `new` that differ from `old`, separated by `\n`.
fn changed_lines(old: &str, new: &str) -> String {
    let (old, new): (Vec<&str>, Vec<&str>) = (old.lines().collect(), new.lines().collect());
    let head = old.iter().zip(&new).take_while(|(a, b)| a == b).count();
    let tail = old[head..].iter().rev().zip(new[head..].iter().rev());
    let tail = tail.take_while(|(a, b)| a == b).count();
    new[head..new.len() - tail].join("\\n")
}

fn signature(session: &mut Session, text: &str, at: std::ops::Range<usize>) -> String {
    let help = session.request_at("signatureHelp", &position_of(text, at.start));
    let one = &help["signatures"][0];
    let Some(label) = one["label"].as_str() else {
        return "nothing".to_owned();
    };
    let active = help["activeParameter"].as_u64();
    let parameter = active.map(|at| &one["parameters"][at as usize]["label"]);
    let shown = parameter.map_or("none".to_owned(), |range| {
        let at = |k: usize| range[k].as_u64().unwrap() as usize;
        label[at(0)..at(1)].to_owned()
    });
    format!("{label} at {shown}")
}

/// Runs the cases of a file, or rewrites their answers.
fn run(file: &str, answer: Answer) {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("tests/cases")
        .join(file);
    let old = std::fs::read_to_string(&path).unwrap();
    let mut templates = BTreeMap::new();
    let mut session = connect();
    session.client.initialize(json!({}));
    session.client.open(URI, "");
    let (mut new, mut count) = (String::new(), 0);
    let mut lines = old.lines();
    while let Some(line) = lines.next() {
        writeln!(new, "{line}").unwrap();
        if let Some(name) = line.strip_prefix("template ") {
            let body: Vec<&str> = lines
                .by_ref()
                .take_while(|line| *line != "end template")
                .collect();
            writeln!(new, "{}\nend template", body.join("\n")).unwrap();
            templates.insert(name.to_owned(), body.join("\n"));
            continue;
        }
        if line.is_empty() || line.starts_with("# ") {
            continue;
        }
        let (template, case) = line.split_once(": ").expect("`TEMPLATE: LINE => ANSWER`");
        let (case, _) = case.rsplit_once(" => ").unwrap_or((case, ""));
        let (text, at) = marked(&templates[template], case);
        count += 1;
        session.client.change(URI, count, json!({ "text": text }));
        let found = answer(&mut session, &text, at);
        let kept = new.len() - line.len() - 1;
        new.truncate(kept);
        writeln!(new, "{template}: {case} => {found}").unwrap();
    }
    session.shut_down().unwrap();
    assert!(count > 0, "no cases in {file}");
    if std::env::var_os("RPI_BLESS").is_some() {
        std::fs::write(&path, new).unwrap();
        return;
    }
    let differing = old.lines().zip(new.lines()).filter(|(a, b)| a != b);
    let differing: Vec<String> = differing.map(|(a, b)| format!("- {a}\n+ {b}")).collect();
    assert!(differing.is_empty(), "{}", differing.join("\n"));
}

/// Returns the text of a case in its template, and the range between the marks `$0` and `$1`, or the place of `$0`.
fn marked(template: &str, case: &str) -> (String, std::ops::Range<usize>) {
    let text = template.replace("$LINE", &case.replace("\\n", "\n"));
    let start = text.find("$0").expect("the cursor");
    let text = text.replacen("$0", "", 1);
    match text.find("$1") {
        Some(end) => (text.replacen("$1", "", 1), start..end),
        None => (text, start..start),
    }
}

#[test]
fn every_answer_is_small_and_quick_enough_to_type() {
    let (text, at) = marked(
        "node f (x: real) returns (y: real)\nlet\n  y = $0;\ntel\n",
        "",
    );
    let mut session = connect();
    session.client.initialize(json!({}));
    session.client.open(URI, &text);
    let list = session.request_at("completion", &position_of(&text, at.start));
    let items = list["items"].as_array().unwrap();
    assert!(items.len() <= 200, "{}", items.len());
    assert!(
        list.to_string().len() <= 64 << 10,
        "{}",
        list.to_string().len()
    );
    assert_eq!(items[0]["documentation"], Value::Null);
    let resolved = session
        .client
        .result("completionItem/resolve", items[0].clone());
    assert!(resolved["documentation"]["value"].is_string(), "{resolved}");
    session.shut_down().unwrap();
}
