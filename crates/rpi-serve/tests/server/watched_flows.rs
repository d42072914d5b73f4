//! Flows that a program does not export and that a client watches: their values, and what watching leaves as it is.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

use rpi_core::{Command, CommandId, CycleObserver};
use rpi_image::image::{Signal, TRUE};
use rpi_image::{Scalar, Type};
use serde_json::{Value, json};

use crate::client::{open, server, settings};
use crate::rules::Owner;

const PROGRAM: &str = "
use motion;

node Mean (x: real) returns (y: real) let y = 0.5 * (x + (x -> pre x)); tel

command Turn (arm: Arm)
var n: int;
let
  n = 0 -> pre n + 1;
  level = Mean(2.0 * real n) + 1.0;
  fragment Late when n >= 3
  let
    from_three = n - 3;
  tel
  arm.joints = [1e-4[rad] * real n, 1e-5[rad] * level, 0[rad], 0[rad], 0[rad], 0[rad], 0[rad]];
  export n;
  finish over when n = 60;
tel

task All (arm: Arm) let Turn(arm); tel
";

/// Bits of all set-points of the commands, in the order of the cycles.
#[derive(Clone, Default)]
struct SetPoints(Arc<Mutex<Vec<u64>>>);

impl CycleObserver for SetPoints {
    fn cycle_finished(&mut self, _: CommandId, command: &Command) {
        let machine = command.instance();
        let inputs = machine.image().actuators.iter().flat_map(|a| &a.inputs);
        let slots = inputs.flat_map(|slots| slots.start..slots.end());
        let value = |start| {
            let ty = Type::Scalar(Scalar::Real);
            let present = TRUE;
            machine.value(Signal { start, present, ty }).map(|v| v[0])
        };
        self.0.lock().unwrap().extend(slots.filter_map(value));
    }
}

/// Loads the command with watched flows.
fn load(owner: &mut Owner, watch: &Value) -> Value {
    let params =
        json!({"session": owner.session, "text": PROGRAM, "command": "Turn", "watch": watch});
    owner.ask("command.load", &params)
}

/// Runs the command to its end. Returns the last value of each flow, and the set-points.
fn run(watch: &Value) -> (BTreeMap<String, String>, Vec<u64>) {
    let set_points = SetPoints::default();
    let server = server(&settings(), set_points.clone());
    let mut owner = Owner::new(&server);
    let loaded = load(&mut owner, watch);
    let command = loaded["result"]["command"].clone();
    assert!(command.is_string(), "{loaded}");
    owner.ask("watch.command", &json!({"command": command}));
    owner.ask("command.start", &json!({"command": command}));
    owner.client.wait("the end", |text| {
        let update: Value = serde_json::from_str(text).ok()?;
        (update["params"]["ending"]["result"] == "over").then_some(())
    });
    let described = owner.ask("command.describe", &json!({"command": command}));
    let values = serde_json::from_value(described["result"]["values"].clone()).unwrap();
    let all = set_points.0.lock().unwrap().clone();
    (values, all)
}

#[test]
fn watched_flows_have_values_and_no_set_point_changes() {
    let (plain, set_points) = run(&json!([]));
    assert_eq!(plain.keys().collect::<Vec<_>>(), ["n"]);
    let (watched, same) = run(&json!(["Turn"]));
    assert!(set_points.len() >= 60 * 7, "{}", set_points.len());
    assert_eq!(set_points, same);
    assert_eq!(watched["n"], plain["n"]);
    assert_eq!(watched["Late.from_three"], "57");
    let number = |name: &str| watched[name].parse::<f64>().unwrap();
    let mean = watched.keys().find(|key| key.ends_with(".y")).unwrap();
    assert_eq!(number("level"), number(mean) + 1.0);
}

#[test]
fn a_name_selects_what_is_inside_and_its_type_is_described() {
    let server = open();
    let mut owner = Owner::new(&server);
    let command = load(&mut owner, &json!(["Turn.Late"]))["result"]["command"].clone();
    let described = owner.ask("command.describe", &json!({"command": command}));
    let mut keys = BTreeMap::new();
    for export in described["result"]["exports"].as_array().unwrap() {
        keys.insert(
            export["key"].as_str().unwrap(),
            export["type"].as_str().unwrap(),
        );
    }
    let expected = [("Late.from_three", "int"), ("n", "int")];
    assert_eq!(keys, expected.into());
}

#[test]
fn names_are_looked_for_in_the_commands_of_a_task() {
    let server = open();
    let mut owner = Owner::new(&server);
    let mut params = json!({"session": owner.session, "text": PROGRAM, "watch": ["Turn.level"]});
    let task = owner.ask("task.load", &params)["result"]["task"].clone();
    assert!(task.is_string());
    params["watch"] = json!(["Turn.lever"]);
    let refused = owner.ask("task.load", &params);
    let why = refused["error"].to_string();
    assert!(why.contains("did you mean `Turn.level`"), "{refused}");
}

#[test]
fn wrong_names_are_errors() {
    let server = open();
    let mut owner = Owner::new(&server);
    let many: Vec<String> = (0..257).map(|k| format!("Turn.f{k}")).collect();
    for (watch, reason) in [
        (json!(["Turn.lever"]), "did you mean `Turn.level`"),
        (json!(["Trun"]), "no flow is called `Trun`"),
        (json!(many), "at most 256 names, found 257"),
        (json!("Turn"), "a list of texts"),
    ] {
        let refused = load(&mut owner, &watch);
        assert!(refused["error"].to_string().contains(reason), "{refused}");
    }
}
