//! Requests whose memory would be a multiple of their text, or would stay after their answer.

use rpi_serve::{Limits, MemoryLimits, Settings};
use serde_json::{Value, json};

use crate::client::{Client, get, open, server, settings};
use crate::nets::ECHO;
use crate::rules::{COUNT, Owner};

/// Returns the message of the error that answers a request.
fn refused(owner: &mut Owner, method: &str, params: &Value) -> String {
    let answer = owner.ask(method, params);
    let message = answer["error"]["message"].as_str();
    message.unwrap_or_else(|| panic!("{answer}")).to_owned()
}

/// A condition is a tree: functions on a deeper one would overflow the stack of the connection.
#[test]
fn a_successor_waits_for_a_limited_number_of_results() {
    let server = open();
    let mut owner = Owner::new(&server);
    let commands = [(); 2].map(|()| owner.load(COUNT, "count", "rpi"));
    let schedule = |after: &Value, results: usize| {
        let results = vec!["done"; results];
        json!({"command": commands[1], "after": after, "results": results})
    };
    let why = refused(
        &mut owner,
        "command.schedule",
        &schedule(&commands[0], 100_000),
    );
    assert!(why.contains("at most 256 facts"), "{why}");
    // Each fact would have a copy of the name.
    let long = json!("n".repeat(10_000_000));
    let why = refused(&mut owner, "command.schedule", &schedule(&long, 256));
    assert!(why.starts_with("there is no command nnn"), "{}", &why[..40]);
    let made = owner.ask("command.schedule", &schedule(&commands[0], 256));
    assert!(made["result"]["rule"].is_string(), "{made}");
}

/// Subscriptions and requests that are answered later keep the tag of a message.
#[test]
fn a_tag_and_an_id_are_short() {
    let server = open();
    let mut dio = Client::dio(server.address());
    for (length, answer) in [(256, "=ok("), (257, "error=err(")] {
        dio.send(&format!("{}=ver(\"2.0\")", "t".repeat(length)));
        dio.wait_for_next(answer, |text| text.contains(answer).then_some(()));
    }
    let mut rpc = Client::rpc(server.address());
    for (length, answer) in [(256, "\"result\""), (257, "\"id\":null")] {
        let id = "i".repeat(length);
        rpc.send(&json!({"jsonrpc": "2.0", "id": id, "method": "ping"}).to_string());
        rpc.wait_for_next(answer, |text| text.contains(answer).then_some(()));
    }
}

/// A subscription keeps the name of its object.
#[test]
fn an_object_has_one_name() {
    let server = open();
    let mut owner = Owner::new(&server);
    let command = owner.load(ECHO, "echo", "rpinet");
    let digits = command.as_str().unwrap().trim_start_matches('n');
    for prefix in ["n0", "n+", "n00000000"] {
        let name = format!("{prefix}{digits}");
        let why = refused(&mut owner, "watch.command", &json!({"command": name}));
        assert_eq!(why, format!("there is no command {name}"));
    }
}

/// The tree of a literal takes twenty times the memory of its text.
#[test]
fn a_value_has_no_more_elements_than_its_type() {
    let server = open();
    let mut owner = Owner::new(&server);
    let command = owner.load(ECHO, "echo", "rpinet");
    let many = format!("[{}1]", "1,".repeat(1_000_000));
    let set = json!({"command": command, "values": {"gain": many}});
    let why = refused(&mut owner, "command.set", &set);
    assert!(
        why.ends_with("too many elements"),
        "{}",
        &why[why.len() - 100..]
    );
    let add = json!({"name": "b", "type": "kuka_lwr_sim", "parameters": {"link_lengths": many}});
    let why = refused(&mut owner, "device.add", &add);
    assert!(why.contains("too many elements"), "{why}");
}

/// Clients that request large pages share the memory of queued messages.
#[test]
fn a_page_needs_memory() {
    let limits = Limits {
        memory: MemoryLimits {
            outgoing: 1 << 20,
            ..MemoryLimits::default()
        },
        ..Limits::default()
    };
    let server = server(
        &Settings {
            limits,
            ..settings()
        },
        (),
    );
    let mut owner = Owner::new(&server);
    for (length, status) in [(1 << 19, "200"), (1 << 21, "503")] {
        let text = format!("{ECHO}{}", " ".repeat(length));
        let command = owner.load(&text, "echo", "rpinet");
        let page = format!("/nets/{}/dio", command.as_str().unwrap());
        let response = get(server.address(), &page);
        assert!(
            response.starts_with(&format!("HTTP/1.1 {status} ")),
            "{}",
            &response[..40]
        );
        assert!(status == "503" || response.ends_with(&text));
    }
    assert!(get(server.address(), "/nets").starts_with("HTTP/1.1 200"));
}
