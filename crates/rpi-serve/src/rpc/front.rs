//! One client of the native interface.

use serde_json::{Value, json};

use super::methods::METHODS;
use crate::desk::{Failure, Office, Reply};
use crate::wire::{Front, Outbox};

/// A client.
pub(crate) struct RpcFront {
    pub(super) office: Office,
    pub(super) out: Outbox,
    /// Those that it has opened.
    pub(super) sessions: Vec<String>,
}

/// A request on its way through a method.
pub(super) struct Call<'a> {
    pub(super) params: &'a Value,
    pub(super) id: Value,
    pub(super) out: Outbox,
}

/// What a method gives: an answer, or later.
pub(super) type Answer = Result<Option<Value>, Failure>;

impl Front for RpcFront {
    fn hear(&mut self, text: &str) -> bool {
        let request: Value = match serde_json::from_str(text) {
            Ok(request) => request,
            Err(why) => return self.error(&Value::Null, -32700, &why.to_string(), Value::Null),
        };
        match request {
            Value::Array(batch) => batch.iter().all(|request| self.one(request)),
            request => self.one(&request),
        }
    }
}

impl Drop for RpcFront {
    fn drop(&mut self) {
        let mut desk = self.office.desk();
        self.sessions
            .iter()
            .for_each(|name| desk.lose_session(name));
    }
}

impl RpcFront {
    pub(crate) fn new(office: Office, out: Outbox) -> RpcFront {
        RpcFront {
            office,
            out,
            sessions: Vec::new(),
        }
    }

    fn one(&mut self, request: &Value) -> bool {
        let id = request.get("id").cloned().unwrap_or(Value::Null);
        let Some(name) = request.get("method").and_then(Value::as_str) else {
            return self.error(&id, -32600, "this is no request", Value::Null);
        };
        let Some((_, method)) = METHODS.iter().find(|(known, _)| *known == name) else {
            return self.error(
                &id,
                -32601,
                &format!("there is no method {name}"),
                Value::Null,
            );
        };
        let call = Call {
            params: request.get("params").unwrap_or(&Value::Null),
            id: id.clone(),
            out: self.out.clone(),
        };
        match method(self, &call) {
            Ok(None) => true,
            Ok(Some(result)) => call.answer(result),
            Err(why) => call.fail(&why),
        }
    }

    fn error(&self, id: &Value, code: i64, message: &str, data: Value) -> bool {
        self.out.put(error(id, code, message, data))
    }
}

impl Call<'_> {
    pub(super) fn answer(&self, result: Value) -> bool {
        self.out.put(success(&self.id, result))
    }

    fn fail(&self, why: &Failure) -> bool {
        self.out.put(failure(&self.id, why))
    }

    /// Answers once it is done, with what `result` makes of the name of what was made.
    pub(super) fn later(&self, result: impl FnOnce(String) -> Value + Send + 'static) -> Reply {
        let (id, out) = (self.id.clone(), self.out.clone());
        Box::new(move |done| {
            out.put(match done {
                Ok(name) => success(&id, result(name)),
                Err(why) => failure(&id, &why),
            });
        })
    }
}

fn success(id: &Value, result: Value) -> String {
    json!({"jsonrpc": "2.0", "id": id, "result": result}).to_string()
}

fn error(id: &Value, code: i64, message: &str, data: Value) -> String {
    let mut error = json!({"code": code, "message": message});
    if !data.is_null() {
        error["data"] = data;
    }
    json!({"jsonrpc": "2.0", "id": id, "error": error}).to_string()
}

/// Codes of the range that JSON-RPC leaves to servers, and -32602 for parameters.
fn failure(id: &Value, why: &Failure) -> String {
    let (code, data) = match why {
        Failure::Bad(_) => (-32602, Value::Null),
        Failure::Unknown(_) => (-32001, Value::Null),
        Failure::Rejected(reasons) => (-32002, json!({"reasons": reasons})),
        Failure::Refused(_) | Failure::InUse(_) => (-32003, Value::Null),
        Failure::Limit(_) => (-32004, Value::Null),
        Failure::Busy => (-32005, Value::Null),
    };
    error(id, code, &why.to_string(), data)
}
