//! What belongs to one client cannot be ended or changed by another, whichever way that one comes in.

use serde_json::{Value, json};

use crate::client::{open, post};
use crate::rules::{COUNT, Owner};

/// A rule that stops a command is that command's owner's, as the command is.
#[test]
fn rules_are_withdrawn_by_whom_their_commands_belong_to() {
    let server = open();
    let (mut owner, mut other) = (Owner::new(&server), Owner::new(&server));
    let [first, next] = ["first", "next"].map(|title| owner.load(COUNT, title, "rpi"));
    let when = format!("{}.even", first.as_str().unwrap());
    let rules = [
        json!({"when": when, "stop": [first]}),
        json!({"when": when, "cancel": [first]}),
        json!({"when": when, "start": [next]}),
    ];
    for rule in rules {
        let rule = owner.ask("rule.make", &rule)["result"]["rule"].clone();
        let withdraw = json!({ "rule": rule });
        let refused = other.ask("rule.withdraw", &withdraw);
        assert_eq!(refused["error"]["code"], -32007, "{refused}");
        assert_eq!(owner.ask("rule.withdraw", &withdraw)["result"], json!({}));
    }
    let unknown = owner.ask("rule.withdraw", &json!({"rule": "r999"}));
    assert_eq!(unknown["error"]["code"], -32001, "{unknown}");
}

#[test]
fn a_page_ends_no_session_of_somebody_who_is_there() {
    let server = open();
    let mut owner = Owner::new(&server);
    let count = owner.load(COUNT, "count", "rpi");
    let page = format!("/sessions/{}", owner.session.as_str().unwrap());
    let end = || post(server.address(), &page, "action=TERMINATE");
    assert!(end().starts_with("HTTP/1.1 403"), "{}", end());
    let told = owner.ask("command.describe", &json!({"command": count}));
    assert_eq!(told["result"]["state"], "ready", "{told}");
    let shared = owner.ask("session.open", &json!({"shared": true}));
    let page = format!(
        "/sessions/{}",
        shared["result"]["session"].as_str().unwrap()
    );
    assert!(post(server.address(), &page, "action=TERMINATE").starts_with("HTTP/1.1 200"));
}

/// What is of the wrong kind is told, and not taken for what was left out.
#[test]
fn parameters_of_the_wrong_kind_are_told() {
    let server = open();
    let mut owner = Owner::new(&server);
    let session = owner.session.clone();
    let load = |key: &str, value: Value| {
        let mut load = json!({"session": session, "text": COUNT});
        load[key] = value;
        load
    };
    let wrong = [
        load("period", json!("0.01")),
        load("period", json!(-1)),
        load("title", json!(5)),
        load("command", json!(5)),
        load("language", json!(["rpi"])),
    ];
    for params in wrong {
        let refused = owner.ask("command.load", &params);
        assert_eq!(refused["error"]["code"], -32602, "{params}: {refused}");
    }
    let absent = owner.ask("command.load", &load("command", Value::Null));
    assert!(absent["result"]["command"].is_string(), "{absent}");
}
