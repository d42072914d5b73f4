//! Outputs after an emergency stop: they take their safe values, whichever command has set them.

use std::time::{Duration, Instant};

use rpi_serve::Server;
use rpi_sim::Cell;
use serde_json::{Value, json};

use crate::client::{PATIENCE, settings};
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
