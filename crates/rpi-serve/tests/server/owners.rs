//! Ownership: no client can end or change what belongs to another one, by any interface.

use serde_json::{Value, json};

use crate::client::{open, post};
use crate::rules::{COUNT, Owner};

/// A rule belongs to the owner of the commands that it acts on.
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
    let answer = owner.ask("command.describe", &json!({"command": count}));
    assert_eq!(answer["result"]["state"], "ready", "{answer}");
    let shared = owner.ask("session.open", &json!({"shared": true}));
    let page = format!(
        "/sessions/{}",
        shared["result"]["session"].as_str().unwrap()
    );
    assert!(post(server.address(), &page, "action=TERMINATE").starts_with("HTTP/1.1 200"));
}

/// A parameter of the wrong type is an error, and not treated as missing.
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

/// Misspelt parameters and device names with special characters are rejected.
#[test]
fn devices_have_names_and_known_parameters() {
    let server = open();
    let mut owner = Owner::new(&server);
    let add = |name: &str, parameters: Value| json!({"name": name, "type": "kuka_lwr_sim", "parameters": parameters});
    let cases = [
        add("", Value::Null),
        add(" ", Value::Null),
        add("x\ny", Value::Null),
        add("<x>", Value::Null),
        add("two", json!({"max_velocity": [1]})),
        add("two", json!({"max_vel": {"a": 1}})),
    ];
    for params in cases {
        let refused = owner.ask("device.add", &params);
        assert_eq!(refused["error"]["code"], -32602, "{params}: {refused}");
    }
    let wrong_values = [
        (
            json!({"max_vel": [1, 1]}),
            "max_vel has 2 values, expected 7, one for each axis, in rad/s",
        ),
        (
            json!({"min_joint": []}),
            "min_joint has 0 values, expected 7",
        ),
        (
            json!({"max_vel": [1, 1, 0, 1, 1, 1, 1]}),
            "max_vel[2] is 0, expected a number greater than 0, in rad/s",
        ),
        (
            json!({"max_acc": [1, -3, 1, 1, 1, 1, 1]}),
            "max_acc[1] is -3, expected a number greater than 0, in rad/s^2",
        ),
        (
            json!({"max_acc": [1, null, 1, 1, 1, 1, 1]}),
            "max_acc: value 1 is null",
        ),
        (
            json!({"max_joint": [1, 1, 1, 1, 1, 1, -9]}),
            "max_joint[6]: the range from",
        ),
        (json!({"link_lengths": "long"}), "link_lengths: "),
    ];
    for (parameters, expected) in wrong_values {
        let refused = owner.ask("device.add", &add("two", parameters.clone()));
        let message = refused["error"]["message"].as_str().unwrap_or_default();
        assert!(message.contains(expected), "{parameters}: {refused}");
    }
    let good = add("arm two", json!({"max_vel": [1, 1, 1, 1, 1, 1, 1]}));
    let made = owner.ask("device.add", &good);
    assert_eq!(made["result"]["device"], "arm two", "{made}");
}

/// The log names the commands that are unloaded with their device.
#[test]
fn commands_that_go_with_their_device_are_named() {
    let server = open();
    let mut owner = Owner::new(&server);
    let two = json!({"name": "two", "type": "kuka_lwr_sim"});
    owner.ask("device.add", &two);
    let net = crate::nets::hold(0).replace("'arm'", "'two'");
    let hold = owner.load(&net, "hold", "rpinet");
    owner.ask("watch.command", &json!({"command": hold}));
    owner.ask("command.start", &json!({"command": hold}));
    owner.ask("command.abort", &json!({"command": hold}));
    owner.client.wait("its end", |text| {
        text.contains("\"terminated\"").then_some(())
    });
    let removed = owner.ask("device.remove", &json!({"name": "two"}));
    assert_eq!(removed["result"], json!({}), "{removed}");
    let log = crate::client::get(server.address(), "/log");
    let name = hold.as_str().unwrap();
    let reason = format!("{name} (hold) is unloaded because device two is removed");
    assert!(log.contains(&reason), "{log}");
}

/// An unknown name of a command or task is reported as unknown, not as ambiguous.
#[test]
fn names_that_are_not_in_the_text_are_told() {
    let server = open();
    let mut owner = Owner::new(&server);
    let text = format!("{COUNT}task T let Count(); tel task P let Count(); tel");
    let known = "expected one of: Count; did you mean Count?";
    let cases = [
        ("command", "Cuont", known),
        ("task", "Quux", "expected one of: T, P"),
    ];
    for (kind, name, known) in cases {
        let mut load = json!({"session": owner.session, "text": text});
        load[kind] = json!(name);
        let refused = owner.ask(&format!("{kind}.load"), &load);
        let why = format!("unknown {kind} {name} in the text, {known}");
        assert_eq!(refused["error"]["message"], why, "{refused}");
    }
}
