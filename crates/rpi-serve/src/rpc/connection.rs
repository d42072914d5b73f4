//! JSON-RPC connection of one client.

use serde_json::{Value, json};

use super::methods::{METHODS, Method};
use super::reply_target::ReplyTarget;
use crate::limits::Limits;
use crate::message_size::{max_values, wait_for_turn};
use crate::role::Identity;
use crate::state::{ApiError, Client, Reply, SharedState};
use crate::transport::{ConnectionHandler, Outbox};

/// JSON-RPC connection of one client.
pub(crate) struct RpcConnection {
    pub(super) state: SharedState,
    pub(super) client: Client,
    /// Name, role and network origin of the client.
    pub(super) who: Identity,
    pub(super) outbox: Outbox,
    limits: Limits,
    /// Names of the sessions that belong to this client: opened by the client, or taken over from a disconnected one.
    pub(super) sessions: Vec<String>,
}

/// JSON-RPC request that is being carried out: its parameters, and the destination of its answer.
pub(super) struct Call<'a> {
    pub(super) params: &'a Value,
    answers: ReplyTarget,
}

/// Result of a JSON-RPC method, to be sent as the answer. `None` if the answer follows later or was sent already.
pub(super) type MethodResult = Result<Option<Value>, ApiError>;

impl ConnectionHandler for RpcConnection {
    fn on_message(&mut self, text: &str) -> bool {
        let nobody = json!({"id": null});
        let (values, most) = (max_values(text), self.limits.json_values);
        if values > most {
            let why = format!("a message has at most {most} values");
            return ReplyTarget::single(&nobody, &self.outbox).error(-32600, &why, Value::Null);
        }
        let _turn = wait_for_turn(text, values);
        let request: Value = match serde_json::from_str(text) {
            Ok(request) => request,
            Err(why) => {
                let answers = ReplyTarget::single(&nobody, &self.outbox);
                return answers.error(-32700, &why.to_string(), Value::Null);
            }
        };
        match request {
            Value::Array(batch) if batch.is_empty() => {
                ReplyTarget::single(&nobody, &self.outbox).invalid_request()
            }
            Value::Array(batch) if batch.len() > self.limits.batch_requests => {
                let most = self.limits.batch_requests;
                let why = format!("a batch has at most {most} requests, found {}", batch.len());
                ReplyTarget::single(&nobody, &self.outbox).error(-32600, &why, Value::Null)
            }
            Value::Array(batch) => {
                let most = self.limits.queued_bytes / 2;
                let answers = ReplyTarget::batch(&batch, &self.outbox, most);
                let mut all = batch.iter().zip(answers);
                all.all(|(request, answers)| self.handle_request(request, answers))
            }
            request => {
                let answers = ReplyTarget::single(&request, &self.outbox);
                self.handle_request(&request, answers)
            }
        }
    }

    fn on_error(&mut self, why: &str) {
        ReplyTarget::single(&json!({"id": null}), &self.outbox).error(-32600, why, Value::Null);
    }
}

impl Drop for RpcConnection {
    fn drop(&mut self) {
        self.outbox.close();
        self.state
            .lock()
            .on_client_lost(self.client, &self.sessions);
    }
}

impl RpcConnection {
    /// Creates the connection of a new client with the identity `who`. `out` is the queue of messages to the client.
    pub(crate) fn new(
        state: SharedState,
        who: Identity,
        out: Outbox,
        limits: Limits,
    ) -> RpcConnection {
        let client = state.lock().objects.client(&who);
        RpcConnection {
            state,
            client,
            who,
            outbox: out,
            limits,
            sessions: Vec::new(),
        }
    }

    fn handle_request(&mut self, request: &Value, answers: ReplyTarget) -> bool {
        let is_ours = request
            .get("jsonrpc")
            .is_some_and(|version| version == "2.0");
        let name = request.get("method").and_then(Value::as_str);
        let Some(name) = name else {
            return answers.invalid_request();
        };
        let Some(method) = METHODS.iter().find(|known| known.name == name) else {
            let known = METHODS.iter().map(|known| known.name);
            let why = format!("there is no method {name}{}", suggestion(name, known));
            return answers.error(-32601, &why, Value::Null);
        };
        if method.is_checked && !is_ours {
            let why = "invalid request: `\"jsonrpc\": \"2.0\"` is missing";
            return answers.or_null_id().error(-32600, why, Value::Null);
        }
        if method.is_checked && !answers.has_valid_id() {
            let why = "the id must be a text of at most 256 bytes, a whole number or null";
            return answers.error(-32600, why, Value::Null);
        }
        let call = Call {
            params: request.get("params").unwrap_or(&Value::Null),
            answers,
        };
        let done = self
            .who
            .ensure(method.needs, name)
            .and_then(|()| call.check_params(method))
            .and_then(|()| (method.handler)(self, &call));
        match done {
            Ok(None) => true,
            Ok(Some(result)) => call.answer(result),
            Err(why) => call.answers.failure(&why),
        }
    }

    /// Returns an error if one of these commands, tasks or sessions belongs to another client.
    pub(super) fn ensure_may_act(&self, names: &[&str]) -> Result<(), ApiError> {
        let state = self.state.lock();
        names
            .iter()
            .try_for_each(|name| state.objects.may_act(self.client, name))
    }
}

impl Call<'_> {
    /// Returns an error if the request has a parameter that the method does not know. A misspelt optional parameter
    /// would otherwise be ignored.
    fn check_params(&self, method: &Method) -> Result<(), ApiError> {
        let known = method.params;
        let given = match self.params {
            _ if !method.is_checked => return Ok(()),
            Value::Null => return Ok(()),
            Value::Object(given) => given,
            _ => {
                let why = "params: expected an object with the parameters by name";
                return Err(ApiError::Invalid(why.to_owned()));
            }
        };
        let name = method.name;
        let unknown = given.keys().find(|key| !known.contains(&key.as_str()));
        unknown.map_or(Ok(()), |key| {
            let meant = suggestion(key, known.iter().copied());
            Err(ApiError::Invalid(format!(
                "{name} has no parameter {key}{meant}"
            )))
        })
    }

    /// Sends the result of the request. Returns false if the client is disconnected.
    pub(super) fn answer(&self, result: Value) -> bool {
        self.answers.success(result)
    }

    /// Returns a callback that sends the answer once the request is carried out. `result` makes the answer from the
    /// name of the created object.
    pub(super) fn deferred_reply(
        &self,
        result: impl FnOnce(String) -> Value + Send + 'static,
    ) -> Reply {
        let answers = self.answers.clone();
        Box::new(move |done| {
            match done {
                Ok(name) => answers.success(result(name)),
                Err(why) => answers.failure(&why),
            };
        })
    }
}

/// Returns a "did you mean" hint if one of the `known` names is similar to `name`, else an empty text.
pub(super) fn suggestion<'k>(name: &str, known: impl Iterator<Item = &'k str>) -> String {
    let meant = rpi_diag::suggest(name, known);
    meant.map_or_else(String::new, |m| format!("; did you mean {m}?"))
}
