//! Outputs after an emergency stop, and after a task that does not come to its end: they take their safe values, whichever command
//! has set them.

use std::time::{Duration, Instant};

use rpi_serve::Server;
use rpi_sim::Cell;
use serde_json::{Value, json};

use crate::client::{PATIENCE, settings};
use crate::recording::{again, recorded_cell};
use crate::rules::Owner;

const CELL: &str = "[devices.io]\nkind = \"digital-io\"\ninputs = 0\noutputs = 2\n\
                    safe = [{ output = 1, value = false }]\n";

const ON: &str = "use io;\ncommand On (io: DigitalIo<<0, 2>>)\nlet\n  io.set = [true, true];\n  finish done when time > 5[ms];\ntel\n";

/// Shows the outputs and drives none.
const OUTPUTS: &str = "command Outputs ()\nlet\n  \
                       kept = IO::OutBoolSensor<<DeviceID: \"io\", Port: 0>>();\n  \
                       safe = IO::OutBoolSensor<<DeviceID: \"io\", Port: 1>>();\n  \
                       export kept, safe;\n  finish done when cancel;\ntel\n";

/// Starts a command of this text and returns its description as soon as it satisfies a condition.
fn started(owner: &mut Owner, text: &str, is_reached: impl Fn(&Value) -> bool) -> Value {
    let command = owner.load(text, "of the test", "rpi");
    let answer = owner.ask("command.start", &json!({ "command": command }));
    assert_eq!(answer["result"], json!({}), "{answer}");
    let begin = Instant::now();
    loop {
        let described =
            owner.ask("command.describe", &json!({ "command": command }))["result"].clone();
        if is_reached(&described) {
            return described;
        }
        assert!(begin.elapsed() < PATIENCE, "{described}");
        std::thread::sleep(Duration::from_millis(2));
    }
}

fn outputs(owner: &mut Owner) -> [Value; 2] {
    let described = started(owner, OUTPUTS, |described| {
        described["values"]["safe"].is_string()
    });
    ["kept", "safe"].map(|key| described["values"][key].clone())
}

#[test]
fn an_emergency_stop_sets_outputs_of_commands_that_have_ended() {
    let cell = Cell::parse("cell.toml", CELL).unwrap();
    let server = Server::open(&cell, &settings(), ()).unwrap();
    let mut owner = Owner::new(&server);
    started(&mut owner, ON, |described| !described["ending"].is_null());
    assert_eq!(outputs(&mut owner), ["true", "true"]);
    owner.ask("emergency.stop", &json!({ "by": "the test" }));
    let reset = owner.ask("emergency.reset", &json!({}));
    assert_eq!(reset["result"], json!({}), "{reset}");
    assert_eq!(outputs(&mut owner), ["true", "false"]);
}

/// A task that switches the outputs on in its first step, and ends or waits in its second one.
fn task(owner: &mut Owner, second: &str) -> Value {
    let text = format!(
        "{ON}command Idle (t: real[s]) let finish waited when time >= t; fail stopped when cancel; tel\n\
         command Bad () let n = 0 -> pre n + 1; finish never when n > 100000; fail bad when time >= 10[ms]; tel\n\
         task Main (io: DigitalIo<<0, 2>>) let On(io); {second}; tel\n"
    );
    let load = json!({ "session": owner.session, "text": text });
    let loaded = owner.ask("task.load", &load);
    let task = loaded["result"]["task"].clone();
    assert!(task.is_string(), "{loaded}");
    owner.ask("task.start", &json!({ "task": task }));
    task
}

/// Waits until the outputs have these values.
fn wait_for_outputs(owner: &mut Owner, expected: [&str; 2]) {
    let begin = Instant::now();
    loop {
        let seen = outputs(owner);
        if seen == expected {
            return;
        }
        assert!(begin.elapsed() < PATIENCE, "{seen:?}, not {expected:?}");
    }
}

fn wait_for_state(owner: &mut Owner, task: &Value, state: &str) {
    let begin = Instant::now();
    loop {
        let described = owner.ask("task.describe", &json!({ "task": task }));
        if described["result"]["state"] == state {
            return;
        }
        assert!(begin.elapsed() < PATIENCE, "{described}");
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// A torch that an ended step has switched on must not burn on if the task is cancelled in a later step, or fails there.
#[test]
fn a_task_that_does_not_come_to_its_end_leaves_no_output_of_its_ended_steps_on() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.mcap");
    let server = recorded_cell(&path, CELL);
    let mut owner = Owner::new(&server);
    let cancelled = task(&mut owner, "Idle(100[s])");
    wait_for_outputs(&mut owner, ["true", "true"]);
    owner.ask("task.cancel", &json!({ "task": cancelled }));
    wait_for_state(&mut owner, &cancelled, "cancelled");
    wait_for_outputs(&mut owner, ["true", "false"]);
    let failed = task(&mut owner, "Bad()");
    wait_for_state(&mut owner, &failed, "failed");
    wait_for_outputs(&mut owner, ["true", "false"]);
    // A task that comes to its end leaves them as it has set them.
    let done = task(&mut owner, "Idle(1[ms])");
    wait_for_state(&mut owner, &done, "done");
    assert_eq!(outputs(&mut owner), ["true", "true"]);
    drop(owner);
    server.close().unwrap().unwrap();
    let report = again(&path);
    assert!(report.agrees() && report.values > 10, "{report}");
}

/// The client is lost while its task runs; another one sees the outputs.
#[test]
fn a_task_of_a_lost_client_leaves_no_output_of_its_ended_steps_on() {
    let cell = Cell::parse("cell.toml", CELL).unwrap();
    let server = Server::open(&cell, &settings(), ()).unwrap();
    let mut watcher = Owner::new(&server);
    let mut owner = Owner::new(&server);
    task(&mut owner, "Idle(100[s])");
    wait_for_outputs(&mut watcher, ["true", "true"]);
    drop(owner);
    wait_for_outputs(&mut watcher, ["true", "false"]);
}
