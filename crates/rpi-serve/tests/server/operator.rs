//! Override and pause of all motions, set by a client.

use std::time::{Duration, Instant};

use rpi_serve::Server;
use serde_json::{Value, json};

use crate::client::{Client, PATIENCE, open};
use crate::native::call;
use crate::recording::{again, recorded};
use crate::rules::Owner;

const GO: &str = "use motion;
command Go (arm: Arm)
let
  way = PointToPoint(arm, (arm.commanded with [0] = arm.commanded[0] + 0.3[rad]));
  arm.joints = way.joints;
  progress = way.progress;
  export progress;
  finish there when way.done;
  fail   error when arm.error;
tel
";

/// Returns the progress of a command.
fn progress(owner: &mut Owner, command: &Value) -> f64 {
    let described = owner.ask("command.describe", &json!({"command": command}));
    let text = described["result"]["values"]["progress"].as_str();
    text.and_then(|text| text.parse().ok()).unwrap_or(0.0)
}

/// Waits until the progress of a command satisfies `wanted`.
fn wait_for(owner: &mut Owner, command: &Value, wanted: impl Fn(f64) -> bool) -> f64 {
    let begin = Instant::now();
    loop {
        let now = progress(owner, command);
        if wanted(now) {
            return now;
        }
        assert!(begin.elapsed() < PATIENCE, "the progress is {now}");
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// Waits until a command rests, and returns its progress there.
fn rest(owner: &mut Owner, command: &Value) -> f64 {
    let begin = Instant::now();
    loop {
        let before = progress(owner, command);
        std::thread::sleep(Duration::from_millis(50));
        if progress(owner, command) == before {
            return before;
        }
        assert!(begin.elapsed() < PATIENCE, "it still moves at {before}");
    }
}

fn pause_and_resume(server: &Server) {
    let mut owner = Owner::new(server);
    let go = owner.load(GO, "go", "rpi");
    assert_eq!(
        owner.ask("motion.set", &json!({"override": 0.2}))["result"],
        json!({})
    );
    owner.ask("command.start", &json!({"command": go}));
    wait_for(&mut owner, &go, |progress| progress > 0.05);
    owner.ask("motion.set", &json!({"paused": true}));
    let there = rest(&mut owner, &go);
    assert!(there > 0.05 && there < 0.9, "it paused at {there}");
    assert_eq!(
        owner.ask("motion.state", &json!({}))["result"],
        json!({"override": 0.2, "paused": true})
    );
    owner.ask("motion.set", &json!({"override": 1.0, "paused": false}));
    wait_for(&mut owner, &go, |progress| progress >= 1.0);
}

/// Motions pause on their paths and go on, and a replay of the recording gives the same bits.
#[test]
fn motions_pause_and_go_on() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.mcap");
    let server = recorded(&path);
    pause_and_resume(&server);
    server.close().unwrap().unwrap();
    let report = again(&path);
    assert!(report.agrees() && report.values > 100, "{report}");
}

/// An override of 0 holds the motions that begin.
#[test]
fn an_override_of_zero_holds_motions() {
    let server = open();
    let mut owner = Owner::new(&server);
    let go = owner.load(GO, "go", "rpi");
    owner.ask("motion.set", &json!({"override": 0}));
    owner.ask("command.start", &json!({"command": go}));
    std::thread::sleep(Duration::from_millis(100));
    assert_eq!(progress(&mut owner, &go), 0.0);
    owner.ask("motion.set", &json!({"override": 1}));
    wait_for(&mut owner, &go, |progress| progress >= 1.0);
}

/// What is not a share from 0 to 1 changes nothing and is reported.
#[test]
fn an_override_outside_of_its_range_is_rejected() {
    let server = open();
    let mut client = Client::rpc(server.address());
    for (params, found) in [
        (
            json!({"override": 1.5}),
            "override: expected a share from 0 to 1, found 1.5",
        ),
        (
            json!({"override": -0.1}),
            "override: expected a share from 0 to 1, found -0.1",
        ),
        (
            json!({"override": "fast"}),
            "override: expected a number, found a text",
        ),
        (
            json!({"paused": 1}),
            "paused: expected true or false, found a number",
        ),
    ] {
        let answer = call(&mut client, 2, "motion.set", &params);
        assert_eq!(answer["error"]["code"], -32602, "{answer}");
        assert_eq!(answer["error"]["message"], found);
    }
    let state = call(&mut client, 3, "motion.state", &json!({}));
    assert_eq!(state["result"], json!({"override": 1.0, "paused": false}));
}

/// Watchers learn of each change.
#[test]
fn changes_are_reported_to_watchers() {
    let server = open();
    let mut watcher = Client::rpc(server.address());
    call(&mut watcher, 1, "watch.motion", &json!({}));
    let mut operator = Client::rpc(server.address());
    call(&mut operator, 2, "motion.set", &json!({"override": 0.25}));
    watcher.wait("the override", |text| {
        let update: Value = serde_json::from_str(text).ok()?;
        (update["params"]["motion"]["override"] == 0.25).then_some(())
    });
}
