//! Updates about the outcome of tasks and commands.

use rpi_core::Continuity;
use rpi_serve::Settings;
use serde_json::{Value, json};

use crate::client::{get, open, server, settings};
use crate::rules::{COUNT, Owner, SWING};

/// A command that takes over with a jump of joint 0.
const LEAP: &str = "use motion;
command Leap (arm: Arm)
let
  arm.joints = (arm.position with [0] = arm.position[0] + 0.5[rad]);
  finish done when time > 1[s];
tel
";

/// Waits for the next update of this command or task that `wanted` accepts.
fn next<T>(
    owner: &mut Owner,
    (kind, name): (&str, &Value),
    wanted: impl Fn(&Value) -> Option<T>,
) -> T {
    owner.client.wait("an update", |text| {
        let update: Value = serde_json::from_str(text).ok()?;
        let params = &update["params"];
        wanted(params).filter(|_| params[kind] == *name)
    })
}

/// A subscriber to a task is notified when the task is unloaded; it would wait for ever otherwise.
#[test]
fn who_watches_a_task_is_told_that_it_is_unloaded() {
    let server = open();
    let mut owner = Owner::new(&server);
    let text = format!("{COUNT}task All let Count(); tel\n");
    let load = json!({"session": owner.session, "text": text});
    for ends in [&["unloaded"][..], &["done", "unloaded"]] {
        let task = owner.ask("task.load", &load)["result"]["task"].clone();
        owner.ask("watch.task", &json!({"task": task}));
        if ends.len() > 1 {
            owner.ask("task.start", &json!({"task": task}));
        }
        owner.ask("task.unload", &json!({"task": task}));
        for end in ends {
            next(&mut owner, ("task", &task), |update| {
                (update["state"] == *end).then_some(())
            });
        }
    }
}

/// A jump is reported with actuator, quantity, value and limit as by `rpi run`: in the ending if it is refused, at once
/// if it is allowed.
#[test]
fn a_leap_is_told_to_whom_it_concerns() {
    for (continuity, cause) in [(None, Some("fault")), (Some(Continuity::Allow), None)] {
        let server = server(
            &Settings {
                continuity,
                ..settings()
            },
            (),
        );
        let mut owner = Owner::new(&server);
        let first = owner.load(SWING, "first", "rpi");
        let leap = owner.load(LEAP, "leap", "rpi");
        owner.ask("watch.command", &json!({"command": leap}));
        let rule = json!({"when": format!("{}@ended", first.as_str().unwrap()), "start": [leap]});
        let made = owner.ask("rule.make", &rule);
        assert!(made["error"].is_null(), "{made}");
        owner.ask("command.start", &json!({"command": first}));
        std::thread::sleep(std::time::Duration::from_millis(50));
        owner.ask("command.cancel", &json!({"command": first}));
        let jump = next(&mut owner, ("command", &leap), |update| {
            update["jump"].as_str().map(str::to_owned)
        });
        assert!(jump.starts_with("velocity of arm[0] would be "), "{jump}");
        assert!(jump.ends_with("is the limit"), "{jump}");
        if let Some(cause) = cause {
            let ending = next(&mut owner, ("command", &leap), |update| {
                update["ending"]
                    .is_object()
                    .then(|| update["ending"].clone())
            });
            assert_eq!(ending["cause"], cause, "{ending}");
            assert_eq!(ending["jump"], json!(jump), "{ending}");
        }
        let answer = owner.ask("command.describe", &json!({"command": leap}));
        assert_eq!(answer["result"]["jump"], json!(jump), "{answer}");
        let log = get(server.address(), "/log");
        assert!(
            log.contains(&format!("(leap) takes over with a jump: {jump}")),
            "{log}"
        );
    }
}
