//! Limits on the work of the cycle per tick, however much clients request.

use std::time::Instant;

use rpi_serve::{Limits, Server, Settings};
use serde_json::{Value, json};

use crate::client::{Client, PATIENCE, open, server, settings};
use crate::nets::ECHO;
use crate::rules::{COUNT, Owner};

fn with(limits: Limits) -> Server {
    let settings = Settings {
        limits,
        ..settings()
    };
    server(&settings, ())
}

fn until(mut is_so: impl FnMut() -> bool) {
    let begin = Instant::now();
    while !is_so() {
        assert!(begin.elapsed() < PATIENCE, "it does not come");
    }
}

/// Opens a shared session and loads a command in it.
fn shared(owner: &mut Owner) -> Value {
    let opened = owner.ask("session.open", &json!({"shared": true}));
    owner.session = opened["result"]["session"].clone();
    owner.load(ECHO, "echo", "rpinet")
}

#[test]
fn only_so_much_is_set_at_once() {
    let server = open();
    let mut owner = Owner::new(&server);
    let echo = shared(&mut owner);
    let echo = echo.as_str().unwrap();
    let mut dio = Client::dio(server.address());
    let set = |times: usize| {
        let values = vec!["\"ingain\":\"3\""; times].join(",");
        format!("snc({{\"{echo}\":{{{values},\"ingain\":\"4\"}}}})")
    };
    assert_eq!(dio.ask(&set(10)), Ok(String::new()));
    let refused = dio.ask(&set(50_000)).unwrap_err();
    assert!(refused.contains("values in one request"), "{refused}");
    // The message is not decoded.
    let refused = dio.ask(&set(100_000)).unwrap_err();
    assert!(refused.contains("values in one message"), "{refused}");
    // The last value of an input wins.
    owner.ask("command.start", &json!({"command": echo}));
    let describe = json!({"command": echo});
    until(|| owner.ask("command.describe", &describe)["result"]["values"]["twice"] == "8.0");
}

/// The cycle evaluates every fact of every rule in each tick, so their total number is limited.
#[test]
fn rules_say_only_so_much_in_all() {
    let server = with(Limits {
        rule_size: 200,
        ..Limits::default()
    });
    let mut owner = Owner::new(&server);
    let count = owner.load(COUNT, "count", "rpi");
    let name = count.as_str().unwrap();
    let when = vec![format!("{name}.even"); 40].join(" & ");
    let rule = json!({"when": when, "stop": [count, count]});
    let rules = [(); 3].map(|()| owner.ask("rule.make", &rule));
    assert!(rules[0]["result"]["rule"].is_string(), "{}", rules[0]);
    assert!(rules[1]["result"]["rule"].is_string(), "{}", rules[1]);
    assert_eq!(rules[2]["error"]["code"], -32004, "{}", rules[2]);
    // Inactive rules do not count.
    let drop = json!({"rule": rules[0]["result"]["rule"]});
    owner.ask("rule.withdraw", &drop);
    until(|| owner.ask("rule.make", &rule)["result"]["rule"].is_string());
    let many = json!({"when": "t", "cancel": vec![name; 100_000]});
    let refused = owner.ask("rule.make", &many);
    assert_eq!(refused["error"]["code"], -32004, "{refused}");
}

/// One client cannot use up the limit of all; its rules without commands are dropped when it disconnects.
#[test]
fn rules_are_counted_by_client() {
    let server = with(Limits {
        rules: 6,
        rule_size: 100,
        ..Limits::default()
    });
    let (mut one, mut other) = (Owner::new(&server), Owner::new(&server));
    let count = one.load(COUNT, "count", "rpi");
    let even = format!("{}.even", count.as_str().unwrap());
    let idle = json!({"when": even});
    for _ in 0..3 {
        assert!(one.ask("rule.make", &idle)["result"]["rule"].is_string());
    }
    let refused = one.ask("rule.make", &idle);
    assert_eq!(refused["error"]["code"], -32004, "{refused}");
    let message = refused["error"]["message"].as_str().unwrap();
    assert!(message.contains("rules of one client"), "{message}");
    let made = other.ask("rule.make", &idle);
    let rule = json!({"rule": made["result"]["rule"]});
    let long = json!({"when": vec![even; 96].join(" & ")});
    let refused = other.ask("rule.make", &long);
    let message = refused["error"]["message"].as_str().unwrap();
    assert!(
        message.contains("facts and commands in all rules of one client"),
        "{message}"
    );
    assert!(rule["rule"].is_string(), "the other has its own: {made}");
    one.ask("watch.rule", &rule);
    drop(other);
    one.client.wait("the end of the rule", |text| {
        text.contains("\"dropped\"").then_some(())
    });
}

#[test]
fn a_client_watches_only_so_much() {
    let server = with(Limits {
        subscriptions: 2,
        ..Limits::default()
    });
    let mut owner = Owner::new(&server);
    let count = owner.load(COUNT, "count", "rpi");
    let watch = json!({"command": count});
    for _ in 0..2 {
        assert_eq!(owner.ask("watch.command", &watch)["result"], json!({}));
    }
    let nothing = json!({});
    for (method, what) in [
        ("watch.command", &watch),
        ("watch.emergency", &nothing),
        ("watch.devices", &nothing),
    ] {
        let refused = owner.ask(method, what);
        assert_eq!(refused["error"]["code"], -32004, "{refused}");
    }
    // A subscription to an unloaded command does not count any more.
    owner.ask("command.unload", &watch);
    until(|| owner.ask("watch.emergency", &json!({}))["result"] == json!({}));
}

/// Tasks count as commands; ended ones are removed when the limit is reached.
#[test]
fn tasks_are_counted() {
    let server = with(Limits {
        commands: 8,
        ..Limits::default()
    });
    let mut owner = Owner::new(&server);
    let text = "command Quick ()\nlet\n  n = 1 -> pre n + 1;\n  finish done when n >= 3;\ntel\n\
        task Once () let Quick(); tel\n";
    let load = json!({"session": owner.session, "text": text, "title": "x".repeat(100_000)});
    let tasks = [(); 4].map(|()| owner.ask("task.load", &load)["result"]["task"].clone());
    assert!(tasks.iter().all(Value::is_string), "{tasks:?}");
    let refused = owner.ask("task.load", &load);
    assert_eq!(refused["error"]["code"], -32004, "{refused}");
    let all = owner.ask("tasks", &json!({}))["result"]["tasks"].clone();
    assert!(
        all[0]["title"].as_str().unwrap().len() < 1000,
        "titles are cut off"
    );
    owner.ask("task.unload", &json!({"task": tasks[0]}));
    owner.ask("task.start", &json!({"task": tasks[1]}));
    let describe = json!({"task": tasks[1]});
    until(|| owner.ask("task.describe", &describe)["result"]["state"] == "done");
    for _ in 0..2 {
        let loaded = owner.ask("task.load", &load);
        assert!(loaded["result"]["task"].is_string(), "{loaded}");
    }
    let gone = owner.ask("task.describe", &describe);
    assert_eq!(gone["error"]["code"], -32001, "it has made room: {gone}");
}

/// Answers of a connection to texts that are no requests.
fn errors(client: &mut Client, text: &str) -> Value {
    client.send(text);
    client.wait_for_next("an error", |answer| {
        let answer: Value = serde_json::from_str(answer).ok()?;
        answer["error"]["code"].is_i64().then_some(answer)
    })
}

/// A message with more values than fit is answered by one error, before any of them is made.
#[test]
fn a_message_has_only_so_many_values() {
    let server = open();
    let mut client = Client::rpc(server.address());
    let most = Limits::default().json_values;
    for text in [
        format!("[{}1]", "1,".repeat(2_000_000)),
        format!("[{}{{}}]", "{},".repeat(500_000)),
        format!("{{\"id\":1,\"params\":[{}1]}}", "[],".repeat(500_000)),
    ] {
        let answer = errors(&mut client, &text);
        assert_eq!(answer["error"]["code"], -32600);
        let message = format!("a message has at most {most} values");
        assert_eq!(answer["error"]["message"], message);
    }
    assert!(Owner::new(&server).session.is_string(), "others are served");
}

/// A batch has a greatest number of requests.
#[test]
fn a_batch_has_only_so_many_requests() {
    let server = open();
    let mut client = Client::rpc(server.address());
    let most = Limits::default().batch_requests;
    let answer = errors(&mut client, &format!("[{}1]", "1,".repeat(most)));
    let message = format!("a batch has at most {most} requests, found {}", most + 1);
    assert_eq!(answer["error"]["message"], message);
}

/// The answers to a batch have a budget; one error stands for those that exceed it.
#[test]
fn answers_to_a_batch_count() {
    let server = with(Limits {
        queued_bytes: 4096,
        ..Limits::default()
    });
    let mut client = Client::rpc(server.address());
    let ping = json!({"jsonrpc": "2.0", "id": 1, "method": "ping"});
    let batch = Value::Array(vec![ping; 200]);
    client.send(&batch.to_string());
    let answers = client.wait("the answers", |answer| {
        serde_json::from_str::<Vec<Value>>(answer).ok()
    });
    let (last, others) = answers.split_last().unwrap();
    assert!(others.len() > 10 && others.len() < 199, "{}", others.len());
    assert!(others.iter().all(|answer| answer["error"].is_null()));
    assert_eq!(last["error"]["code"], -32004, "{last}");
}
