//! The attacks: the table of all, and those that load nothing.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use crate::connection::{Target, frame, line, request, sent, websocket};
use crate::loads;

/// One round of an attack by the client with this number. An attack that lasts ends when the flag is set.
pub(crate) type Attack = fn(&Target, u64, &AtomicBool);

/// All attacks with their names.
pub(crate) const ATTACKS: &[(&str, Attack)] = &[
    ("nothing", |_, _, _| {
        thread::sleep(Duration::from_millis(10))
    }),
    ("silent connections", silent_connections),
    ("slow heads", slow_heads),
    ("half bodies", half_bodies),
    ("small chunks", small_chunks),
    ("large forms", large_forms),
    ("half websocket messages", half_messages),
    ("half lines", half_lines),
    ("pings within a message", pings),
    ("batches of numbers", batches_of_numbers),
    ("small objects", small_objects),
    ("large DirectIO messages", large_messages),
    ("batches of requests", batches_of_requests),
    ("clients that do not read", deaf_clients),
    ("pages", pages),
    ("evaluations", evaluations),
    ("large texts", loads::large_texts),
    ("programs that double", loads::doubling_programs),
    ("large images", loads::large_images),
    ("subscriptions with long tags", long_tags),
    ("requests with long ids", loads::long_ids),
    ("successors of many results", loads::many_results),
    ("literals of many elements", many_elements),
    ("large pages", loads::large_pages),
    ("large descriptions", loads::large_descriptions),
    ("idle clients after a large message", idle_clients),
    ("heads of large frames", frame_heads),
];

/// Length of a message just within the limit.
pub(crate) const LONG: usize = 15 << 20;

fn silent_connections(target: &Target, _: u64, over: &AtomicBool) {
    let held: Vec<_> = (0..20).map(|_| sent(target, b"G")).collect();
    thread::sleep(Duration::from_millis(20));
    if over.load(Ordering::Relaxed) {
        drop(held);
    }
}

fn slow_heads(target: &Target, _: u64, over: &AtomicBool) {
    let mut held: Vec<_> = (0..12)
        .filter_map(|_| sent(target, b"GET / HTTP/1.1\r\n"))
        .collect();
    for _ in 0..20 {
        held.retain_mut(|stream| stream.write_all(b"X: y\r\n").is_ok());
        if over.load(Ordering::Relaxed) {
            return;
        }
        thread::sleep(Duration::from_millis(10));
    }
}

fn half_bodies(target: &Target, _: u64, over: &AtomicBool) {
    let head = "POST /eval HTTP/1.1\r\nHost: localhost\r\nContent-Length: 16000000\r\n\r\n";
    let request = [head.as_bytes(), &vec![b'x'; LONG]].concat();
    let _held: Vec<_> = (0..15).map(|_| sent(target, &request)).collect();
    if over.load(Ordering::Relaxed) {
        return;
    }
    thread::sleep(Duration::from_millis(200));
}

fn small_chunks(target: &Target, _: u64, _: &AtomicBool) {
    let head = "POST /eval HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\n";
    let request = [head.as_bytes(), &b"1\r\nx\r\n".repeat(1 << 20)].concat();
    sent(target, &request);
}

fn large_forms(target: &Target, _: u64, _: &AtomicBool) {
    let fields: String = (0..1_000_000)
        .map(|number| format!("{number}=x&"))
        .collect();
    let length = fields.len();
    let head =
        format!("POST /eval HTTP/1.1\r\nHost: localhost\r\nContent-Length: {length}\r\n\r\n");
    answered(sent(target, &[head.as_bytes(), fields.as_bytes()].concat()));
}

/// Reads an answer to its end.
fn answered(stream: Option<TcpStream>) {
    if let Some(mut stream) = stream {
        let _ = stream.read_to_end(&mut Vec::new());
    }
}

fn half_messages(target: &Target, number: u64, over: &AtomicBool) {
    let path = if number == 0 { "/DirectIO" } else { "/rpc" };
    let half = [
        &[0x01, 127],
        &(LONG as u64).to_be_bytes()[..],
        &vec![b' '; LONG],
    ]
    .concat();
    let held: Vec<_> = (0..15).filter_map(|_| websocket(target, path)).collect();
    for mut stream in &held {
        let _ = stream.set_write_timeout(Some(Duration::from_secs(2)));
        let _ = stream.write_all(&half);
    }
    if !over.load(Ordering::Relaxed) {
        thread::sleep(Duration::from_millis(200));
    }
}

fn half_lines(target: &Target, _: u64, over: &AtomicBool) {
    let held: Vec<_> = (0..18).filter_map(|_| line(target)).collect();
    for mut stream in &held {
        let _ = stream.write_all(&vec![b' '; LONG]);
    }
    if !over.load(Ordering::Relaxed) {
        thread::sleep(Duration::from_millis(200));
    }
}

/// Sends parts of a message and many pings between them.
fn pings(target: &Target, _: u64, over: &AtomicBool) {
    let Some(mut stream) = websocket(target, "/rpc") else {
        return;
    };
    let _ = stream.set_write_timeout(Some(Duration::from_secs(2)));
    let part = [&[0x01, 126, 0xff, 0xff], &[b' '; 0xffff][..]].concat();
    let next = [&[0x00, 126, 0xff, 0xff], &[b' '; 0xffff][..]].concat();
    let mut sent = stream.write_all(&part);
    while sent.is_ok() && !over.load(Ordering::Relaxed) {
        sent = stream
            .write_all(&b"\x89\x00".repeat(1000))
            .and_then(|()| stream.write_all(&next));
    }
}

/// Sends a line and waits for an answer.
fn ask_line(target: &Target, text: &str) {
    if let Some(mut stream) = line(target) {
        let _ = writeln!(stream, "{text}");
        let _ = stream.read(&mut [0; 1 << 16]);
    }
}

fn batches_of_numbers(target: &Target, _: u64, _: &AtomicBool) {
    ask_line(target, &format!("[{}1]", "1,".repeat(LONG / 2)));
}

/// Sends as many objects as a message may have. Each takes far more memory than its text.
fn small_objects(target: &Target, _: u64, _: &AtomicBool) {
    let objects = "{\"\":1},".repeat((1 << 17) / 3 - 10);
    let text = format!("{{\"id\":1,\"method\":\"ping\",\"params\":[{objects}1]}}");
    ask_line(target, &text);
}

fn large_messages(target: &Target, number: u64, _: &AtomicBool) {
    let Some(mut stream) = websocket(target, "/DirectIO") else {
        return;
    };
    let _ = stream.set_write_timeout(Some(Duration::from_secs(2)));
    let values = match number {
        0 => "1,".repeat(LONG / 2),
        1 => "[],".repeat(1 << 15),
        _ => "{},".repeat(1 << 15),
    };
    let _ = stream.write_all(&frame(format!("x=ver([{values}1])").as_bytes()));
    let _ = stream.read(&mut [0; 100]);
}

fn batches_of_requests(target: &Target, _: u64, _: &AtomicBool) {
    let batch = vec![request("commands"); 1000].join(",");
    ask_line(target, &format!("[{batch}]"));
}

/// Requests as much as possible and reads nothing.
fn deaf_clients(target: &Target, _: u64, over: &AtomicBool) {
    let batch = vec![request("session.describe"); 1000].join(",");
    let held: Vec<_> = (0..15).filter_map(|_| line(target)).collect();
    for _ in 0..20 {
        for mut stream in &held {
            let _ = stream.set_write_timeout(Some(Duration::from_millis(20)));
            let _ = writeln!(stream, "[{batch}]");
        }
        if over.load(Ordering::Relaxed) {
            return;
        }
    }
}

fn pages(target: &Target, number: u64, _: &AtomicBool) {
    let page = ["/modules", "/metrics", "/log"][number as usize % 3];
    let request = format!("GET {page} HTTP/1.1\r\nHost: localhost\r\n\r\n");
    answered(sent(target, request.as_bytes()));
}

fn evaluations(target: &Target, _: u64, _: &AtomicBool) {
    let body = "dionet=%7Ba%3DCore%3A%3ADoubleValue%28Value%3D%271%27%29%7D";
    let length = body.len();
    let head =
        format!("POST /eval HTTP/1.1\r\nHost: localhost\r\nContent-Length: {length}\r\n\r\n");
    answered(sent(target, format!("{head}{body}").as_bytes()));
}

/// Subscribes to the devices over DirectIO many times; each answer repeats the tag.
fn long_tags(target: &Target, _: u64, over: &AtomicBool) {
    let Some(mut stream) = websocket(target, "/DirectIO") else {
        return;
    };
    let _ = stream.set_write_timeout(Some(Duration::from_secs(2)));
    let request = frame(format!("{}=gde()", "t".repeat(1 << 22)).as_bytes());
    let mut reader = stream.try_clone().ok();
    for _ in 0..100 {
        if over.load(Ordering::Relaxed) || stream.write_all(&request).is_err() {
            return;
        }
        let _ = reader.as_mut().map(|reader| reader.read(&mut [0; 1 << 16]));
    }
}

/// Adds a device with a list of many numbers.
fn many_elements(target: &Target, _: u64, _: &AtomicBool) {
    let list = "1,".repeat(LONG / 2);
    ask_line(
        target,
        &format!(
            "{{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"device.add\",\"params\":{{\"name\":\"a\",\"type\":\"kuka_lwr_sim\",\"parameters\":{{\"link_lengths\":\"[{list}1]\"}}}}}}"
        ),
    );
}

/// Sends a large message as each of many clients, one after the other, which then stay connected.
fn idle_clients(target: &Target, _: u64, over: &AtomicBool) {
    let spaces = " ".repeat(LONG);
    let message = frame(format!("{}{spaces}", request("ping")).as_bytes());
    let mut held = Vec::new();
    for _ in 0..15 {
        let Some(mut stream) = websocket(target, "/rpc") else {
            break;
        };
        let _ = stream.set_write_timeout(Some(Duration::from_secs(2)));
        let _ = stream.set_read_timeout(Some(Duration::from_secs(2)));
        let _ = stream.write_all(&message);
        let _ = stream.read(&mut [0; 100]);
        held.push(stream);
        if over.load(Ordering::Relaxed) {
            break;
        }
    }
}

/// Announces a large frame as each of many clients, and sends nothing more.
fn frame_heads(target: &Target, _: u64, over: &AtomicBool) {
    let head = [&[0x81, 127], &(LONG as u64).to_be_bytes()[..]].concat();
    let mut held: Vec<_> = (0..15).filter_map(|_| websocket(target, "/rpc")).collect();
    held.retain_mut(|stream| stream.write_all(&head).is_ok());
    if !over.load(Ordering::Relaxed) {
        thread::sleep(Duration::from_millis(200));
    }
}
