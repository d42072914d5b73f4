//! Every limit holds, its error names it, and other clients are not affected.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

use rpi_serve::{Limits, MemoryLimits, Server, Settings};
use serde_json::json;

use crate::client::{Client, PATIENCE, get, post, server, settings};
use crate::nets::ECHO;
use crate::rules::Owner;

fn with(limits: Limits) -> Server {
    server(
        &Settings {
            limits,
            ..settings()
        },
        (),
    )
}

/// Returns limits with this memory in bytes for commands.
fn commands(memory: usize) -> MemoryLimits {
    MemoryLimits {
        commands: memory,
        ..MemoryLimits::default()
    }
}

fn session(server: &Server) -> (Client, String) {
    let mut client = Client::dio(server.address());
    let session = client.ask("nse(\"test\")").unwrap();
    (client, session)
}

/// One client with many sessions leaves as much memory free as it holds.
#[test]
fn one_client_does_not_take_the_memory_of_all() {
    let server = with(Limits {
        memory: commands(60_000),
        ..Limits::default()
    });
    let ((mut one, first), (mut two, second)) = (session(&server), session(&server));
    let load = |session: &str| format!("nene(\"{ECHO}\",\"{session}\",\"\",0,1)");
    let refused = (0..100).find_map(|_| one.ask(&load(&first)).err());
    assert!(refused.unwrap().contains("memory of one client"));
    let more = one.ask("nse(\"more\")").unwrap();
    let refused = one.ask(&load(&more)).unwrap_err();
    assert!(refused.contains("memory of one client"), "{refused}");
    assert!(two.ask(&load(&second)).is_ok(), "the other has its own");
}

/// One client with the maximum of sessions leaves sessions and commands for the next one.
#[test]
fn one_client_does_not_take_all_places() {
    let server = with(Limits {
        sessions: 6,
        commands: 12,
        ..Limits::default()
    });
    let load = |session: &str| format!("nene(\"{ECHO}\",\"{session}\",\"\",0,1)");
    let mut greedy = Client::dio(server.address());
    let open = |k: usize| format!("nse(\"{k}\")");
    let sessions: Vec<String> = (0..6).map_while(|k| greedy.ask(&open(k)).ok()).collect();
    assert_eq!(sessions.len(), 3);
    let all = sessions.iter().cycle().take(12);
    let loaded = all.map_while(|session| greedy.ask(&load(session)).ok());
    assert_eq!(loaded.count(), 6);
    let (mut next, session) = self::session(&server);
    let loaded = (0..12).map_while(|_| next.ask(&load(&session)).ok());
    assert_eq!(loaded.count(), 3);
}

/// Commands of a disconnected client count for the next client of the same peer.
#[test]
fn what_a_client_leaves_behind_counts() {
    let server = with(Limits {
        sessions: 8,
        ..Limits::default()
    });
    for _ in 0..6 {
        let mut client = Client::dio(server.address());
        let session = client.ask("nse(\"left\",\"run-on\")").unwrap();
        let net = client.load(&session, ECHO);
        client.ask(&format!("nest(\"{net}\")")).unwrap();
    }
    let begin = Instant::now();
    let mut last = Client::dio(server.address());
    while get(server.address(), "/log")
        .matches("has disconnected")
        .count()
        < 6
    {
        assert!(begin.elapsed() < PATIENCE, "they are still there");
    }
    let refused = last.ask("nse(\"one more\")").unwrap_err();
    assert!(
        refused.contains("sessions of all clients of one peer"),
        "{refused}"
    );
}

/// Returns the reason in the server's close frame.
fn closed(client: &mut Client) -> String {
    let (begin, mut why) = (Instant::now(), String::new());
    while client.socket_mut().can_read() {
        assert!(begin.elapsed() < PATIENCE, "it is still listened to");
        if let Ok(tungstenite::Message::Close(Some(frame))) = client.socket_mut().read() {
            why = frame.reason.to_string();
        }
    }
    why
}

#[test]
fn a_message_that_is_too_long_ends_the_connection() {
    let server = with(Limits {
        message_bytes: 1000,
        ..Limits::default()
    });
    let (mut client, _) = session(&server);
    client.send(&format!("x=ver(\"{}\")", " ".repeat(2000)));
    let why = closed(&mut client);
    assert_eq!(why, "a message has at most 1000 bytes");
    let (mut client, _) = session(&server);
    let binary = tungstenite::Message::binary(vec![1, 2, 3]);
    client.socket_mut().send(binary).unwrap();
    assert_eq!(closed(&mut client), "binary messages are not supported");
    let body = format!("dionet={}", "x".repeat(2000));
    assert!(post(server.address(), "/eval", &body).starts_with("HTTP/1.1 413"));
    assert!(get(server.address(), "/sessions").starts_with("HTTP/1.1 200"));
}

#[test]
fn rules_and_devices_are_counted() {
    let server = with(Limits {
        rules: 4,
        devices: 2,
        ..Limits::default()
    });
    let (mut client, session) = session(&server);
    let net = client.load(&session, ECHO);
    let rule = format!("nesc(\"{net}.outcancelled\",[\"{net}\"],[],[])");
    assert!(client.ask(&rule).is_ok() && client.ask(&rule).is_ok());
    assert!(client.ask(&rule).unwrap_err().contains("rules"));
    // Without their command these rules can never fire, so they no longer count.
    client.ask(&format!("neun(\"{net}\")")).unwrap();
    let net = client.load(&session, ECHO);
    let rule = format!("nesc(\"{net}.outcancelled\",[\"{net}\"],[],[])");
    assert!(client.ask(&rule).is_ok());
    let add = |name: &str| {
        let form = format!("name={name} x&type=kuka_lwr_sim");
        post(server.address(), "/devices", &form)
    };
    assert!(add("a").starts_with("HTTP/1.1 200"));
    assert!(add("b").contains("limit reached: devices"));
}

/// With eight device slots, clients of one peer get at most six.
#[test]
fn nobody_makes_all_devices() {
    let server = with(Limits {
        devices: 9,
        ..Limits::default()
    });
    let add = |k: usize| {
        let form = format!("name=arm{k}&type=kuka_lwr_sim");
        post(server.address(), "/devices", &form)
    };
    let made: Vec<String> = (0..8).map(add).collect();
    let made = made.iter().map(|answer| answer.contains("200 OK"));
    let made: Vec<bool> = made.collect();
    assert_eq!(made.iter().position(|made| !made), Some(6), "{made:?}");
    let why = add(9);
    let whose = "limit reached: devices of all clients of one peer";
    assert!(why.contains(whose), "{why}");
}

#[test]
fn connections_are_counted_and_come_free_again() {
    let server = with(Limits {
        connections: 2,
        ..Limits::default()
    });
    let held = [(); 2].map(|()| Client::dio(server.address()));
    let mut third = TcpStream::connect(server.address()).unwrap();
    third.set_read_timeout(Some(PATIENCE)).unwrap();
    let _ = third.write_all(b"GET /nets HTTP/1.1\r\nHost: localhost\r\n\r\n");
    let mut answer = String::new();
    let _ = third.read_to_string(&mut answer);
    assert!(answer.starts_with("HTTP/1.1 503"), "{answer}");
    drop(held);
    let begin = Instant::now();
    while !get(server.address(), "/nets").starts_with("HTTP/1.1 200") {
        assert!(begin.elapsed() < PATIENCE, "no place comes free");
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// The images of a loaded task count as memory, and so does each command loaded from them.
#[test]
fn the_code_of_a_task_is_memory_and_so_are_its_commands() {
    let text = "command Long ()
var line: real^8000;
let
  n = 1 -> pre n + 1;
  x = real(n);
  line = x^8000 -> pre line;
  finish done when line[0] > 2.0;
tel
task Once () let Long(); tel
";
    let load = |memory: usize| {
        let server = with(Limits {
            memory: commands(memory),
            ..Limits::default()
        });
        let mut owner = Owner::new(&server);
        let load = json!({"session": owner.session, "text": text});
        let loaded = owner.ask("task.load", &load);
        (server, owner, loaded)
    };
    let (_server, _, refused) = load(2 * text.len() + 100);
    assert_eq!(refused["error"]["code"], -32004, "{refused}");
    let message = refused["error"]["message"].as_str().unwrap();
    assert!(message.contains("memory"), "{message}");
    // There is room for the images, but not for a command.
    let (_server, mut owner, loaded) = load(50_000);
    let task = loaded["result"]["task"].clone();
    assert!(task.is_string(), "{loaded}");
    let task = json!({"task": task});
    owner.ask("task.start", &task);
    let begin = Instant::now();
    let status = loop {
        let status = owner.ask("task.describe", &task)["result"].clone();
        if status["state"] == "failed" {
            break status;
        }
        assert!(begin.elapsed() < PATIENCE, "{status}");
    };
    let error = status["trouble"].as_str().unwrap();
    assert!(error.contains("memory quota is exhausted"), "{error}");
}
