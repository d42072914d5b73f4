//! Message framing: a header with the length, then JSON (JSON-RPC 2.0). An invalid message is answered with an error,
//! and reading continues with the next one.

use std::io::{self, BufRead, Read, Write};
use std::sync::mpsc::{Receiver, Sender};

use lsp_server::{ErrorCode, Message, RequestId, Response};
use serde_json::Value;

use crate::cancellation::Cancellations;
use crate::dispatch::RequestError;

/// Message received from the client, or the error response to a message that is invalid.
pub(crate) type Received = Result<Message, Value>;

/// Maximum length of a message in bytes (256 MiB). A longer message is skipped, so that a wrong length cannot exhaust
/// the memory.
const MAX_LENGTH: u64 = 256 << 20;

/// Maximum length of a header line in bytes. A longer line is read in parts of this length.
const MAX_LINE: u64 = 4096;

/// Reads messages from the client until the end of the input, and sends them to the channel. Cancellations of requests
/// are recorded as soon as they arrive.
pub(crate) fn read_all(
    mut input: impl BufRead,
    to: &Sender<Received>,
    cancellations: &Cancellations,
) {
    while let Ok(Some(body)) = read_body(&mut input) {
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
        let text = message.to_string();
        write!(output, "Content-Length: {}\r\n\r\n{text}", text.len())?;
        output.flush()?;
    }
    Ok(())
}

/// Returns the body of the next message, without its header; [`None`] at the end of the input.
fn read_body(input: &mut impl BufRead) -> io::Result<Option<Vec<u8>>> {
    let mut length = None;
    loop {
        let mut line = Vec::new();
        if input.by_ref().take(MAX_LINE).read_until(b'\n', &mut line)? == 0 {
            return Ok(None);
        }
        let line = String::from_utf8_lossy(&line);
        match (line.trim(), length) {
            ("", Some(length)) => return read_exactly(input, length).map(Some),
            // A header without a valid length: skipped, in search of the next header.
            ("", None) => {}
            (field, _) => length = content_length(field).or(length),
        }
    }
}

fn content_length(field: &str) -> Option<u64> {
    let (name, value) = field.split_once(':')?;
    let is_length = name.trim().eq_ignore_ascii_case("content-length");
    let length = value.trim().parse().ok()?;
    (is_length && length <= MAX_LENGTH).then_some(length)
}

fn read_exactly(input: &mut impl BufRead, length: u64) -> io::Result<Vec<u8>> {
    let mut body = Vec::new();
    input.by_ref().take(length).read_to_end(&mut body)?;
    match body.len() as u64 == length {
        true => Ok(body),
        false => Err(io::ErrorKind::UnexpectedEof.into()),
    }
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

    fn bodies(bytes: &[u8]) -> Vec<String> {
        let mut input = bytes;
        let next = || read_body(&mut input).ok().flatten();
        let all = std::iter::from_fn(next);
        all.map(|body| String::from_utf8(body).unwrap()).collect()
    }

    #[test]
    fn bodies_have_the_length_that_the_header_says() {
        let two = b"Content-Length: 2\r\n\r\n{}Content-Type: x\r\ncontent-length:3\r\n\r\n[1]";
        assert_eq!(bodies(two), ["{}", "[1]"]);
    }

    #[test]
    fn what_is_no_header_is_passed_over() {
        assert_eq!(
            bodies(b"rubbish\r\n\r\nContent-Length: x\r\n\r\nContent-Length: 1\r\n\r\n7"),
            ["7"]
        );
        assert_eq!(bodies(b"Content-Length: 9\r\n\r\n{}"), Vec::<String>::new());
        assert_eq!(
            bodies(b"Content-Length: 99999999999999\r\n\r\n"),
            Vec::<String>::new()
        );
    }

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
