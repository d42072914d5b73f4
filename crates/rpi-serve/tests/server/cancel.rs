//! Commands that ignore a cancel request end all the same.

use std::time::Instant;

use serde_json::{Value, json};

use crate::client::{PATIENCE, get, open};
use crate::rules::Owner;

/// A command that does not end when its motion has stopped after a cancel request.
const DEAF: &str = "use motion;
command Deaf (arm: Arm)
let
  way = PointToPoint(arm, (arm.commanded with [0] = arm.commanded[0] + 0.3[rad]));
  arm.joints = way.joints;
  finish there when way.done;
tel
";

/// Waits until a command has ended, and returns its ending.
fn ending(owner: &mut Owner, command: &Value) -> Value {
    let begin = Instant::now();
    loop {
        let described = owner.ask("command.describe", &json!({"command": command}));
        let ending = &described["result"]["ending"];
        if ending.is_object() {
            return ending.clone();
        }
        assert!(begin.elapsed() < PATIENCE, "{described}");
    }
}

/// After the grace time of its request or its session, a command is aborted, and the arm is free.
#[test]
fn what_ignores_a_cancel_request_is_aborted() {
    let server = open();
    let mut owner = Owner::new(&server);
    for (of_session, of_request) in [(json!(0.05), Value::Null), (json!(1000), json!(0.05))] {
        let opened = owner.ask("session.open", &json!({"grace": of_session}));
        owner.session = opened["result"]["session"].clone();
        let deaf = owner.load(DEAF, "deaf", "rpi");
        let started = owner.ask("command.start", &json!({"command": deaf}));
        assert_eq!(started["result"], json!({}), "{started}");
        owner.ask(
            "command.cancel",
            &json!({"command": deaf, "grace": of_request}),
        );
        let ending = ending(&mut owner, &deaf);
        assert_eq!(ending["cause"], "aborted", "{ending}");
        let why = "it had not ended within the grace time after a cancel request";
        assert_eq!(ending["why"], why);
    }
    let log = get(server.address(), "/log");
    assert!(log.contains("was aborted"), "{log}");
}

/// A time that is none is an error.
#[test]
fn a_grace_time_is_a_duration() {
    let server = open();
    let mut owner = Owner::new(&server);
    let answer = owner.ask("session.open", &json!({"grace": -1}));
    assert_eq!(answer["error"]["code"], -32602, "{answer}");
}
