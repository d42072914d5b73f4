//! Delivery of answers: a single request is answered directly, a batch by one message, a notification not at all
//! (JSON-RPC 2.0, sections 4.1 and 6).

use std::sync::{Arc, Mutex, PoisonError};

use serde_json::{Value, json};

use crate::state::ApiError;
use crate::transport::{Outbox, QueueSpace};

/// Maximum length of an id in bytes. The id of a request that is answered later stays in memory until then.
const MAX_ID_BYTES: usize = 256;

/// Destination of the answer to a JSON-RPC request: a message of its own, or a part of the answer to a batch.
#[derive(Clone)]
pub(super) struct ReplyTarget {
    /// Id of the request, which the answer repeats, or null for an invalid id; `None` for a notification, which has no
    /// answer.
    id: Option<Value>,
    has_valid_id: bool,
    delivery: Delivery,
}

#[derive(Clone)]
enum Delivery {
    Single(Outbox),
    Batch(Arc<Mutex<Batch>>),
}

/// Answers to the requests of a JSON-RPC batch, sent together once all are answered.
struct Batch {
    /// Number of requests that are not answered yet.
    left: usize,
    /// JSON texts of the answers so far, separated by commas.
    answers: String,
    /// Memory that is reserved for the answers.
    space: QueueSpace,
    /// Maximum total length of the answers in bytes.
    most: usize,
    /// Whether the answers exceed the maximum length. Then the further answers are replaced by one error.
    is_too_long: bool,
    out: Outbox,
}

impl ReplyTarget {
    /// Creates the destination for a single request.
    pub(super) fn single(request: &Value, out: &Outbox) -> ReplyTarget {
        ReplyTarget::new(request, Delivery::Single(out.clone()))
    }

    /// Creates a destination for each request of a batch. All answers together may have at most `most` bytes.
    pub(super) fn batch(requests: &[Value], out: &Outbox, most: usize) -> Vec<ReplyTarget> {
        let batch = Batch {
            left: requests.len(),
            answers: String::new(),
            space: out.space(),
            most,
            is_too_long: false,
            out: out.clone(),
        };
        let batch = Arc::new(Mutex::new(batch));
        let one = |request| ReplyTarget::new(request, Delivery::Batch(Arc::clone(&batch)));
        requests.iter().map(one).collect()
    }

    fn new(request: &Value, delivery: Delivery) -> ReplyTarget {
        let given = request.get("id");
        let valid = |id: &Value| {
            if is_valid_id(id) {
                id.clone()
            } else {
                Value::Null
            }
        };
        ReplyTarget {
            id: given.map(valid),
            has_valid_id: given.is_none_or(is_valid_id),
            delivery,
        }
    }

    /// Sends the result of the request. Returns false if the client is disconnected.
    pub(super) fn success(&self, result: Value) -> bool {
        self.send(json!({"result": result}))
    }

    /// Sends the error code and message of a failed request. Returns false if the client is disconnected.
    pub(super) fn failure(&self, why: &ApiError) -> bool {
        let (code, data) = error_code(why);
        self.error(code, &why.to_string(), data)
    }

    /// Sends an error as the answer, with a JSON-RPC error code and a message. `data` is left out if it is null.
    /// Returns false if the client is disconnected.
    pub(super) fn error(&self, code: i64, message: &str, data: Value) -> bool {
        let mut error = json!({"code": code, "message": message});
        if !data.is_null() {
            error["data"] = data;
        }
        self.send(json!({"error": error}))
    }

    /// Returns whether the id has a type that JSON-RPC 2.0 allows (section 4): text, whole number or null, or no id at
    /// all. A text is short.
    pub(super) fn has_valid_id(&self) -> bool {
        self.has_valid_id
    }

    /// Answers a request that is not valid JSON-RPC with an error, even if the request has no id. Returns false if the
    /// client is disconnected.
    pub(super) fn invalid_request(self) -> bool {
        self.or_null_id()
            .error(-32600, "invalid request", Value::Null)
    }

    /// Returns the destination with the id null if the request has no id, so that even such a request is answered.
    pub(super) fn or_null_id(mut self) -> ReplyTarget {
        self.id.get_or_insert(Value::Null);
        self
    }

    fn send(&self, mut answer: Value) -> bool {
        answer["jsonrpc"] = json!("2.0");
        let answer = self.id.as_ref().map(|id| {
            answer["id"] = id.clone();
            answer
        });
        match (&self.delivery, answer) {
            (Delivery::Single(out), Some(answer)) => out.queue(answer.to_string()),
            (Delivery::Single(_), None) => true,
            (Delivery::Batch(batch), answer) => {
                let mut batch = batch.lock().unwrap_or_else(PoisonError::into_inner);
                batch.take(answer)
            }
        }
    }
}

impl Batch {
    fn take(&mut self, answer: Option<Value>) -> bool {
        if let Some(answer) = answer {
            self.add(&answer.to_string());
        }
        self.left = self.left.saturating_sub(1);
        // JSON-RPC 2.0, section 6: all answers in one array, and no answer at all to a batch of notifications.
        if self.left > 0 || self.answers.is_empty() && !self.is_too_long {
            return true;
        }
        if self.is_too_long {
            let message = format!(
                "the answers have more than {} bytes, or more than the server has memory for",
                self.most
            );
            let error = json!({"code": -32004, "message": message});
            let answer = json!({"jsonrpc": "2.0", "id": null, "error": error});
            self.push(&answer.to_string());
        }
        let answers = std::mem::take(&mut self.answers);
        let space = std::mem::replace(&mut self.space, self.out.space());
        self.out.queue_in(format!("[{answers}]"), space)
    }

    /// Adds an answer to the batch, unless the answers would exceed their maximum length.
    fn add(&mut self, answer: &str) {
        self.is_too_long |= self.answers.len() + answer.len() > self.most;
        // The text is copied once, into brackets.
        self.is_too_long |= !self.is_too_long && !self.space.grow(2 * answer.len());
        if !self.is_too_long {
            self.push(answer);
        }
    }

    fn push(&mut self, answer: &str) {
        if !self.answers.is_empty() {
            self.answers.push(',');
        }
        self.answers.push_str(answer);
    }
}

/// Returns whether the answer to a request can repeat its id.
fn is_valid_id(id: &Value) -> bool {
    match id {
        Value::Null => true,
        Value::Number(number) => number.is_i64() || number.is_u64(),
        Value::String(text) => text.len() <= MAX_ID_BYTES,
        Value::Bool(_) | Value::Array(_) | Value::Object(_) => false,
    }
}

/// Returns the JSON-RPC error code for an error, and data about the error: -32602 for invalid parameters, else a code
/// from the range that JSON-RPC reserves for servers.
fn error_code(why: &ApiError) -> (i64, Value) {
    match why {
        ApiError::Invalid(_) => (-32602, Value::Null),
        ApiError::Unknown(_) => (-32001, Value::Null),
        ApiError::Rejected(reasons) => (-32002, json!({"reasons": reasons})),
        ApiError::Refused(_) | ApiError::InUse(_) | ApiError::ResourceHeld(_) => {
            (-32003, Value::Null)
        }
        ApiError::Limit(_)
        | ApiError::ClientShare(_)
        | ApiError::PeerShare(_)
        | ApiError::NoPlace => (-32004, Value::Null),
        ApiError::Forbidden(_) => (-32009, Value::Null),
        ApiError::OverBudget(why) => {
            let [needed, taken, granted] =
                [why.needed_ns, why.taken_ns, why.granted_ns].map(|ns| ns as f64 * 1e-9);
            (
                -32008,
                json!({"needed": needed, "taken": taken, "granted": granted}),
            )
        }
        ApiError::QueueFull => (-32005, Value::Null),
        ApiError::EmergencyStop(_) => (-32006, Value::Null),
        ApiError::NotOwner(_) => (-32007, Value::Null),
    }
}
