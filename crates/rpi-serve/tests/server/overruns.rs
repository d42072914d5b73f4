//! Commands whose cycles take too long are counted with their location in the program, and ended if their policy is
//! to end them.

use std::fmt::Write as _;
use std::fs::File;
use std::io::BufWriter;
use std::time::{Duration, Instant};

use rpi_record::mcap::{
    PartLimits, Profile, Recording, RecordingOptions, RunSources, replay, single_part,
};
use rpi_serve::{Server, Settings};
use rpi_sim::Cell;
use serde_json::{Value, json};

use crate::client::{CELL, Client, PATIENCE, settings};
use crate::native::call;

/// Number of cosines in a row, more than a tick of [`TICK_NS`] can compute.
const COSINES: usize = 3000;
const TICK_NS: u64 = 50_000;

/// Returns a command with a fragment that takes longer than a tick in every cycle. It exports its number of cycles.
fn heavy() -> String {
    let mut text = "command Heavy ()\nlet\n  n = 1 -> pre n + 1;\n  export n;\n".to_owned();
    text.push_str("  fragment Busy when n > 0\n  let\n    x0 = real(n);\n");
    for k in 1..=COSINES {
        let _ = writeln!(text, "    x{k} = cos(x{});", k - 1);
    }
    let _ = write!(
        text,
        "    far = x{COSINES} > 2.0;\n  tel\n  finish done when Busy.far ?? false;\ntel\n"
    );
    text
}

fn quick() -> Settings {
    Settings {
        tick_ns: TICK_NS,
        cycle_share: None,
        ..settings()
    }
}

fn session(client: &mut Client) -> Value {
    let opened = call(client, 1, "session.open", &json!({"name": "test"}));
    opened["result"]["session"].clone()
}

fn load(client: &mut Client, session: &Value, on_overrun: &str) -> Value {
    let params = json!({"session": session, "text": heavy(), "on_overrun": on_overrun});
    let loaded = call(client, 2, "command.load", &params);
    let command = loaded["result"]["command"].clone();
    assert!(command.is_string(), "{loaded}");
    command
}

fn describe(client: &mut Client, command: &Value) -> Value {
    let description = call(client, 4, "command.describe", &json!({"command": command}));
    description["result"].clone()
}

/// Starts a command and waits until its description satisfies `is_so`.
fn run_until(client: &mut Client, command: &Value, is_so: impl Fn(&Value) -> bool) -> Value {
    let started = call(client, 3, "command.start", &json!({"command": command}));
    assert!(started["error"].is_null(), "{started}");
    let begin = Instant::now();
    loop {
        let description = describe(client, command);
        if is_so(&description) {
            return description;
        }
        assert!(begin.elapsed() < PATIENCE, "{description}");
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn what_takes_too_long_is_counted_with_its_place() {
    let server = crate::client::server(&quick(), ());
    let mut client = Client::rpc(server.address());
    let session = session(&mut client);
    let heavy = load(&mut client, &session, "count");
    let often = |description: &Value| description["overruns"]["count"].as_u64() > Some(20);
    let description = run_until(&mut client, &heavy, often);
    assert_eq!(description["state"], "running", "counting ends nothing");
    let overruns = &description["overruns"];
    assert_eq!(overruns["fragment"], "Busy", "{description}");
    let took = overruns["took"].as_f64().unwrap();
    assert!(took > 10e-6 && took < 10.0, "{description}");
    assert!(overruns["late"].as_f64() > Some(0.0), "{description}");
}

/// A command with an abort policy ends with cause and location; another command keeps running. A replay of the
/// recording agrees.
#[test]
fn a_policy_of_its_own_ends_a_command_and_no_other() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.mcap");
    let cell = Cell::parse("cell.toml", CELL).unwrap_or_else(|errors| panic!("{errors}"));
    let wanted = RecordingOptions {
        parts: single_part(BufWriter::new(File::create(&path).unwrap())),
        limits: PartLimits::default(),
        profile: Profile::default(),
        origin: RunSources {
            cell: CELL.to_owned(),
            ..RunSources::default()
        },
    };
    let server = Server::open_recorded(&cell, &quick(), (), Some(wanted)).unwrap();
    let mut client = Client::rpc(server.address());
    let session = session(&mut client);
    let light = call(
        &mut client,
        2,
        "command.load",
        &json!({"session": session, "text": "command Light () let n = 1 -> pre n + 1; finish done when n < 0; tel"}),
    )["result"]["command"]
        .clone();
    call(&mut client, 3, "command.start", &json!({"command": light}));
    let heavy = load(&mut client, &session, "abort:3/5");
    let description = run_until(&mut client, &heavy, |description| {
        description["state"] == "terminated"
    });
    let ending = &description["ending"];
    assert_eq!(ending["cause"], "aborted", "{description}");
    assert_eq!(ending["why"], "too many overruns");
    assert_eq!(ending["place"], "Busy", "{description}");
    assert!(ending["cycles"].as_u64() >= Some(3), "{description}");
    assert_eq!(describe(&mut client, &light)["state"], "running");
    server.close().unwrap();
    let bytes = std::fs::read(&path).unwrap();
    let messages = mcap::MessageStream::new(&bytes)
        .unwrap()
        .map(Result::unwrap);
    let mut events = messages.filter(|message| message.channel.topic == "/events");
    let fragment = br#""fragment":"Busy""#;
    let names_it = |text: &[u8]| text.windows(fragment.len()).any(|part| part == fragment);
    assert!(events.any(|event| names_it(&event.data)));
    let report = replay(&Recording::read(&bytes).unwrap()).unwrap();
    assert!(report.agrees(), "{report}");
}

#[test]
fn a_policy_that_is_none_is_refused_with_the_forms() {
    let server = crate::client::open();
    let mut client = Client::rpc(server.address());
    let session = session(&mut client);
    for bad in [json!("abort:9/3"), json!("dance"), json!(3)] {
        let params = json!({"session": session, "text": "", "on_overrun": bad});
        let answer = call(&mut client, 2, "command.load", &params);
        assert_eq!(answer["error"]["code"], -32602, "{answer}");
        let message = answer["error"]["message"].as_str().unwrap();
        assert!(message.contains("on_overrun"), "{message}");
    }
}
