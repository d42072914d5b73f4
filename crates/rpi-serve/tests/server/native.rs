//! The native interface: JSON-RPC over a websocket and over a Unix socket.

use serde_json::{Value, json};

use crate::client::{Client, open, server, settings};
use crate::nets::ECHO;
use rpi_serve::SocketSettings;

const PROGRAM: &str = "
command Count (limit: int)
let
  n = 1 -> pre n + 1;
  export n;
  finish done when n >= limit;
tel
";

pub(crate) fn call(client: &mut Client, id: u64, method: &str, params: &Value) -> Value {
    let request = json!({"jsonrpc": "2.0", "id": id, "method": method, "params": params});
    client.send(&request.to_string());
    client.wait(method, |text| {
        let answer: Value = serde_json::from_str(text).ok()?;
        (answer["id"] == json!(id)).then_some(answer)
    })
}

#[test]
fn a_program_is_loaded_scheduled_and_watched_to_its_end() {
    let server = open();
    let mut client = Client::rpc(server.address());
    let session = call(&mut client, 1, "session.open", &json!({"name": "test"}));
    let session = &session["result"]["session"];
    let program = PROGRAM
        .replace("(limit: int)", "()")
        .replace("limit", "500");
    let load = json!({"session": session, "text": program, "command": "Count"});
    let first = call(&mut client, 2, "command.load", &load);
    let first = first["result"]["command"].clone();
    assert!(first.is_string(), "{first}");
    let second = call(&mut client, 3, "command.load", &load)["result"]["command"].clone();
    let after = json!({"command": second, "after": first, "results": ["done"]});
    assert!(call(&mut client, 4, "command.schedule", &after)["result"]["rule"].is_string());
    for (id, command) in [(5, &first), (6, &second)] {
        call(
            &mut client,
            id,
            "watch.command",
            &json!({"command": command}),
        );
    }
    call(&mut client, 7, "command.start", &json!({"command": first}));
    let ending = client.wait("the end of the second", |text| {
        let update: Value = serde_json::from_str(text).ok()?;
        let params = &update["params"];
        let over = params["command"] == second && params["state"] == "terminated";
        over.then(|| params["ending"].clone())
    });
    assert_eq!(ending["result"], "done");
    assert_eq!(ending["error"], 0);
    assert_eq!(ending["cycles"], 500);
    let answer = call(
        &mut client,
        8,
        "command.describe",
        &json!({"command": second}),
    );
    assert_eq!(answer["result"]["values"]["n"], "500");
    assert_eq!(answer["result"]["results"], json!(["done"]));
}

#[test]
fn faults_are_told_by_code_and_with_every_reason() {
    let server = open();
    let mut client = Client::rpc(server.address());
    let session = call(&mut client, 1, "session.open", &json!({"on_loss": "abort"}));
    let session = session["result"]["session"].clone();
    let cases = [
        ("no.method", json!({}), -32601),
        ("session.open", json!({"on_loss": "dance"}), -32602),
        ("command.start", json!({"command": "n99"}), -32001),
        ("command.start", json!({}), -32602),
        (
            "command.load",
            json!({"session": "s99", "text": ""}),
            -32001,
        ),
        (
            "command.load",
            json!({"session": session, "text": "command X"}),
            -32002,
        ),
        ("rule.make", json!({"when": "n99.x"}), -32001),
        ("rule.make", json!({"when": "(("}), -32602),
    ];
    for (id, (method, params, code)) in (10..).zip(cases) {
        let answer = call(&mut client, id, method, &params);
        assert_eq!(answer["error"]["code"], code, "{method} {params}: {answer}");
    }
    client.send("{ no json");
    client.wait("a parse error", |text| {
        text.contains("-32700").then_some(())
    });
}

#[cfg(unix)]
#[test]
fn a_unix_socket_takes_a_message_per_line() {
    use std::io::{BufRead, BufReader, Write};
    use std::os::unix::net::UnixStream;

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rpi.sock");
    let server = server(
        &rpi_serve::Settings {
            sockets: vec![SocketSettings::new(path.clone())],
            limits: rpi_serve::Limits {
                message_bytes: 4096,
                ..settings().limits
            },
            ..settings()
        },
        (),
    );
    let mut stream = UnixStream::connect(&path).unwrap();
    stream
        .set_read_timeout(Some(crate::client::PATIENCE))
        .unwrap();
    let mut answers = BufReader::new(stream.try_clone().unwrap()).lines();
    let mut ask = |mut request: Value| -> Value {
        request["jsonrpc"] = json!("2.0");
        stream.write_all(format!("{request}\n").as_bytes()).unwrap();
        serde_json::from_str(&answers.next().unwrap().unwrap()).unwrap()
    };
    let open = ask(json!({"id": 1, "method": "session.open", "params": {}}));
    let session = &open["result"]["session"];
    let load = json!({"session": session, "text": ECHO, "language": "rpinet"});
    let loaded = ask(json!({"id": 2, "method": "command.load", "params": load}));
    let command = &loaded["result"]["command"];
    let answer =
        ask(json!({"id": 3, "method": "command.describe", "params": {"command": command}}));
    assert_eq!(answer["result"]["inputs"][0]["key"], "gain");
    assert_eq!(answer["result"]["state"], "ready");
    stream.write_all(&vec![b' '; 1 << 16]).unwrap();
    let error_line: Value = serde_json::from_str(&answers.next().unwrap().unwrap()).unwrap();
    assert_eq!(error_line["error"]["code"], -32600, "{error_line}");
    assert_eq!(
        error_line["error"]["message"],
        "a message has at most 4096 bytes"
    );
    assert!(answers.next().is_none_or(|line| line.is_err()));
    drop(server);
    assert!(!path.exists());
}

#[test]
fn an_address_that_is_taken_is_told_by_name() {
    let first = open();
    let cell = rpi_sim::Cell::parse("cell.toml", "").unwrap();
    let settings = rpi_serve::Settings {
        listen: first.address(),
        ..settings()
    };
    let why = rpi_serve::Server::open(&cell, &settings, ()).unwrap_err();
    let why = why.to_string();
    assert!(why.starts_with(&first.address().to_string()), "{why}");
    assert!(why.contains("another program listens there"), "{why}");
}

#[cfg(unix)]
#[test]
fn only_sockets_that_nobody_listens_at_are_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rpi.sock");
    let cell = rpi_sim::Cell::parse("cell.toml", "").unwrap();
    let settings = rpi_serve::Settings {
        sockets: vec![SocketSettings::new(path.clone())],
        ..settings()
    };
    let refused = || {
        let why = rpi_serve::Server::open(&cell, &settings, ()).unwrap_err();
        let why = why.to_string();
        assert!(why.starts_with(path.to_str().unwrap()), "{why}");
        why
    };
    std::fs::write(&path, "notes").unwrap();
    assert!(refused().ends_with("another file is at this path and is kept"));
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "notes");
    std::fs::remove_file(&path).unwrap();
    let other = std::os::unix::net::UnixListener::bind(&path).unwrap();
    assert!(refused().ends_with("another server is listening there") && path.exists());
    // A server that closes removes its socket file.
    drop(other);
    drop(rpi_serve::Server::open(&cell, &settings, ()).unwrap());
    assert!(!path.exists());
}

/// Waits until a page satisfies `wanted`.
fn until(server: &rpi_serve::Server, page: &str, wanted: impl Fn(&str) -> bool) {
    let begin = std::time::Instant::now();
    loop {
        let page = crate::client::get(server.address(), page);
        if wanted(&page) {
            return;
        }
        assert!(begin.elapsed() < crate::client::PATIENCE, "{page}");
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
}

#[test]
fn a_session_that_runs_on_goes_with_what_nobody_has_started() {
    let server = open();
    let mut client = Client::rpc(server.address());
    let opened = json!({"name": "left behind", "on_loss": "run-on"});
    let opened = call(&mut client, 1, "session.open", &opened);
    let load = json!({"session": opened["result"]["session"], "text": ECHO, "language": "rpinet"});
    call(&mut client, 2, "command.load", &load);
    until(&server, "/sessions", |page| page.contains("left behind"));
    drop(client);
    until(&server, "/sessions", |page| !page.contains("left behind"));
}

#[test]
fn whoever_takes_a_session_up_again_owns_it() {
    let server = open();
    let mut first = Client::rpc(server.address());
    let opened = json!({"name": "heirloom", "on_loss": "run-on"});
    let session = call(&mut first, 1, "session.open", &opened)["result"]["session"].clone();
    let load = json!({"session": session, "text": ECHO, "language": "rpinet"});
    let running = call(&mut first, 2, "command.load", &load)["result"]["command"].clone();
    call(&mut first, 3, "command.start", &json!({"command": running}));
    drop(first);
    let lost = format!(
        "the client of session {} has disconnected",
        session.as_str().unwrap()
    );
    until(&server, "/log", |page| page.contains(&lost));
    let mut heir = Client::rpc(server.address());
    call(&mut heir, 1, "command.load", &load);
    call(&mut heir, 2, "command.abort", &json!({"command": running}));
    until(&server, "/nets", |page| !page.contains("Running"));
    until(&server, "/sessions", |page| page.contains("heirloom"));
    drop(heir);
    until(&server, "/sessions", |page| !page.contains("heirloom"));
}

/// Returns a command that ends by the result `left` or `right`, given by `side`.
fn turn(side: &str) -> String {
    format!(
        "command Turn ()
let
  n = 1 -> pre n + 1;
  finish left when n >= 50 and {};
  finish right when n >= 50;
tel",
        side == "left"
    )
}

/// Both successors are loaded ahead. The result selects one between two cycles, and the other one is unloaded.
#[test]
fn a_task_branches_by_result() {
    for side in ["left", "right"] {
        let server = open();
        let mut client = Client::rpc(server.address());
        let opened = call(&mut client, 1, "session.open", &json!({"name": "test"}));
        let session = &opened["result"]["session"];
        let count = PROGRAM
            .replace("(limit: int)", "()")
            .replace("limit", "100");
        let mut load = |id: u64, text: &str| {
            let load = json!({"session": session, "text": text});
            call(&mut client, id, "command.load", &load)["result"]["command"].clone()
        };
        let commands = [load(2, &turn(side)), load(3, &count), load(4, &count)];
        let [turn, left, right] = &commands;
        for (id, command, result) in [(5, left, "left"), (6, right, "right")] {
            let after = json!({"command": command, "after": turn, "results": [result]});
            let made = call(&mut client, id, "command.schedule", &after);
            assert!(made["result"]["rule"].is_string(), "{made}");
        }
        for (id, command) in (7..).zip(&commands) {
            call(
                &mut client,
                id,
                "watch.command",
                &json!({"command": command}),
            );
        }
        call(&mut client, 10, "command.start", &json!({"command": turn}));
        let (winner, loser) = if side == "left" {
            (left, right)
        } else {
            (right, left)
        };
        client.wait("the end of the winner", |text| {
            let update: Value = serde_json::from_str(text).ok()?;
            let params = &update["params"];
            (params["command"] == *winner && params["state"] == "terminated").then_some(())
        });
        client.wait("the loser is unloaded, and reported", |text| {
            let update: Value = serde_json::from_str(text).ok()?;
            let params = &update["params"];
            (params["command"] == *loser && params["state"] == "unloaded").then_some(())
        });
        let mut describe = |id: u64, command: &Value| {
            let command = json!({"command": command});
            call(&mut client, id, "command.describe", &command)
        };
        assert_eq!(describe(11, turn)["result"]["ending"]["result"], side);
        assert_eq!(describe(12, winner)["result"]["ending"]["cycles"], 100);
        assert_eq!(describe(13, loser)["error"]["code"], -32001);
    }
}
