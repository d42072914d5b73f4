//! Bad clients of every kind.

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::os::unix::net::UnixStream;
use std::thread;
use std::time::Duration;

use crate::client::{Client, http};
use crate::{Scene, TOKEN};

/// Behaviour of a bad client.
pub(crate) type BadClient = fn(&Scene, &mut Random);

/// All kinds of bad clients.
pub(crate) const BAD_CLIENTS: &[BadClient] = &[
    half_a_head,
    no_http,
    a_body_that_never_comes,
    chunks_that_lie,
    two_lengths,
    a_large_form,
    frames_that_mean_nothing,
    half_a_large_message,
    many_values,
    wrong_tokens,
    killed_while_loading,
    a_thief,
    a_flood_unheard,
    a_flood_with_answers,
    pages_and_devices,
    a_large_net,
    a_deaf_listener,
    bad_lines,
    an_endless_line,
    killed_somewhere,
];

/// Pseudo-random number generator (Marsaglia 2003, xorshift64).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    pub(crate) fn below(&mut self, most: usize) -> usize {
        (self.next() % most as u64) as usize
    }
}

const AUTHORIZED: &str = "Authorization: Bearer a-secret\r\n";

pub(crate) fn dio(scene: &Scene) -> Client {
    Client::at(scene.address, &path("/DirectIO/"))
}

pub(crate) fn rpc(scene: &Scene) -> Client {
    Client::at(scene.address, &path("/rpc"))
}

fn path(page: &str) -> String {
    format!("{page}?token={TOKEN}")
}

fn raw(at: SocketAddr, bytes: &[u8]) {
    if let Ok(mut stream) = TcpStream::connect(at) {
        let _ = stream.write_all(bytes);
    }
}

fn half_a_head(scene: &Scene, random: &mut Random) {
    let head = b"GET /DirectIO/ HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\n";
    raw(scene.address, &head[..random.below(head.len())]);
}

fn no_http(scene: &Scene, random: &mut Random) {
    let bytes: Vec<u8> = (0..5000).map(|_| random.next() as u8).collect();
    raw(scene.address, &bytes);
}

fn a_body_that_never_comes(scene: &Scene, _: &mut Random) {
    let head = format!(
        "POST /eval HTTP/1.1\r\nHost: localhost\r\n{AUTHORIZED}Content-Length: 1000000\r\n\r\ndio"
    );
    raw(scene.address, head.as_bytes());
}

/// Sends chunks without an end, with a wrong length, and with a length that no machine can hold.
fn chunks_that_lie(scene: &Scene, random: &mut Random) {
    let chunks = [
        "1\r\nx\r\n".repeat(10_000),
        "3\r\nabcd\r\n0\r\n\r\n".to_owned(),
        "fffffffffffffff\r\nx".to_owned(),
        format!("1;{}", "x".repeat(10_000)),
    ];
    let chunks = &chunks[random.below(chunks.len())];
    let head = "POST /eval HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n";
    raw(
        scene.address,
        format!("{head}{AUTHORIZED}\r\n{chunks}").as_bytes(),
    );
}

fn two_lengths(scene: &Scene, _: &mut Random) {
    let head =
        "POST /eval HTTP/1.1\r\nHost: localhost\r\nContent-Length: 0\r\nContent-Length: 40\r\n";
    let hidden = "GET /sessions HTTP/1.1\r\nHost: localhost\r\n\r\n";
    let answer = http(scene.address, &format!("{head}{AUTHORIZED}\r\n{hidden}"));
    assert!(answer.starts_with("HTTP/1.1 400"), "{answer}");
}

fn a_large_form(scene: &Scene, _: &mut Random) {
    let fields: String = (0..100_000).map(|n| format!("{n}=x&")).collect();
    let length = fields.len();
    let head = format!("POST /eval HTTP/1.1\r\nHost: localhost\r\n{AUTHORIZED}");
    http(
        scene.address,
        &format!("{head}Content-Length: {length}\r\n\r\n{fields}"),
    );
}

/// Sends the first fragment of a message of 1 MiB and pings, and no further fragment.
fn half_a_large_message(scene: &Scene, _: &mut Random) {
    let mut client = rpc(scene);
    let socket = client.socket_mut().get_mut();
    let _ = socket.write_all(b"\x01\x7f\x00\x00\x00\x00\x00\x10\x00\x00");
    let _ = socket.write_all(&vec![b' '; 1 << 20]);
    let _ = socket.write_all(&b"\x89\x00".repeat(100));
    thread::sleep(Duration::from_millis(20));
}

/// Sends messages whose values take far more memory than their text.
fn many_values(scene: &Scene, random: &mut Random) {
    let objects = "{\"\":1},".repeat(20_000);
    if random.below(2) == 0 {
        let mut client = rpc(scene);
        client.send(&format!(
            "{{\"id\":1,\"method\":\"ping\",\"params\":[{objects}1]}}"
        ));
        client.listen(Duration::from_millis(20));
    } else {
        let mut client = dio(scene);
        client.send(&format!("x=ver([{}1])", "1,".repeat(1_000_000)));
        client.wait("the error", |text| text.starts_with("x=err").then_some(()));
    }
}

/// Sends a frame of 1 GiB, half a message, reserved bits and invalid UTF-8.
fn frames_that_mean_nothing(scene: &Scene, random: &mut Random) {
    let frames: [&[u8]; 4] = [
        &[0x81, 0x7f, 0, 0, 0, 0, 0x40, 0, 0, 0, b'x'],
        b"\x81\x20c0=ver(",
        &[0xf7, 0x05, 1, 2, 3, 4, 5],
        &[0x81, 0x04, 0xff, 0xfe, 0xc0, 0x80],
    ];
    let Ok(mut stream) = TcpStream::connect(scene.address) else {
        return;
    };
    let head = format!(
        "GET /rpc HTTP/1.1\r\nHost: localhost\r\n{AUTHORIZED}Upgrade: websocket\r\nSec-WebSocket-Key: x\r\n\r\n"
    );
    let _ = stream.write_all(head.as_bytes());
    let _ = stream.write_all(frames[random.below(frames.len())]);
    thread::sleep(Duration::from_millis(5));
}

fn wrong_tokens(scene: &Scene, random: &mut Random) {
    let shown = [
        "",
        "Authorization: Bearer a-secre\r\n",
        "Authorization: Basic a-secret\r\n",
    ];
    let shown = shown[random.below(shown.len())];
    http(
        scene.address,
        &format!("GET /rpc HTTP/1.1\r\nHost: localhost\r\n{shown}Upgrade: websocket\r\n\r\n"),
    );
}

fn session(client: &mut Client) -> String {
    client.ask("nse(\"rogue\")").unwrap_or_default()
}

const HOLD: &str = "{m=RobotArm::JointMonitor(Robot='arm',Axis='5'),\
    a=RobotArm::JointPosition(inPosition=m.outCommandedPosition,Robot='arm',Axis='5')}";

fn killed_while_loading(scene: &Scene, random: &mut Random) {
    let mut client = dio(scene);
    let session = session(&mut client);
    for tag in 0..random.below(40) {
        client.send(&format!("x{tag}=nene(\"{HOLD}\",\"{session}\",\"\",0,1)"));
    }
}

/// Loads a net whose actuator is held, and starts and stops unknown commands.
fn a_thief(scene: &Scene, _: &mut Random) {
    let mut client = dio(scene);
    let session = session(&mut client);
    let net = client.load(&session, HOLD);
    let _ = client.ask(&format!("nest(\"{net}\")"));
    for number in 0..40 {
        client.send(&format!("t=nest(\"n{number}x\")"));
    }
    client.listen(Duration::from_millis(20));
}

fn a_flood_unheard(scene: &Scene, _: &mut Random) {
    let mut client = dio(scene);
    (0..10_000).for_each(|_| client.send("f=gde()"));
}

/// Sends ten thousand messages that are all answered.
fn a_flood_with_answers(scene: &Scene, _: &mut Random) {
    let mut client = dio(scene);
    for _ in 0..100 {
        (0..100).for_each(|_| client.send("f=ver(\"2.0\")"));
        (0..100).for_each(|_| client.wait("ver", |text| (text == "f=ok(\"2.0\")").then_some(())));
    }
}

fn pages_and_devices(scene: &Scene, random: &mut Random) {
    let name = random.below(3);
    let post = |page: &str, body: &str| {
        let length = body.len();
        let head = format!("POST {page} HTTP/1.1\r\nHost: localhost\r\n{AUTHORIZED}");
        http(
            scene.address,
            &format!("{head}Content-Length: {length}\r\n\r\n{body}"),
        )
    };
    post("/eval", "dionet=%7B%7D");
    post("/devices", &format!("name=d {name}&type=kuka_lwr_sim"));
    post("/devices", &format!("name=d {name}&action=remove"));
    crate::page(scene, "/modules");
}

/// Loads a net of two megabytes, starts and unloads it, or leaves it behind.
fn a_large_net(scene: &Scene, random: &mut Random) {
    let net = long(20_000);
    assert!(net.len() > 1_500_000);
    let mut client = dio(scene);
    let session = session(&mut client);
    if random.below(2) == 0 {
        client.send(&format!("x=nene(\"{net}\",\"{session}\",\"\",0,1)"));
        return;
    }
    let net = client.load(&session, &net);
    client.ask(&format!("nest(\"{net}\")")).unwrap();
    client.ask(&format!("neab(\"{net}\")")).unwrap();
    client.ask(&format!("neun(\"{net}\")")).unwrap();
}

/// Returns a net with this many additions in a row.
fn long(additions: usize) -> String {
    rpi_testkit::net_of_additions(additions, "1.000000000000000000000000000001")
}

/// Subscribes to every command with a period of one tick and reads nothing.
fn a_deaf_listener(scene: &Scene, _: &mut Random) {
    let mut client = dio(scene);
    (1..200).for_each(|n| client.send(&format!("w{n}=gne(\"n{n}\",0.001)")));
    thread::sleep(Duration::from_millis(300));
}

/// Sends lines with invalid UTF-8, invalid JSON, invalid requests, deep nesting, and half a line.
fn bad_lines(scene: &Scene, _: &mut Random) {
    let Ok(mut stream) = UnixStream::connect(&scene.socket) else {
        return;
    };
    let deep = [b"[".repeat(100_000), b"\n".to_vec()].concat();
    let lines: [&[u8]; 6] = [
        &[0xff, 0xfe, 0xc0, b'\n'],
        b"{\"id\":1,\"method\":[]}\n",
        b"[1,2,3,null]\n",
        b"{\"id\":{},\"method\":\"command.load\",\"params\":7}\n",
        &deep,
        b"{\"id\":1,\"meth",
    ];
    for line in lines {
        let _ = stream.write_all(line);
    }
    thread::sleep(Duration::from_millis(5));
}

/// Sends a line beyond the maximum message size. The server must disconnect.
fn an_endless_line(scene: &Scene, _: &mut Random) {
    let Ok(mut stream) = UnixStream::connect(&scene.socket) else {
        return;
    };
    let piece = vec![b' '; 1 << 20];
    while stream.write_all(&piece).is_ok() {}
    let _ = stream.read(&mut [0]);
}

/// Disconnects at a random point of a valid session.
fn killed_somewhere(scene: &Scene, random: &mut Random) {
    let mut client = rpc(scene);
    let program = "command W () let finish done when time >= 1[s]; tel";
    let requests = [
        "{\"id\":1,\"method\":\"session.open\",\"params\":{\"on_loss\":\"run-on\"}}".to_owned(),
        format!(
            "{{\"id\":2,\"method\":\"command.load\",\"params\":{{\"session\":\"s0\",\"text\":\"{program}\"}}}}"
        ),
        "{\"id\":3,\"method\":\"watch.devices\",\"params\":{}}".to_owned(),
        "{\"id\":4,\"method\":\"commands\",\"params\":{}}".to_owned(),
        "{\"id\":5,\"method\":\"rule.make\",\"params\":{\"when\":\"t\"}}".to_owned(),
    ];
    for request in &requests[..random.below(requests.len() + 1)] {
        client.send(request);
    }
    thread::sleep(Duration::from_millis(random.below(5) as u64));
}
