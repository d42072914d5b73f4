//! JSON-RPC 2.0 to the letter: batches, notifications, what is no request; and signs of life.

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

/// What is asked in a batch may take its time: the answer comes when all is done.
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
    ] {
        client.send(text);
        let answer = next(&mut client, text);
        assert_eq!(answer["error"]["code"], -32600, "{text}: {answer}");
    }
}

/// A client that is there but has nothing to say is asked, and stays; one that does not answer is given up.
#[test]
fn who_gives_no_sign_of_life_is_given_up() {
    let mut settings = settings();
    settings.limits.silence = Duration::from_millis(600);
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
