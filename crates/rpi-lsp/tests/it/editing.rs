//! Random editing of three files that use one another: no error response, and in the end the diagnostics of a server that
//! sees only the last texts.
//!
//! `RPI_EDIT_SECONDS=3600` edits for an hour instead of some hundred steps, and checks that the memory stays the same.

use std::time::{Duration, Instant};

use rpi_testkit::{files_below, resident_memory_kb};
use serde_json::{Value, json};

use crate::support::{Session, connect, position_of};

/// Number of steps of a short run.
const STEPS: usize = 250;

/// Growth of the memory in kilobytes that a long run may show after its first tenth.
const MEMORY_GROWTH_KB: u64 = 64 << 10;

const NAMES: [&str; 3] = ["main.rpi", "parts.rpi", "more.rpi"];

/// Methods about a position, of which one follows each step.
const REQUESTS: &[&str] = &[
    "hover",
    "completion",
    "signatureHelp",
    "definition",
    "typeDefinition",
    "references",
    "documentHighlight",
    "linkedEditingRange",
    "prepareCallHierarchy",
];

/// Methods about a document.
const DOCUMENT_REQUESTS: &[&str] = &[
    "documentSymbol",
    "codeLens",
    "foldingRange",
    "documentLink",
    "semanticTokens/full",
];

/// Pseudo-random numbers (xorshift, Marsaglia 2003): the same on every machine.
struct Random(u64);

impl Random {
    fn below(&mut self, bound: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % bound.max(1) as u64) as usize
    }
}

/// Files that are open in an editor, with the texts that it has.
struct Editor {
    session: Session,
    dir: tempfile::TempDir,
    texts: [String; 3],
    version: i64,
    random: Random,
    /// Texts of real programs, from which pasted parts are taken.
    sources: Vec<String>,
}

impl Editor {
    fn new(seed: u64) -> Editor {
        let dir = tempfile::tempdir().unwrap();
        let parts = "function twice (x: int) returns (y: int)\nlet\n  y = 2 * x;\ntel\n";
        let texts = [
            "use parts, more, motion;\nnode Main (a: int) returns (b: int)\nlet\n  b = twice(a) + n;\ntel\n",
            parts,
            "use parts;\nconst n: int = 3;\nnode More (a: int) returns (b: int)\nlet\n  b = twice(x: a);\ntel\n",
        ];
        let files = files_below("examples", &[".rpi"]).into_iter();
        let files = files.chain(files_below("stdlib", &[".rpi"]));
        let mut editor = Editor {
            session: connect(),
            dir,
            texts: texts.map(str::to_owned),
            version: 1,
            random: Random(seed),
            sources: files
                .map(|path| std::fs::read_to_string(path).unwrap())
                .collect(),
        };
        editor.session.client.initialize(json!({}));
        for (k, text) in texts.iter().enumerate() {
            std::fs::write(editor.dir.path().join(NAMES[k]), text).unwrap();
            let uri = editor.uri(k);
            editor.session.client.open(&uri, text);
        }
        editor
    }

    fn uri(&self, k: usize) -> String {
        format!("file://{}", self.dir.path().join(NAMES[k]).display())
    }

    fn place(&mut self, k: usize) -> usize {
        let at = self.random.below(self.texts[k].len() + 1);
        self.texts[k].floor_char_boundary(at)
    }

    fn replace(&mut self, k: usize, range: std::ops::Range<usize>, new: &str) {
        let [start, end] = [range.start, range.end].map(|at| position_of(&self.texts[k], at));
        self.version += 1;
        let change = json!({ "range": { "start": start, "end": end }, "text": new });
        let uri = self.uri(k);
        self.session.client.change(&uri, self.version, change);
        self.texts[k].replace_range(range, new);
    }

    fn step(&mut self) {
        let k = self.random.below(3);
        let at = self.place(k);
        match self.random.below(10) {
            0..=4 => {
                let typed = [
                    "x", " ", "\n", "=", ";", "(", ".", "twice", "\u{e4}", "let", "tel", "0", "--",
                ];
                let new = typed[self.random.below(typed.len())];
                self.replace(k, at..at, new);
            }
            5 | 6 => {
                let end = (at + 1 + self.random.below(12)).min(self.texts[k].len());
                let end = self.texts[k].floor_char_boundary(end).max(at);
                self.replace(k, at..end, "");
            }
            7 => self.paste(k, at),
            8 => self.rename(k, at),
            _ => self.save(k),
        }
        self.request(k);
    }

    /// Pastes some lines of a real program, or replaces the text by a whole one if it has grown long.
    fn paste(&mut self, k: usize, at: usize) {
        let source = self.random.below(self.sources.len());
        let source = self.sources[source].clone();
        let lines: Vec<&str> = source.split_inclusive('\n').collect();
        let start = self.random.below(lines.len());
        let some: String = lines[start..]
            .iter()
            .take(1 + self.random.below(8))
            .copied()
            .collect();
        match self.texts[k].len() > 8000 {
            true => self.replace(k, 0..self.texts[k].len(), &source),
            false => self.replace(k, at..at, &some),
        }
    }

    /// Renames the name at a place, if that is possible, and applies the edits.
    fn rename(&mut self, k: usize, at: usize) {
        let params = json!({
            "textDocument": { "uri": self.uri(k) },
            "position": position_of(&self.texts[k], at),
            "newName": format!("name_{}", self.random.below(1000)),
        });
        let answer = self.session.client.request("textDocument/rename", params);
        let code = answer["error"]["code"].as_i64();
        // -32803: rejected with the reason.
        assert!(matches!(code, None | Some(-32803)), "{answer}");
        for (uri, edits) in crate::edits::changes(&answer["result"]) {
            let Some(file) = (0..3).find(|file| self.uri(*file) == uri) else {
                continue;
            };
            let new = crate::edits::apply(&self.texts[file], &edits);
            let length = self.texts[file].len();
            self.replace(file, 0..length, &new);
        }
    }

    fn save(&mut self, k: usize) {
        let path = self.dir.path().join(NAMES[k]);
        std::fs::write(path, &self.texts[k]).unwrap();
        let changes = json!({ "changes": [{ "uri": self.uri(k), "type": 2 }] });
        self.session
            .client
            .notify("workspace/didChangeWatchedFiles", changes);
    }

    /// Sends a request about a random position, or about the document; an error response is a failure.
    fn request(&mut self, k: usize) {
        let at = self.place(k);
        let document = json!({ "uri": self.uri(k) });
        let which = self.random.below(REQUESTS.len() + DOCUMENT_REQUESTS.len());
        let (method, params) = match REQUESTS.get(which) {
            Some(method) => (
                *method,
                json!({
                    "textDocument": document,
                    "position": position_of(&self.texts[k], at),
                    "context": { "includeDeclaration": true, "triggerKind": 1, "isRetrigger": false },
                }),
            ),
            None => (
                DOCUMENT_REQUESTS[which - REQUESTS.len()],
                json!({ "textDocument": document }),
            ),
        };
        self.session
            .client
            .result(&format!("textDocument/{method}"), params);
    }

    /// Returns the diagnostics of each document.
    fn diagnostics(&mut self) -> Vec<Value> {
        let pull = |editor: &mut Editor, k: usize| {
            let params = json!({ "textDocument": { "uri": editor.uri(k) } });
            let report = editor
                .session
                .client
                .result("textDocument/diagnostic", params);
            report["items"].clone()
        };
        (0..3).map(|k| pull(self, k)).collect()
    }

    /// Compares the diagnostics with those of a new server that opens the last texts.
    fn check(&mut self) {
        let found = self.diagnostics();
        let mut fresh = connect();
        fresh.client.initialize(json!({}));
        for k in 0..3 {
            fresh.client.open(&self.uri(k), &self.texts[k]);
        }
        for (k, found) in found.iter().enumerate() {
            let params = json!({ "textDocument": { "uri": self.uri(k) } });
            let report = fresh.client.result("textDocument/diagnostic", params);
            assert_eq!(&report["items"], found, "{}:\n{}", NAMES[k], self.texts[k]);
        }
        fresh.shut_down().unwrap();
    }
}

#[test]
fn random_edits_leave_the_diagnostics_of_the_last_texts() {
    let seconds = std::env::var("RPI_EDIT_SECONDS")
        .ok()
        .and_then(|text| text.parse().ok());
    let Some(seconds) = seconds else {
        let mut editor = Editor::new(0x5eed);
        for step in 1..=STEPS {
            editor.step();
            if step % 50 == 0 {
                editor.check();
            }
        }
        return editor.session.shut_down().unwrap();
    };
    long_run(Duration::from_secs(seconds));
}

/// Edits for some time, and compares the memory after a tenth of it with the memory in the end.
fn long_run(length: Duration) {
    let begun = Instant::now();
    let mut editor = Editor::new(std::process::id().into());
    let (mut steps, mut settled) = (0_u64, None);
    while begun.elapsed() < length {
        editor.step();
        steps += 1;
        if steps.is_multiple_of(200) {
            editor.check();
        }
        if settled.is_none() && begun.elapsed() > length / 10 {
            settled = Some(resident_memory_kb("VmRSS:"));
        }
    }
    let (settled, last) = (settled.unwrap_or(0), resident_memory_kb("VmRSS:"));
    println!("{steps} steps, {settled} kB after a tenth, {last} kB in the end");
    assert!(
        last < settled + MEMORY_GROWTH_KB,
        "{settled} kB grew to {last} kB"
    );
    editor.session.shut_down().unwrap();
}
