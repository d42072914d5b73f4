//! Every limit holds, is told by name, and leaves the others alone.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

use rpi_serve::{Limits, Server, Settings};
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

fn session(server: &Server) -> (Client, String) {
    let mut client = Client::dio(server.address());
    let session = client.ask("nse(\"test\")").unwrap();
    (client, session)
}

#[test]
fn the_memory_of_a_session_is_its_own() {
    let server = with(Limits {
        session_memory: 20_000,
        ..Limits::default()
    });
    let ((mut one, first), (mut two, second)) = (session(&server), session(&server));
    let load = |session: &str| format!("nene(\"{ECHO}\",\"{session}\",\"\",0,1)");
    let refused = (0..100).find_map(|_| one.ask(&load(&first)).err());
    assert!(refused.unwrap().contains("memory of the session"));
    assert!(two.ask(&load(&second)).is_ok(), "the other has its own");
}

#[test]
fn a_message_that_is_too_long_ends_the_connection() {
    let server = with(Limits {
        message: 1000,
        ..Limits::default()
    });
    let (mut client, _) = session(&server);
    client.send(&format!("x=ver(\"{}\")", " ".repeat(2000)));
    let begin = Instant::now();
    while client.socket_mut().can_read() {
        assert!(begin.elapsed() < PATIENCE, "it is still listened to");
        let _ = client.socket_mut().read();
    }
    let body = format!("dionet={}", "x".repeat(2000));
    assert!(post(server.address(), "/eval", &body).starts_with("HTTP/1.1 413"));
    assert!(get(server.address(), "/sessions").starts_with("HTTP/1.1 200"));
}

#[test]
fn rules_and_devices_are_counted() {
    let server = with(Limits {
        rules: 2,
        devices: 2,
        ..Limits::default()
    });
    let (mut client, session) = session(&server);
    let net = client.load(&session, ECHO);
    let rule = format!("nesc(\"{net}.outcancelled\",[\"{net}\"],[],[])");
    assert!(client.ask(&rule).is_ok() && client.ask(&rule).is_ok());
    assert!(client.ask(&rule).unwrap_err().contains("rules"));
    // Without their command they can never fire, and make room.
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

#[test]
fn connections_are_counted_and_come_free_again() {
    let server = with(Limits {
        connections: 2,
        ..Limits::default()
    });
    let held = [(); 2].map(|()| Client::dio(server.address()));
    let mut third = TcpStream::connect(server.address()).unwrap();
    third.set_read_timeout(Some(PATIENCE)).unwrap();
    let _ = third.write_all(b"GET /nets HTTP/1.1\r\n\r\n");
    let mut answer = Vec::new();
    let _ = third.read_to_end(&mut answer);
    assert!(answer.is_empty(), "it is turned away without a word");
    drop(held);
    let begin = Instant::now();
    while !get(server.address(), "/nets").starts_with("HTTP/1.1 200") {
        assert!(begin.elapsed() < PATIENCE, "no place comes free");
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// The images of a task are kept for as long as it is there: they count, and so does each command that it has loaded.
#[test]
fn the_code_of_a_task_is_memory_of_its_session() {
    use std::fmt::Write as _;
    let mut text = "command Long () let n = 1 -> pre n + 1; x0 = real(n);\n".to_owned();
    for k in 1..=2000 {
        let _ = writeln!(text, "x{k} = cos(x{});", k - 1);
    }
    text.push_str("finish done when x2000 > 2.0; tel\ntask Once () let Long(); tel\n");
    let load = |memory: usize| {
        let server = with(Limits {
            session_memory: memory,
            ..Limits::default()
        });
        let mut owner = Owner::new(&server);
        let load = json!({"session": owner.session, "text": text});
        let loaded = owner.ask("task.load", &load);
        (server, owner, loaded)
    };
    let (_server, _, refused) = load(text.len() + 10_000);
    assert_eq!(refused["error"]["code"], -32004, "{refused}");
    let message = refused["error"]["message"].as_str().unwrap();
    assert!(message.contains("memory of the session"), "{message}");
    // Room for the images, and none for a command.
    let most = (1..40).map(|k| text.len() + k * 10_000);
    let task_only = most.map(load).find_map(|(server, owner, loaded)| {
        let task = loaded["result"]["task"].clone();
        task.is_string().then_some((server, owner, task))
    });
    let (_server, mut owner, task) = task_only.expect("it fits into 400 kB");
    let task = json!({"task": task});
    owner.ask("task.start", &task);
    let begin = Instant::now();
    let told = loop {
        let told = owner.ask("task.describe", &task)["result"].clone();
        if told["state"] == "failed" {
            break told;
        }
        assert!(begin.elapsed() < PATIENCE, "{told}");
    };
    let trouble = told["trouble"].as_str().unwrap();
    assert!(trouble.contains("no memory left"), "{trouble}");
}
