//! Conformance to JSON-RPC 2.0: batches, notifications, invalid requests; and the timeout of silent clients.

use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tungstenite::{Error, Message};

use crate::client::{Client, open, server, settings};
use crate::native::call;

fn next(client: &mut Client, what: &str) -> Value {
    client.wait(what, |text| serde_json::from_str(text).ok())
}

fn ping(id: u64) -> Value {
    json!({"jsonrpc": "2.0", "id": id, "method": "ping"})
}

#[test]
fn a_batch_has_one_answer() {
    let server = open();
    let mut client = Client::rpc(server.address());
    let open = json!({"jsonrpc": "2.0", "id": 2, "method": "session.open"});
    let notification = json!({"jsonrpc": "2.0", "method": "ping"});
    let unknown = json!({"jsonrpc": "2.0", "id": "x", "method": "dance"});
    let batch = json!([ping(1), open, notification, unknown, 7]);
    client.send(&batch.to_string());
    let answer = next(&mut client, "the batch");
    let answers = answer.as_array().unwrap();
    assert_eq!(answers.len(), 4, "{answer}");
    let of = |id: Value| answers.iter().find(|a| a["id"] == id).unwrap();
    assert_eq!(of(json!(1))["result"], json!({}));
    assert!(of(json!(2))["result"]["session"].is_string());
    assert_eq!(of(json!("x"))["error"]["code"], -32601);
    assert_eq!(of(Value::Null)["error"]["code"], -32600);
}

/// A batch is answered once all of its requests are answered, including slow ones.
#[test]
fn a_batch_waits_for_what_takes_longer() {
    let server = open();
    let mut client = Client::rpc(server.address());
    let session = call(&mut client, 1, "session.open", &json!({}))["result"]["session"].clone();
    let text = "command Wait () let finish over when time > 1[s]; tel";
    let params = json!({"session": session, "text": text});
    let load = json!({"jsonrpc": "2.0", "id": 2, "method": "command.load", "params": params});
    client.send(&json!([load, ping(3)]).to_string());
    let answer = next(&mut client, "the batch");
    assert_eq!(answer.as_array().map(Vec::len), Some(2), "{answer}");
    assert!(answer.to_string().contains("command"), "{answer}");
}

#[test]
fn notifications_have_no_answer_whatever_they_ask() {
    let server = open();
    let mut client = Client::rpc(server.address());
    for method in ["ping", "dance", "command.start"] {
        client.send(&json!({"jsonrpc": "2.0", "method": method}).to_string());
    }
    let quiet = json!([{"jsonrpc": "2.0", "method": "ping"}]);
    client.send(&quiet.to_string());
    client.send(&ping(9).to_string());
    assert_eq!(next(&mut client, "the first answer")["id"], 9);
}

#[test]
fn what_is_no_request_is_told_so() {
    let server = open();
    let mut client = Client::rpc(server.address());
    for text in [
        "[]",
        "7",
        "{}",
        r#"{"jsonrpc":"1.0","id":1,"method":"ping"}"#,
        r#"{"id":1,"method":"ping"}"#,
        r#"{"method":"ping"}"#,
    ] {
        client.send(text);
        let answer = next(&mut client, text);
        assert_eq!(answer["error"]["code"], -32600, "{text}: {answer}");
    }
}

/// A silent client that answers pings stays connected; one that does not is disconnected.
#[test]
fn who_gives_no_sign_of_life_is_given_up() {
    let mut settings = settings();
    settings.limits.idle_timeout = Duration::from_millis(600);
    let server = server(&settings, ());
    let mut alive = Client::rpc(server.address());
    let mut dead = Client::rpc(server.address());
    let begin = Instant::now();
    while begin.elapsed() < Duration::from_secs(2) {
        // Reading answers pings.
        let _ = alive.socket_mut().read();
    }
    assert_eq!(call(&mut alive, 1, "ping", &json!({}))["result"], json!({}));
    let over = loop {
        match dead.socket_mut().read() {
            Ok(Message::Ping(_) | Message::Text(_)) => {}
            Ok(Message::Close(_)) => break true,
            Err(Error::Io(why)) if why.kind() == std::io::ErrorKind::WouldBlock => break false,
            _ => break true,
        }
    };
    assert!(over, "it was silent for two seconds, and is still there");
}

/// An unknown, mistyped or positional parameter is an error with a suggestion; it would be ignored otherwise.
#[test]
fn parameters_that_no_method_has_are_refused() {
    let server = open();
    let mut client = Client::rpc(server.address());
    let cases = [
        (
            "session.open",
            json!({"on_los": "abort"}),
            "session.open has no parameter on_los; did you mean on_loss?",
        ),
        (
            "session.open",
            json!({"on_loss": "dance"}),
            "on_loss: expected one of run-on, cancel, abort",
        ),
        (
            "session.open",
            json!({"name": 5}),
            "name: expected a text, found a number",
        ),
        (
            "session.open",
            json!(["test"]),
            "params: expected an object with the parameters by name",
        ),
        (
            "command.start",
            json!({}),
            "the parameter command is missing: a text",
        ),
        (
            "watch.command",
            json!({"command": "n1", "period": -1}),
            "period: expected 0 to 3600 seconds, found -1.0",
        ),
    ];
    for (id, (method, params, why)) in (1..).zip(cases) {
        let error = call(&mut client, id, method, &params)["error"].clone();
        assert_eq!(error["code"], -32602, "{error}");
        assert_eq!(error["message"], why);
    }
    let near = call(&mut client, 90, "command.strat", &json!({}));
    let message = near["error"]["message"].as_str().unwrap();
    assert!(message.ends_with("did you mean command.start?"), "{near}");
}

/// JSON-RPC 2.0, section 4: an id is a text, a number or null, and is returned unchanged.
#[test]
fn ids_that_could_not_come_back_are_refused() {
    let server = open();
    let mut client = Client::rpc(server.address());
    for id in ["[1]", "{}", "true", "1.5", "123456789012345678901234567890"] {
        client.send(&format!(
            "{{\"jsonrpc\":\"2.0\",\"id\":{id},\"method\":\"ping\"}}"
        ));
        client.wait_for_next(id, |text| {
            let answer: Value = serde_json::from_str(text).ok()?;
            (answer["id"].is_null() && answer["error"]["code"] == -32600).then_some(())
        });
    }
}

/// An emergency stop is carried out even if its request is malformed.
#[test]
fn an_emergency_stop_is_never_refused() {
    for request in [
        json!({"id": [1], "method": "emergency.stop"}),
        json!({"id": 1, "method": "emergency.stop", "params": ["me"]}),
        json!({"id": 1, "method": "emergency.stop", "params": {"bye": "me"}}),
        json!({"method": "emergency.stop", "params": {"by": 5}}),
    ] {
        let server = open();
        let mut client = Client::rpc(server.address());
        client.send(&request.to_string());
        let state = call(&mut client, 2, "emergency.state", &json!({}));
        assert_eq!(state["result"]["stopped"], true, "{request}");
    }
}

/// A request that the state of a command does not allow is refused with the state and a hint.
#[test]
fn what_does_not_fit_a_state_is_told_with_it() {
    let server = open();
    let mut owner = crate::rules::Owner::new(&server);
    let count = owner.load(crate::rules::COUNT, "count", "rpi");
    let command = json!({"command": count});
    let mut why = |method: &str| {
        let answer = owner.ask(method, &command);
        answer["error"]["message"]
            .as_str()
            .unwrap_or_default()
            .to_owned()
    };
    assert!(why("command.cancel").ends_with("it is ready, but not running"));
    assert_eq!(why("command.start"), "");
    assert!(why("command.start").ends_with("it is already running"));
    assert_eq!(why("command.abort"), "");
    assert!(why("command.start").ends_with("to run it again"));
}

/// Numbers of a JSON-RPC client are kept to the last bit.
#[test]
fn numbers_keep_every_bit() {
    let server = open();
    let mut owner = crate::rules::Owner::new(&server);
    let echo = owner.load(crate::nets::ECHO, "echo", "rpinet");
    let gain = 125.205_557_217_261_67;
    let set = json!({"command": echo, "values": {"gain": gain}});
    assert_eq!(owner.ask("command.set", &set)["result"], json!({}));
    let command = json!({"command": echo});
    owner.ask("command.start", &command);
    let begin = Instant::now();
    let twice = loop {
        let values = owner.ask("command.describe", &command)["result"]["values"].clone();
        match values["twice"].as_str() {
            Some(twice) => break twice.parse::<f64>().unwrap(),
            None => assert!(begin.elapsed() < Duration::from_secs(30), "{values}"),
        }
    };
    assert_eq!(twice, 2.0 * gain);
}
