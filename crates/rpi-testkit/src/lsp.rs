//! Language server client for tests: speaks the protocol over two byte streams.

use std::io::{BufRead, BufReader, Read, Write};

use serde_json::{Value, json};

/// Client of a language server for tests. All methods panic if the server violates the protocol.
pub struct LspClient {
    input: Box<dyn BufRead + Send>,
    output: Box<dyn Write + Send>,
    last_id: i64,
    /// Messages of the server that arrived while the client waited for another message, in order of arrival.
    queued: Vec<Value>,
}

impl LspClient {
    /// Creates a client that reads the output of the server from `input` and writes to the server through `output`.
    pub fn new(
        input: impl Read + Send + 'static,
        output: impl Write + Send + 'static,
    ) -> LspClient {
        LspClient {
            input: Box::new(BufReader::new(input)),
            output: Box::new(output),
            last_id: 0,
            queued: Vec::new(),
        }
    }

    /// Sends bytes to the server unchanged, for tests of invalid messages.
    pub fn write_raw(&mut self, bytes: &[u8]) {
        self.output.write_all(bytes).expect("the server reads");
        self.output.flush().expect("the server reads");
    }

    fn send(&mut self, mut message: Value) {
        message["jsonrpc"] = json!("2.0");
        let text = message.to_string();
        self.write_raw(format!("Content-Length: {}\r\n\r\n{text}", text.len()).as_bytes());
    }

    /// Returns the next message of the server as JSON, or `None` if the server has closed the stream.
    pub fn receive(&mut self) -> Option<Value> {
        let mut length = 0;
        loop {
            let mut line = String::new();
            if self.input.read_line(&mut line).expect("a header") == 0 {
                return None;
            }
            match line.trim().split_once(": ") {
                Some(("Content-Length", n)) => length = n.parse().expect("a length"),
                Some(_) => {}
                None => break,
            }
        }
        let mut body = vec![0; length];
        self.input.read_exact(&mut body).expect("a body");
        Some(serde_json::from_slice(&body).expect("JSON"))
    }

    /// Sends a request, waits for its response and returns the response, which has a `result` or an `error`.
    pub fn request(&mut self, method: &str, params: Value) -> Value {
        self.last_id += 1;
        let id = self.last_id;
        self.send(json!({ "id": id, "method": method, "params": params }));
        loop {
            let message = self.receive().expect("an answer before the server leaves");
            match message.get("method") {
                None if message["id"] == id => return message,
                _ => self.queued.push(message),
            }
        }
    }

    /// Sends a request that must succeed, waits for its response and returns the result.
    pub fn result(&mut self, method: &str, params: Value) -> Value {
        let answer = self.request(method, params);
        assert!(answer.get("error").is_none(), "{method}: {answer}");
        answer["result"].clone()
    }

    /// Sends a request without waiting for its response. Returns its identifier.
    pub fn start_request(&mut self, method: &str, params: Value) -> i64 {
        self.last_id += 1;
        self.send(json!({ "id": self.last_id, "method": method, "params": params }));
        self.last_id
    }

    /// Sends the response to a request of the server.
    pub fn respond(&mut self, id: Value, result: Value) {
        self.send(json!({ "id": id, "result": result }));
    }

    /// Sends a notification to the server.
    pub fn notify(&mut self, method: &str, params: Value) {
        self.send(json!({ "method": method, "params": params }));
    }

    /// Waits for the next notification or request of the server with the name `method`, and returns its parameters.
    pub fn await_method(&mut self, method: &str) -> Value {
        let found = self.queued.iter().position(|m| m["method"] == method);
        if let Some(at) = found {
            return self.queued.remove(at)["params"].clone();
        }
        loop {
            let message = self.receive().expect("a message before the server leaves");
            match message["method"] == method {
                true => return message["params"].clone(),
                false => self.queued.push(message),
            }
        }
    }

    /// Waits until the server publishes the diagnostics of a version of the document `uri`, and returns them.
    pub fn diagnostics(&mut self, uri: &str, version: i64) -> Vec<Value> {
        loop {
            let params = self.await_method("textDocument/publishDiagnostics");
            if params["uri"] == uri && params["version"] == version {
                return params["diagnostics"]
                    .as_array()
                    .cloned()
                    .unwrap_or_default();
            }
        }
    }

    /// Starts a session: sends `initialize` with the capabilities of the client, then `initialized`. Returns the result
    /// of `initialize`.
    pub fn initialize(&mut self, capabilities: Value) -> Value {
        self.initialize_with(json!({ "capabilities": capabilities }))
    }

    /// Starts a session as [`LspClient::initialize`] does, with all parameters of the `initialize` request, such as the
    /// folders of the workspace.
    pub fn initialize_with(&mut self, mut params: Value) -> Value {
        params["processId"] = Value::Null;
        let result = self.result("initialize", params);
        self.notify("initialized", json!({}));
        result
    }

    /// Opens a document with the given text as version 1.
    pub fn open(&mut self, uri: &str, text: &str) {
        let document = json!({ "uri": uri, "languageId": "rpi", "version": 1, "text": text });
        self.notify("textDocument/didOpen", json!({ "textDocument": document }));
    }

    /// Sends one change of a document in the form of the protocol. `version` is the version after the change.
    pub fn change(&mut self, uri: &str, version: i64, change: Value) {
        let document = json!({ "uri": uri, "version": version });
        let params = json!({ "textDocument": document, "contentChanges": [change] });
        self.notify("textDocument/didChange", params);
    }

    /// Ends the session: sends `shutdown` and `exit`, and reads until the server closes the stream.
    pub fn shutdown(&mut self) {
        assert_eq!(self.result("shutdown", Value::Null), Value::Null);
        self.notify("exit", Value::Null);
        while self.receive().is_some() {}
    }
}
