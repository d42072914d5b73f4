//! Attacks by clients that load commands.

use std::io::{Read, Write};
use std::os::unix::net::UnixStream;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use crate::connection::{Target, line, sent};
use crate::kinds::LONG;

fn until(over: &AtomicBool) {
    while !over.load(Ordering::Relaxed) {
        thread::sleep(Duration::from_millis(5));
    }
}

/// Opens a session; `None` if the server has no place for it.
fn session(target: &Target) -> Option<(UnixStream, String)> {
    let mut stream = line(target)?;
    let open =
        "{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"session.open\",\"params\":{\"name\":\"s\"}}";
    let answer = answer_of(&mut stream, open);
    let (_, rest) = answer.split_once("\"session\":\"")?;
    let name = rest.split('"').next()?.to_owned();
    Some((stream, name))
}

/// Sends a line and returns the answer, or a part of it.
fn answer_of(stream: &mut UnixStream, request: &str) -> String {
    let _ = writeln!(stream, "{request}");
    let mut answer = vec![0; 1000];
    let count = stream.read(&mut answer).unwrap_or(0);
    String::from_utf8_lossy(&answer[..count]).into_owned()
}

/// Returns a request to load a text in a session. `id` is JSON.
fn load_request(id: &str, session: &str, text: &str) -> String {
    let text = text.replace('"', "\\\"").replace('\n', "\\n");
    format!(
        "{{\"jsonrpc\":\"2.0\",\"id\":{id},\"method\":\"command.load\",\"params\":{{\"session\":\"{session}\",\"text\":\"{text}\"}}}}"
    )
}

/// Loads a text in a new session. Returns the client and the name of the command.
fn loaded(target: &Target, text: &str) -> Option<(UnixStream, String)> {
    let (mut stream, session) = session(target)?;
    stream
        .set_read_timeout(Some(Duration::from_secs(20)))
        .ok()?;
    let answer = answer_of(&mut stream, &load_request("2", &session, text));
    let (_, rest) = answer.split_once("\"command\":\"")?;
    let name = rest.split('"').next()?.to_owned();
    Some((stream, name))
}

/// Opens a session and loads a text several times, without waiting for the answers.
fn load(target: &Target, text: &str, times: usize, over: &AtomicBool) {
    let Some((mut stream, session)) = session(target) else {
        return;
    };
    let load = load_request("2", &session, text);
    for _ in 0..times {
        if writeln!(stream, "{load}").is_err() || over.load(Ordering::Relaxed) {
            return;
        }
    }
    for _ in 0..20 {
        if over.load(Ordering::Relaxed) || stream.read(&mut [0; 1 << 16]).is_ok_and(|n| n == 0) {
            return;
        }
    }
    until(over);
}

/// Queues loads whose answers repeat an id.
pub(crate) fn long_ids(target: &Target, _: u64, over: &AtomicBool) {
    let Some((mut stream, session)) = session(target) else {
        return;
    };
    let id = format!("\"{}\"", "i".repeat(LONG));
    let text = "command X () let finish a when true; tel";
    for _ in 0..30 {
        let load = load_request(&id, &session, text);
        if over.load(Ordering::Relaxed) || writeln!(stream, "{load}").is_err() {
            return;
        }
    }
}

/// Schedules a command after any of many results of another one, or after one with a long name.
pub(crate) fn many_results(target: &Target, number: u64, _: &AtomicBool) {
    let text = "command X () let finish a when cancel; tel";
    let Some((mut stream, command)) = loaded(target, text) else {
        return;
    };
    let (after, count) = match number {
        0 => (command.clone(), 1 << 16),
        _ => ("n".repeat(LONG), 256),
    };
    let results = vec!["\"a\""; count].join(",");
    let request = format!(
        "{{\"jsonrpc\":\"2.0\",\"id\":3,\"method\":\"command.schedule\",\"params\":{{\"command\":\"{command}\",\"after\":\"{after}\",\"results\":[{results}]}}}}"
    );
    answer_of(&mut stream, &request);
}

/// Requests the text of a large command many times, and reads nothing.
pub(crate) fn large_pages(target: &Target, _: u64, over: &AtomicBool) {
    let comment = "-- x\n".repeat(LONG / 10);
    let text = format!("{comment}command X () let finish a when cancel; tel");
    let Some((_stream, command)) = loaded(target, &text) else {
        return;
    };
    let request = format!("GET /nets/{command}/dio HTTP/1.1\r\nHost: localhost\r\n\r\n");
    while !over.load(Ordering::Relaxed) {
        let _held: Vec<_> = (0..20).map(|_| sent(target, request.as_bytes())).collect();
        thread::sleep(Duration::from_millis(200));
    }
}

/// Requests the description of a command with many values many times, and reads nothing.
pub(crate) fn large_descriptions(target: &Target, _: u64, over: &AtomicBool) {
    let text = "command X ()\nvar many: real^200000;\nlet\nmany = 1.5^200000 -> pre many;\nexport many;\nfinish a when cancel;\ntel";
    let Some((_stream, command)) = loaded(target, text) else {
        return;
    };
    let describe = format!(
        "{{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"command.describe\",\"params\":{{\"command\":\"{command}\"}}}}"
    );
    while !over.load(Ordering::Relaxed) {
        let held: Vec<_> = (0..15).filter_map(|_| line(target)).collect();
        for mut stream in &held {
            let _ = writeln!(stream, "{describe}");
        }
        thread::sleep(Duration::from_millis(200));
    }
}

pub(crate) fn large_texts(target: &Target, _: u64, over: &AtomicBool) {
    let comment = "-- x\n".repeat(LONG / 6);
    load(
        target,
        &format!("{comment}command X () let finish a when true; tel"),
        8,
        over,
    );
}

/// Loads a program whose values double with each line.
pub(crate) fn doubling_programs(target: &Target, _: u64, over: &AtomicBool) {
    let lines: String = (1..60)
        .map(|n| format!("a{n} = (a{}, a{});\n", n - 1, n - 1))
        .collect();
    let text = format!("command X ()\nlet\na0 = (1.0, 1.0);\n{lines}finish a when true; tel");
    load(target, &text, 2, over);
}

/// Loads programs with large arrays, whose images are large.
pub(crate) fn large_images(target: &Target, number: u64, over: &AtomicBool) {
    let size = 50_000 + number;
    let text = format!(
        "command X ()\nvar line: real^{size};\nlet\nline = 1.5^{size} -> pre line;\nfinish a when line[0] > 2.0;\ntel"
    );
    load(target, &text, 30, over);
}
