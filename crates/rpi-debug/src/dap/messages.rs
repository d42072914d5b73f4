//! Requests, responses and events of the protocol.

use std::io::{self, Write};

use rpi_files::framing::write_message;
use serde_json::{Value, json};

/// Result of a request: the body of its response, or the message of an error.
pub(super) type Answer = Result<Value, String>;

/// Writer of responses and events, which have consecutive numbers.
pub(super) struct Client<W> {
    output: W,
    sequence: u64,
}

impl<W: Write> Client<W> {
    pub(super) fn new(output: W) -> Client<W> {
        Client {
            output,
            sequence: 0,
        }
    }

    /// Returns where the messages are written.
    pub(super) fn output(&mut self) -> &mut W {
        &mut self.output
    }

    /// Answers a request.
    pub(super) fn respond(&mut self, request: &Value, answer: Answer) -> io::Result<()> {
        let mut response = json!({
            "type": "response",
            "request_seq": request["seq"],
            "command": request["command"],
            "success": answer.is_ok(),
        });
        match answer {
            Ok(Value::Null) => {}
            Ok(body) => response["body"] = body,
            Err(message) => {
                let error = json!({ "id": 1, "format": message, "showUser": true });
                response["body"] = json!({ "error": error });
                response["message"] = json!(message);
            }
        }
        self.send(response)
    }

    /// Sends an event.
    pub(super) fn event(&mut self, name: &str, body: Value) -> io::Result<()> {
        self.send(json!({ "type": "event", "event": name, "body": body }))
    }

    fn send(&mut self, mut message: Value) -> io::Result<()> {
        self.sequence += 1;
        message["seq"] = json!(self.sequence);
        write_message(&mut self.output, &message.to_string())
    }
}

/// What the debugger can do, in answer to `initialize`.
pub(super) fn capabilities() -> Value {
    json!({
        "supportsConfigurationDoneRequest": true,
        "supportsFunctionBreakpoints": true,
        "supportsConditionalBreakpoints": true,
        "supportsDataBreakpoints": true,
        "supportsEvaluateForHovers": true,
        "supportsStepBack": true,
        "supportsSteppingGranularity": true,
        "supportsLoadedSourcesRequest": true,
        "supportsTerminateRequest": true,
        "supportsGotoTargetsRequest": false,
        "supportTerminateDebuggee": false,
        "exceptionBreakpointFilters": [],
    })
}
