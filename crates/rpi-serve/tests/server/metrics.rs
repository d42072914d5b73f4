//! The page `/metrics`, and the log file.

use std::collections::BTreeMap;
use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::Instant;

use rpi_serve::{Server, Settings};
use serde_json::{Value, json};

use crate::client::{PATIENCE, server, settings};
use crate::rules::Owner;

const SHORT: &str = "
command Short ()
let
  n = 1 -> pre n + 1;
  finish done when n >= 20;
tel
";

/// Returns the value of each sample of the page by name with labels.
fn samples(server: &Server) -> BTreeMap<String, f64> {
    let mut stream = TcpStream::connect(server.address()).unwrap();
    let request = "GET /metrics HTTP/1.1\r\nHost: localhost\r\n\r\n";
    stream.write_all(request.as_bytes()).unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    let (head, page) = answer.split_once("\r\n\r\n").unwrap();
    assert!(head.contains("application/openmetrics-text"), "{head}");
    assert!(page.ends_with("# EOF\n"), "{page}");
    let lines = page.lines().filter(|line| !line.starts_with('#'));
    lines
        .map(|line| {
            let (name, value) = line.rsplit_once(' ').unwrap();
            (name.to_owned(), value.parse().unwrap())
        })
        .collect()
}

/// Waits until a sample has a value.
fn wait_for(server: &Server, name: &str, wanted: f64) -> BTreeMap<String, f64> {
    let begin = Instant::now();
    loop {
        let all = samples(server);
        let value = *all.get(name).unwrap_or_else(|| panic!("{name}: {all:?}"));
        if value == wanted {
            return all;
        }
        assert!(begin.elapsed() < PATIENCE, "{name} is {value}");
    }
}

#[test]
fn commands_loads_and_ticks_are_counted() {
    let server = server(&settings(), ());
    let mut owner = Owner::new(&server);
    let go = owner.load(SHORT, "short", "rpi");
    owner.ask("command.start", &json!({"command": go}));
    let ended = r#"rpi_commands_ended_total{cause="result"}"#;
    let all = wait_for(&server, ended, 1.0);
    assert_eq!(all[r#"rpi_loads_total{outcome="accepted"}"#], 1.0);
    assert_eq!(all[r#"rpi_commands{state="terminated"}"#], 1.0);
    assert_eq!(all[r#"rpi_commands{state="running"}"#], 0.0);
    assert_eq!(all["rpi_sessions"], 1.0);
    assert!(all["rpi_ticks_total"] >= 20.0);
    // All buckets are cumulative, so the last one has all ticks.
    let count = all["rpi_tick_duration_seconds_count"];
    assert_eq!(all[r#"rpi_tick_duration_seconds_bucket{le="+Inf"}"#], count);
    assert!(all["rpi_tick_duration_seconds_sum"] > 0.0);
}

#[test]
fn refusals_are_counted() {
    let server = server(&settings(), ());
    let mut owner = Owner::new(&server);
    let session = owner.ask("session.open", &json!({}))["result"]["session"].clone();
    let bad = json!({"session": session, "text": "command X"});
    assert!(owner.ask("command.load", &bad)["error"].is_object());
    owner.ask("emergency.stop", &json!({"by": "a test"}));
    let rejected = r#"rpi_loads_total{outcome="rejected"}"#;
    let all = wait_for(&server, rejected, 1.0);
    assert_eq!(all["rpi_emergency_stop"], 1.0);
    assert_eq!(all["rpi_emergency_stop_requests_total"], 1.0);
    assert_eq!(all[r#"rpi_rejections_total{reason="wrong_token"}"#], 0.0);
    assert!(all[r#"rpi_connections{kind="network"}"#] >= 1.0);
}

#[test]
fn the_log_file_outlives_the_server() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("server.log");
    let logged = || Settings {
        log_file: Some(path.clone()),
        ..settings()
    };
    for by in ["the first", "the second"] {
        let server = server(&logged(), ());
        Owner::new(&server).ask("emergency.stop", &json!({"by": by}));
        server.close().unwrap();
    }
    let text = std::fs::read_to_string(&path).unwrap();
    let lines: Vec<Value> = text
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    for by in ["the first", "the second"] {
        let stop = format!("EMERGENCY STOP by {by}");
        let found = lines.iter().any(|line| line["message"] == stop.as_str());
        assert!(found, "{text}");
    }
}
