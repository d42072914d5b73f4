//! Robustness: every request about incomplete or erroneous texts is answered without an error.

use proptest::prelude::*;
use rpi_testkit::files_below;
use serde_json::{Value, json};

use crate::support::{Session, URI, open, position_of};

const POSITION_REQUESTS: &[&str] = &[
    "hover",
    "definition",
    "references",
    "documentHighlight",
    "completion",
];

/// Returns the texts of all programs of the project, valid and erroneous.
fn programs() -> Vec<String> {
    let folders = ["examples", "stdlib", "tests/ui", "crates/rpi-syntax/tests"];
    let files = folders
        .map(|folder| files_below(folder, &[".rpi", ".lus"]))
        .concat();
    files
        .iter()
        .filter_map(|path| std::fs::read_to_string(path).ok())
        .collect()
}

/// Sends every request about a text at an offset, and waits for the diagnostics. Panics at an error response.
fn request_all(session: &mut Session, text: &str, version: i64, offset: usize) {
    session.client.change(URI, version, json!({ "text": text }));
    let place = position_of(text, offset);
    for method in POSITION_REQUESTS {
        session.request_at(method, &place);
    }
    let document = json!({ "uri": URI });
    let options = json!({ "tabSize": 2, "insertSpaces": true });
    let start = json!({ "line": 0, "character": 0 });
    let of_text = [
        ("documentSymbol", json!({ "textDocument": document })),
        (
            "formatting",
            json!({ "textDocument": document, "options": options }),
        ),
        (
            "codeAction",
            json!({
                "textDocument": document,
                "range": { "start": start, "end": place },
                "context": { "diagnostics": [] },
            }),
        ),
    ];
    for (method, params) in of_text {
        session
            .client
            .result(&format!("textDocument/{method}"), params);
    }
    session.client.diagnostics(URI, version);
}

fn floor(text: &str, offset: usize) -> usize {
    text.floor_char_boundary(offset)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    #[test]
    fn prefixes_and_holes_of_programs_are_answered(
        which in any::<prop::sample::Index>(),
        cuts in prop::collection::vec((any::<prop::sample::Index>(), 0..40usize), 4),
    ) {
        let all = programs();
        let text = which.get(&all);
        let mut session = open(text);
        for (version, (cut, length)) in (2..).zip(&cuts) {
            let at = floor(text, cut.index(text.len() + 1));
            let prefix = &text[..at];
            request_all(&mut session, prefix, 2 * version, at);
            let holed = format!("{prefix}{}", &text[floor(text, at + length)..]);
            request_all(&mut session, &holed, 2 * version + 1, at);
        }
        session.shut_down().unwrap();
    }

    #[test]
    fn any_edit_leaves_the_text_that_the_client_has(
        start in (0..6u32, 0..12u32),
        end in (0..6u32, 0..12u32),
        with in "[a\u{e4}\u{1f916}\n;]{0,6}",
    ) {
        let mut session = open("const a: int = 1;\n(* \u{1f916} *)\n\nconst b: int = 2;\n");
        let at = |(line, character): (u32, u32)| json!({ "line": line, "character": character });
        let range = json!({ "start": at(start), "end": at(end) });
        session.client.change(URI, 2, json!({ "range": range, "text": with }));
        let found: Vec<Value> = session.client.diagnostics(URI, 2);
        prop_assert!(found.iter().all(|one| one["range"]["start"]["line"].is_u64()));
        session.shut_down().unwrap();
    }
}
