//! JSON-RPC connection of one client.

use serde_json::{Value, json};

use super::answers::Answers;
use super::methods::{METHODS, Method};
use crate::peer::Peer;
use crate::state::{Client, Failure, Office, Reply};
use crate::wire::{Front, Outbox};

/// JSON-RPC connection of one client.
pub(crate) struct RpcFront {
    pub(super) office: Office,
    pub(super) client: Client,
    pub(super) out: Outbox,
    /// Names of the sessions that the client has opened or taken over.
    pub(super) sessions: Vec<String>,
}

/// Parameters and answer destination of a request.
pub(super) struct Call<'a> {
    pub(super) params: &'a Value,
    answers: Answers,
}

/// Result of a method. `None` if the answer follows later or was sent already.
pub(super) type Answer = Result<Option<Value>, Failure>;

impl Front for RpcFront {
    fn hear(&mut self, text: &str) -> bool {
        let nobody = json!({"id": null});
        let request: Value = match serde_json::from_str(text) {
            Ok(request) => request,
            Err(why) => {
                let answers = Answers::alone(&nobody, &self.out);
                return answers.error(-32700, &why.to_string(), Value::Null);
            }
        };
        match request {
            Value::Array(batch) if batch.is_empty() => {
                Answers::alone(&nobody, &self.out).no_request()
            }
            Value::Array(batch) => {
                let answers = Answers::together(&batch, &self.out);
                let mut all = batch.iter().zip(answers);
                all.all(|(request, answers)| self.one(request, answers))
            }
            request => {
                let answers = Answers::alone(&request, &self.out);
                self.one(&request, answers)
            }
        }
    }

    fn complain(&mut self, why: &str) {
        Answers::alone(&json!({"id": null}), &self.out).error(-32600, why, Value::Null);
    }
}

impl Drop for RpcFront {
    fn drop(&mut self) {
        self.out.end();
        self.office.desk().lose_client(self.client, &self.sessions);
    }
}

impl RpcFront {
    /// Creates the connection of a new client.
    pub(crate) fn new(office: Office, peer: Peer, out: Outbox) -> RpcFront {
        let client = office.desk().objects.client(peer);
        RpcFront {
            office,
            client,
            out,
            sessions: Vec::new(),
        }
    }

    fn one(&mut self, request: &Value, answers: Answers) -> bool {
        let is_ours = request
            .get("jsonrpc")
            .is_some_and(|version| version == "2.0");
        let name = request.get("method").and_then(Value::as_str);
        let Some(name) = name else {
            return answers.no_request();
        };
        let Some(method) = METHODS.iter().find(|known| known.name == name) else {
            let known = METHODS.iter().map(|known| known.name);
            let why = format!("there is no method {name}{}", meant(name, known));
            return answers.error(-32601, &why, Value::Null);
        };
        if method.is_checked && !is_ours {
            let why = "invalid request: `\"jsonrpc\": \"2.0\"` is missing";
            return answers.for_somebody().error(-32600, why, Value::Null);
        }
        if method.is_checked && !answers.has_good_id() {
            let why = "the id must be a text, a whole number or null";
            return answers.for_nobody().error(-32600, why, Value::Null);
        }
        let call = Call {
            params: request.get("params").unwrap_or(&Value::Null),
            answers,
        };
        let done = call.takes(method).and_then(|()| (method.act)(self, &call));
        match done {
            Ok(None) => true,
            Ok(Some(result)) => call.answer(result),
            Err(why) => call.answers.failure(&why),
        }
    }

    /// Returns an error if one of these commands, tasks or sessions belongs to another client.
    pub(super) fn may_act(&self, names: &[&str]) -> Result<(), Failure> {
        let state = self.office.desk();
        names
            .iter()
            .try_for_each(|name| state.objects.may_act(self.client, name))
    }
}

impl Call<'_> {
    /// Returns an error if a parameter is unknown. A misspelt optional parameter would otherwise be ignored.
    fn takes(&self, method: &Method) -> Result<(), Failure> {
        let known = method.params;
        let given = match self.params {
            _ if !method.is_checked => return Ok(()),
            Value::Null => return Ok(()),
            Value::Object(given) => given,
            _ => {
                let why = "params: expected an object with the parameters by name";
                return Err(Failure::Bad(why.to_owned()));
            }
        };
        let name = method.name;
        let unknown = given.keys().find(|key| !known.contains(&key.as_str()));
        unknown.map_or(Ok(()), |key| {
            let meant = meant(key, known.iter().copied());
            Err(Failure::Bad(format!(
                "{name} has no parameter {key}{meant}"
            )))
        })
    }

    /// Sends the result of the request. Returns false if the client is disconnected.
    pub(super) fn answer(&self, result: Value) -> bool {
        self.answers.success(result)
    }

    /// Returns a callback that sends the answer. `result` makes it from the name of the created object.
    pub(super) fn later(&self, result: impl FnOnce(String) -> Value + Send + 'static) -> Reply {
        let answers = self.answers.clone();
        Box::new(move |done| {
            match done {
                Ok(name) => answers.success(result(name)),
                Err(why) => answers.failure(&why),
            };
        })
    }
}

/// Returns a "did you mean" hint if one of the known names is similar, else an empty text.
pub(super) fn meant<'k>(name: &str, known: impl Iterator<Item = &'k str>) -> String {
    let meant = rpi_diag::suggest(name, known);
    meant.map_or_else(String::new, |m| format!("; did you mean {m}?"))
}
