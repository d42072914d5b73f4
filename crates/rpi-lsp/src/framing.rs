//! Messages of the protocol: JSON-RPC 2.0. An invalid message is answered with an error,
//! and reading continues with the next one.

use std::io::{self, BufRead, Write};
use std::sync::mpsc::{Receiver, Sender};

use lsp_server::{ErrorCode, Message, RequestId, Response};
use rpi_files::framing::{read_message, write_message};
use serde_json::Value;

use crate::cancellation::Cancellations;
use crate::dispatch::RequestError;

/// Message received from the client, or the error response to a message that is invalid.
pub(crate) type Received = Result<Message, Value>;

/// Reads messages from the client until the end of the input, and sends them to the channel. Cancellations of requests
/// are recorded as soon as they arrive.
pub(crate) fn read_all(
    mut input: impl BufRead,
    to: &Sender<Received>,
    cancellations: &Cancellations,
) {
    while let Ok(Some(body)) = read_message(&mut input) {
        let message = parse_message(&body);
        if let Ok(message) = &message {
            cancellations.record(message);
        }
        if to.send(message).is_err() {
            return;
        }
    }
}

/// Writes the messages of a channel to the client until the channel is closed.
///
/// # Errors
/// Returns an error if writing fails.
pub(crate) fn write_all(mut output: impl Write, from: &Receiver<Value>) -> io::Result<()> {
    for message in from {
        write_message(&mut output, &message.to_string())?;
    }
    Ok(())
}

fn parse_message(body: &[u8]) -> Received {
    let value: Value = serde_json::from_slice(body).map_err(|e| {
        error_response(
            Value::Null,
            ErrorCode::ParseError,
            &format!("invalid JSON: {e}"),
        )
    })?;
    let id = value.get("id").cloned().unwrap_or(Value::Null);
    let text = "not a request, notification or response";
    let invalid = || error_response(id, ErrorCode::InvalidRequest, text);
    // Without this check, a message with a method that is not a string would be parsed as a response.
    match value.get("method").is_none_or(Value::is_string) {
        true => serde_json::from_value(value).map_err(|_| invalid()),
        false => Err(invalid()),
    }
}

/// Returns the error response to an invalid message as JSON. `id` is the identifier of the message, or null if it is
/// unknown.
fn error_response(id: Value, code: ErrorCode, text: &str) -> Value {
    let error = serde_json::json!({ "code": code as i32, "message": text });
    serde_json::json!({ "jsonrpc": "2.0", "id": id, "error": error })
}

/// Converts a message to JSON, with the field `jsonrpc` that gives the version of the protocol.
pub(crate) fn to_json(message: impl Into<Message>) -> Value {
    let mut value = serde_json::to_value(message.into()).unwrap_or_default();
    value["jsonrpc"] = Value::from("2.0");
    value
}

/// Returns the JSON-RPC response to the request `id` of the client: the result, or an error with code and message.
pub(crate) fn response(id: RequestId, result: Result<Value, RequestError>) -> Value {
    to_json(match result {
        Ok(value) => Response::new_ok(id, value),
        Err(error) => Response::new_err(id, error.code, error.message),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_message_is_answered_with_its_number() {
        let parse_error = parse_message(b"{oops").unwrap_err();
        assert_eq!(parse_error["error"]["code"], -32700);
        let invalid = parse_message(br#"{"jsonrpc":"2.0","id":7,"method":3}"#).unwrap_err();
        assert_eq!(
            (&invalid["id"], &invalid["error"]["code"]),
            (&7.into(), &(-32600).into())
        );
    }
}
