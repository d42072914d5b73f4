//! Test: nothing of the subscriptions of a client remains when it disconnects, for every method that subscribes.

use std::net::{Ipv4Addr, SocketAddr};
use std::time::{Duration, Instant};

use rpi_sim::Cell;
use serde_json::{Map, Value, json};

use super::connection::RpcConnection;
use super::methods::METHODS;
use crate::limits::Limits;
use crate::peer::Peer;
use crate::role::{Identity, Role};
use crate::server::Server;
use crate::settings::Settings;
use crate::state::SharedState;
use crate::transport::{ConnectionHandler, MemoryPool, Outbox, OutboxReceiver, outbox};

const PROGRAM: &str =
    "command Wait () let finish never when cancel; tel\ntask Once let Wait(); tel\n";

struct Caller {
    connection: RpcConnection,
    outbox: Outbox,
    answers: OutboxReceiver,
}

impl Caller {
    fn new(state: &SharedState) -> Caller {
        let limits = Limits::default();
        let memory = MemoryPool::new(limits.memory.outgoing);
        let memory = memory.connection(Peer::Local, limits.queued_bytes);
        let (outbox, answers) = outbox(&limits, memory);
        let who = Identity::unnamed(Peer::Local, Role::Programmer);
        let connection = RpcConnection::new(state.clone(), who, outbox.clone(), limits);
        Caller {
            connection,
            outbox,
            answers,
        }
    }

    /// Calls a method and waits for its result.
    fn call(&mut self, method: &str, params: &Value) -> Value {
        let request = json!({"jsonrpc": "2.0", "id": method, "method": method, "params": params});
        self.connection.on_message(&request.to_string());
        let begin = Instant::now();
        while begin.elapsed() < Duration::from_secs(30) {
            let Some(text) = self.answers.receive(Duration::from_millis(50)) else {
                continue;
            };
            let (text, _) = text.into_parts();
            let mut answer: Value = serde_json::from_str(&text).unwrap();
            if answer["id"] == method {
                assert!(answer["error"].is_null(), "{answer}");
                return answer["result"].take();
            }
        }
        panic!("{method} is not answered");
    }
}

/// Makes one object of each kind. Returns their names by kind.
fn objects(owner: &mut Caller) -> Map<String, Value> {
    let session = owner.call("session.open", &json!({}))["session"].take();
    let load = json!({"session": session, "text": PROGRAM});
    let command = owner.call("command.load", &load)["command"].take();
    let task = owner.call("task.load", &load)["task"].take();
    let when = format!("{}@error(3)", command.as_str().unwrap());
    let rule = json!({"when": when, "stop": [command]});
    let rule = owner.call("rule.make", &rule)["rule"].take();
    let named = json!({"session": session, "command": command, "task": task, "rule": rule});
    named.as_object().unwrap().clone()
}

#[test]
fn every_subscription_ends_with_its_client() {
    let settings = Settings {
        listen: SocketAddr::from((Ipv4Addr::LOCALHOST, 0)),
        ..Settings::default()
    };
    let server = Server::open(&Cell::parse("cell.toml", "").unwrap(), &settings, ()).unwrap();
    let state = server.shared().unwrap();
    let mut owner = Caller::new(&state);
    let named = objects(&mut owner);
    let most = Limits::default().subscriptions;
    let watching = METHODS.iter().filter(|m| m.name.starts_with("watch."));
    for method in watching {
        let mut watcher = Caller::new(&state);
        let params = named
            .iter()
            .filter(|(key, _)| method.params.contains(&key.as_str()));
        let params: Map<String, Value> = params.map(|(k, v)| (k.clone(), v.clone())).collect();
        watcher.call(method.name, &Value::Object(params));
        let Caller {
            connection, outbox, ..
        } = watcher;
        assert_eq!(outbox.subscriptions_left(), most - 1, "{}", method.name);
        drop(connection);
        assert_eq!(outbox.subscriptions_left(), most, "{} leaks", method.name);
    }
}
