//! A session with the server in this process, and places in texts by what stands there.

use std::io::BufReader;
use std::thread::JoinHandle;

use rpi_testkit::LspClient;
use serde_json::{Value, json};

/// The address of the text that a session is about.
pub(crate) const URI: &str = "file:///cell/main.rpi";

/// A client, and the thread that serves it.
pub(crate) struct Session {
    pub(crate) client: LspClient,
    server: JoinHandle<std::io::Result<()>>,
}

/// Starts a server and a client that are connected.
pub(crate) fn connect() -> Session {
    let (server_in, client_out) = std::io::pipe().unwrap();
    let (client_in, server_out) = std::io::pipe().unwrap();
    let serve = || rpi_lsp::serve(BufReader::new(server_in), server_out);
    Session {
        client: LspClient::new(client_in, client_out),
        server: std::thread::spawn(serve),
    }
}

/// A session with one text open.
pub(crate) fn open(text: &str) -> Session {
    let mut session = connect();
    session.client.initialize(json!({}));
    session.client.open(URI, text);
    session
}

impl Session {
    /// Ends the session as clients should; how the server ended.
    pub(crate) fn leave(mut self) -> std::io::Result<()> {
        self.client.leave();
        self.server.join().unwrap()
    }

    /// Goes away without a word.
    pub(crate) fn vanish(self) -> std::io::Result<()> {
        drop(self.client);
        self.server.join().unwrap()
    }

    /// The result of a request about a position.
    pub(crate) fn at(&mut self, method: &str, position: &Value) -> Value {
        let params = json!({
            "textDocument": { "uri": URI },
            "position": position,
            "context": { "includeDeclaration": true, "triggerKind": 1 },
        });
        self.client
            .result(&format!("textDocument/{method}"), params)
    }

    /// What is shown where a pointer rests.
    pub(crate) fn hover(&mut self, position: &Value) -> String {
        let hover = self.at("hover", position);
        hover["contents"]["value"]
            .as_str()
            .unwrap_or_default()
            .to_owned()
    }

    /// The labels of what could be written.
    pub(crate) fn labels(&mut self, position: &Value) -> Vec<String> {
        let list = self.at("completion", position);
        let items = list["items"].as_array().cloned().unwrap_or_default();
        let label = |item: &Value| item["label"].as_str().unwrap_or_default().to_owned();
        items.iter().map(label).collect()
    }
}

/// The position at which the `n`-th occurrence of `what` begins, counted from 0.
pub(crate) fn position(text: &str, what: &str, n: usize) -> Value {
    let (offset, _) = text
        .match_indices(what)
        .nth(n)
        .expect("it stands in the text");
    position_of(text, offset)
}

/// The position of a byte, in UTF-16 units.
pub(crate) fn position_of(text: &str, offset: usize) -> Value {
    let before = &text[..offset];
    let line = before.matches('\n').count();
    let column = before
        .rsplit('\n')
        .next()
        .unwrap_or("")
        .encode_utf16()
        .count();
    json!({ "line": line, "character": column })
}

/// A text with `|` where the cursor is: without it, and the position.
pub(crate) fn cursor(marked: &str) -> (String, Value) {
    let offset = marked.find('|').expect("a cursor");
    let text = marked.replacen('|', "", 1);
    let position = position_of(&text, offset);
    (text, position)
}
