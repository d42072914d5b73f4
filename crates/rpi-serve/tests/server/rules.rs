//! Refused requests, and commands that can no longer be started.

use serde_json::{Value, json};

use crate::client::{Client, open};
use crate::native::call;
use crate::nets::ECHO;

pub(crate) const SWING: &str = "use motion;
command Swing (arm: Arm)
let
  arm.joints = [0.1[rad/s] * time, 0[rad], 0[rad], 0[rad], 0[rad], 0[rad], 0[rad]];
  finish never when false;
  finish over when cancel;
tel
";

pub(crate) const COUNT: &str = "command Count ()
let
  n = 1 -> pre n + 1;
  export n;
  even = n mod 2 = 0;
  export even;
  finish done when n >= 2000;
tel
";

pub(crate) struct Owner {
    pub(crate) client: Client,
    pub(crate) session: Value,
    id: u64,
}

impl Owner {
    pub(crate) fn new(server: &rpi_serve::Server) -> Owner {
        let mut client = Client::rpc(server.address());
        let opened = call(&mut client, 1, "session.open", &json!({}));
        let session = opened["result"]["session"].clone();
        let id = 1;
        Owner {
            client,
            session,
            id,
        }
    }

    pub(crate) fn ask(&mut self, method: &str, params: &Value) -> Value {
        self.id += 1;
        call(&mut self.client, self.id, method, params)
    }

    pub(crate) fn load(&mut self, text: &str, title: &str, language: &str) -> Value {
        let session = self.session.clone();
        let load = json!({"session": session, "text": text, "title": title, "language": language});
        let loaded = self.ask("command.load", &load);
        assert!(loaded["result"]["command"].is_string(), "{loaded}");
        loaded["result"]["command"].clone()
    }
}

#[test]
fn rules_ask_for_booleans_only() {
    let server = open();
    let mut owner = Owner::new(&server);
    let count = owner.load(COUNT, "count", "rpi");
    let count = count.as_str().unwrap();
    for (key, code) in [("n", json!(-32602)), ("even", Value::Null)] {
        let other = owner.load(COUNT, "other", "rpi");
        let rule = json!({"when": format!("{count}.{key}"), "start": [other]});
        let made = owner.ask("rule.make", &rule);
        assert_eq!(made["error"]["code"], code, "{made}");
    }
}

/// An input that is taken over is read in the first cycle. Before that it must be set, as the first command has no
/// predecessor.
#[test]
fn what_is_taken_over_cannot_be_set_while_it_runs() {
    let server = open();
    let mut owner = Owner::new(&server);
    let text = "command Cut () given (length: real[m])\nlet\n  far = length;\n  export far;\n  finish cut when far > 5[m];\ntel\n";
    let cut = owner.load(text, "cut", "rpi");
    let set = |length: f64| json!({"command": cut, "values": {"length": length}});
    let refused = owner.ask("command.start", &json!({"command": cut}));
    assert_eq!(refused["error"]["code"], -32602, "{refused}");
    assert!(
        refused.to_string().contains("takes over length"),
        "{refused}"
    );
    assert!(refused.to_string().contains("command.set"), "{refused}");
    assert_eq!(owner.ask("command.set", &set(1.0))["result"], json!({}));
    let started = owner.ask("command.start", &json!({"command": cut}));
    assert_eq!(started["result"], json!({}), "{started}");
    let refused = owner.ask("command.set", &set(7.0));
    assert_eq!(refused["error"]["code"], -32602, "{refused}");
    assert!(refused.to_string().contains("taken over"), "{refused}");
    // Inputs of nets can be set at any time.
    let echo = owner.load(ECHO, "echo", "rpinet");
    owner.ask("command.start", &json!({"command": echo}));
    let set = json!({"command": echo, "values": {"gain": 2.0}});
    assert_eq!(owner.ask("command.set", &set)["result"], json!({}));
}

#[test]
fn who_holds_what_is_told_by_name() {
    let server = open();
    let mut owner = Owner::new(&server);
    let [one, other] = ["first", "second"].map(|title| owner.load(SWING, title, "rpi"));
    owner.ask("command.start", &json!({"command": one}));
    let refused = owner.ask("command.start", &json!({"command": other}));
    assert_eq!(refused["error"]["code"], -32003, "{refused}");
    let why = refused["error"]["message"].as_str().unwrap();
    let held = format!("is held by first {}", one.as_str().unwrap());
    assert!(why.starts_with("arm[") && why.ends_with(&held), "{why}");
}

/// With `keep`, a command that can no longer be started becomes ready again.
#[test]
fn who_is_to_be_kept_is_ready_again() {
    let server = open();
    let mut owner = Owner::new(&server);
    let first = owner.load(COUNT, "first", "rpi");
    for (keep, state) in [(true, "ready"), (false, "unloaded")] {
        let next = owner.load(COUNT, "next", "rpi");
        owner.ask("watch.command", &json!({"command": next}));
        let after = json!({"command": next, "after": first, "keep": keep});
        let rule = owner.ask("command.schedule", &after)["result"]["rule"].clone();
        owner.ask("rule.withdraw", &json!({"rule": rule}));
        owner.client.wait_for_next(state, |text| {
            let update: Value = serde_json::from_str(text).ok()?;
            let params = &update["params"];
            (params["command"] == next && params["state"] == state).then_some(())
        });
    }
}

/// Parallel branches start together or not at all; the error names all commands that were to start.
#[test]
fn strands_that_cannot_start_together_are_all_named() {
    let server = open();
    let mut owner = Owner::new(&server);
    let holder = owner.load(SWING, "holder", "rpi");
    owner.ask("command.start", &json!({"command": holder}));
    let strands =
        "task Both (arm: Arm)\nlet\n  parallel let Count(); tel let Swing(arm); tel\ntel\n";
    let text = format!("{SWING}{COUNT}{strands}");
    let load = json!({"session": owner.session, "text": text});
    let loaded = owner.ask("task.load", &load);
    let task = loaded["result"]["task"].clone();
    assert!(task.is_string(), "{loaded}");
    owner.ask("task.start", &json!({"task": task}));
    owner.ask("watch.task", &json!({"task": task}));
    let error = owner.client.wait("why not", |text| {
        let update: Value = serde_json::from_str(text).ok()?;
        update["params"]["trouble"].as_str().map(str::to_owned)
    });
    let both = [
        "cannot start Count and Swing",
        "cannot start Swing and Count",
    ];
    assert!(both.iter().any(|names| error.starts_with(names)), "{error}");
    assert!(error.contains("is held by holder"), "{error}");
}

/// An ended command of a task reports the devices that it left moving.
#[test]
fn steps_of_a_task_tell_what_braked() {
    let server = open();
    let mut owner = Owner::new(&server);
    let text = format!("{SWING}task Once (arm: Arm) let Swing(arm); tel\n");
    let load = json!({"session": owner.session, "text": text});
    let task = owner.ask("task.load", &load)["result"]["task"].clone();
    owner.ask("task.start", &json!({"task": task}));
    std::thread::sleep(std::time::Duration::from_millis(200));
    owner.ask("emergency.stop", &json!({}));
    owner.ask("watch.task", &json!({"task": task}));
    let step = owner.client.wait("its step", |text| {
        let update: Value = serde_json::from_str(text).ok()?;
        let step = update["params"]["ended"][0].clone();
        step.is_object().then_some(step)
    });
    assert_eq!(step["why"], "emergency stop", "{step}");
    assert_eq!(step["braked"], json!(["arm"]), "{step}");
    assert_eq!(step["at"], "4:3", "{step}");
}

/// An emergency stop brakes everything of all clients. Nothing can be started until the reset, which requires that all
/// devices are at rest.
#[test]
fn an_emergency_stop_brakes_what_moves() {
    let server = open();
    let mut owner = Owner::new(&server);
    let swing = owner.load(SWING, "swing", "rpi");
    owner.ask("watch.command", &json!({"command": swing}));
    owner.ask("command.start", &json!({"command": swing}));
    std::thread::sleep(std::time::Duration::from_millis(100));
    let mut other = Owner::new(&server);
    let net = other.load(ECHO, "net", "rpinet");
    other.ask("emergency.stop", &json!({"by": "the guard"}));
    let ending = owner.client.wait("the end", |text| {
        let update: Value = serde_json::from_str(text).ok()?;
        let ending = update["params"]["ending"].clone();
        ending.is_object().then_some(ending)
    });
    assert_eq!(ending["why"], "emergency stop", "{ending}");
    assert_eq!(ending["braked"], json!(["arm"]), "{ending}");
    let description = owner.ask("command.describe", &json!({"command": swing}));
    let description = &description["result"];
    assert_eq!(description["state"], "terminated", "{description}");
    assert_eq!(
        description["ending"], ending,
        "whoever asks later hears the same"
    );
    assert_eq!(ending["cause"], "aborted", "{ending}");
    let place = ending["place"].as_str().unwrap_or_default();
    assert!(place.contains("arm"), "what has moved it: {ending}");
    assert_eq!(ending["at"], "4:3", "{ending}");
    let idle = other.ask("command.describe", &json!({"command": net}));
    assert_eq!(idle["result"]["state"], "ready", "{idle}");
    assert!(idle["result"]["ending"].is_null(), "{idle}");
    let state = owner.ask("emergency.state", &json!({}));
    assert_eq!(state["result"], json!({"stopped": true, "by": "the guard"}));
    let refused = other.ask("command.start", &json!({"command": net}));
    assert_eq!(refused["error"]["code"], -32006, "{refused}");
    let mut dio = Client::dio(server.address());
    let session = dio.ask("nse(\"test\")").unwrap();
    let net = dio.load(&session, ECHO);
    assert!(dio.ask(&format!("nest(\"{net}\")")).is_err());
    let begin = std::time::Instant::now();
    while other.ask("emergency.reset", &json!({}))["error"]["code"] == -32003 {
        assert!(begin.elapsed() < crate::client::PATIENCE);
    }
    assert!(dio.ask(&format!("nest(\"{net}\")")).is_ok());
}
