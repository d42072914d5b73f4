//! Session with a server in this process, and positions by text search.

use std::io::BufReader;
use std::thread::JoinHandle;

use rpi_testkit::LspClient;
use serde_json::{Value, json};

/// URI of the main document of a session.
pub(crate) const URI: &str = "file:///cell/main.rpi";

/// Client with its server thread.
pub(crate) struct Session {
    pub(crate) client: LspClient,
    server: JoinHandle<std::io::Result<()>>,
}

/// Starts a server and a connected client.
pub(crate) fn connect() -> Session {
    let (server_in, client_out) = std::io::pipe().unwrap();
    let (client_in, server_out) = std::io::pipe().unwrap();
    let serve = || rpi_lsp::serve(BufReader::new(server_in), server_out);
    Session {
        client: LspClient::new(client_in, client_out),
        server: std::thread::spawn(serve),
    }
}

/// Starts a session with one open document.
pub(crate) fn open(text: &str) -> Session {
    let mut session = connect();
    session.client.initialize(json!({}));
    session.client.open(URI, text);
    session
}

impl Session {
    /// Ends the session with `shutdown` and `exit`. Returns the result of the server.
    pub(crate) fn shut_down(mut self) -> std::io::Result<()> {
        self.client.shutdown();
        self.server.join().unwrap()
    }

    /// Disconnects without `shutdown`. Returns the result of the server.
    pub(crate) fn disconnect(self) -> std::io::Result<()> {
        drop(self.client);
        self.server.join().unwrap()
    }

    /// Returns the result of a request about a position.
    pub(crate) fn request_at(&mut self, method: &str, position: &Value) -> Value {
        let params = json!({
            "textDocument": { "uri": URI },
            "position": position,
            "context": { "includeDeclaration": true, "triggerKind": 1, "isRetrigger": false },
        });
        self.client
            .result(&format!("textDocument/{method}"), params)
    }

    /// Returns the Markdown text of the hover at a position.
    pub(crate) fn hover(&mut self, position: &Value) -> String {
        let hover = self.request_at("hover", position);
        hover["contents"]["value"]
            .as_str()
            .unwrap_or_default()
            .to_owned()
    }

    /// Returns the labels of the completion items at a position.
    pub(crate) fn labels(&mut self, position: &Value) -> Vec<String> {
        let list = self.request_at("completion", position);
        let items = list["items"].as_array().cloned().unwrap_or_default();
        let label = |item: &Value| item["label"].as_str().unwrap_or_default().to_owned();
        items.iter().map(label).collect()
    }
}

/// Returns the start position of the `n`-th occurrence of `what`, counted from 0.
pub(crate) fn position(text: &str, what: &str, n: usize) -> Value {
    let (offset, _) = text
        .match_indices(what)
        .nth(n)
        .expect("it stands in the text");
    position_of(text, offset)
}

/// Returns the position of a byte offset, in UTF-16 units.
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

/// Removes the cursor mark `|` from a text. Returns the text and the position of the cursor.
pub(crate) fn cursor(marked: &str) -> (String, Value) {
    let offset = marked.find('|').expect("a cursor");
    let text = marked.replacen('|', "", 1);
    let position = position_of(&text, offset);
    (text, position)
}
