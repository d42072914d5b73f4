//! Whatever clients do, what runs is not disturbed: its set-points are the same bits as without them.

use std::io::Write;
use std::net::{SocketAddr, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use rpi_core::{Command, CommandId, Watch};
use rpi_serve::{Limits, Server, Settings};
use tungstenite::Message;

use crate::client::{Client, PATIENCE, get, post, server, settings};
use crate::nets::{ECHO, hold, long, swing};

/// Cycles that are compared.
const CYCLES: usize = 3000;

/// Notes the set-points of the one command that exports `probe`.
#[derive(Clone)]
struct Tap {
    bits: Arc<[AtomicU64]>,
    count: Arc<AtomicUsize>,
}

impl Tap {
    fn new() -> Tap {
        Tap {
            bits: (0..CYCLES).map(|_| AtomicU64::new(0)).collect(),
            count: Arc::default(),
        }
    }

    fn wait(&self) -> Vec<u64> {
        let begin = Instant::now();
        while self.count.load(Ordering::Acquire) < CYCLES {
            assert!(begin.elapsed() < PATIENCE, "the command does not get on");
            thread::sleep(Duration::from_millis(5));
        }
        self.bits
            .iter()
            .map(|b| b.load(Ordering::Relaxed))
            .collect()
    }
}

impl Watch for Tap {
    fn cycle(&mut self, _: CommandId, command: &Command) {
        let machine = command.machine();
        let probe = machine.image().exports.iter().find(|e| e.key == "probe");
        let Some(value) = probe.and_then(|export| machine.value(export.value)) else {
            return;
        };
        let at = self.count.load(Ordering::Relaxed);
        if let Some(cell) = self.bits.get(at) {
            cell.store(value[0], Ordering::Relaxed);
            self.count.store(at + 1, Ordering::Release);
        }
    }
}

/// Starts the command that is not to be disturbed.
fn start(server: &Server) -> Client {
    let mut owner = Client::dio(server.address());
    let session = owner.ask("nse(\"owner\")").unwrap();
    let net = owner.load(&session, &swing(3, 1e9));
    owner.ask(&format!("nest(\"{net}\")")).unwrap();
    owner
}

/// One bad client after the other, until told to stop.
const TROUBLES: &[fn(SocketAddr)] = &[
    // Half a head, and gone.
    |at| raw(at, b"GET /DirectIO/ HTTP/1.1\r\nUpgr"),
    // No HTTP at all.
    |at| raw(at, &[0xff; 5000]),
    // A length that is never filled.
    |at| {
        raw(
            at,
            b"POST /eval HTTP/1.1\r\nContent-Length: 1000000\r\n\r\ndio",
        )
    },
    // A frame that announces 1 GiB.
    |at| frame(at, &[0x81, 0x7f, 0, 0, 0, 0, 0x40, 0, 0, 0, b'x']),
    // Half a message.
    |at| frame(at, b"\x81\x20c0=ver("),
    // Bits that mean nothing.
    |at| frame(at, &[0xf7, 0x05, 1, 2, 3, 4, 5]),
    // Killed in the middle of loading and running.
    |at| {
        let mut client = Client::dio(at);
        let session = client.ask("nse(\"killed\")").unwrap_or_default();
        client.send(&format!("x=nene(\"{}\",\"{session}\",\"\",0,1)", hold(5)));
        client.send(&format!("y=nene(\"{ECHO}\",\"{session}\",\"\",0,1)"));
    },
    // Takes what is held, stops what is not its own.
    |at| {
        let mut client = Client::dio(at);
        if let Ok(session) = client.ask("nse(\"thief\")") {
            let _ = client.ask(&format!(
                "nene(\"{}\",\"{session}\",\"\",0,1)",
                swing(3, 1.0)
            ));
        }
        for number in 0..40 {
            client.send(&format!("t=nest(\"n{number}x\")"));
        }
        client.listen(Duration::from_millis(20));
    },
    // Ten thousand messages, and never listens.
    |at| {
        let mut client = Client::dio(at);
        for _ in 0..10_000 {
            client.send("f=gde()");
        }
    },
    // Evaluates, makes and removes devices.
    |at| {
        post(at, "/eval", "dionet=%7B%7D");
        post(at, "/devices", "name=a b&type=kuka_lwr_sim");
        post(at, "/devices", "name=a b&action=remove");
        get(at, "/modules");
    },
];

fn raw(at: SocketAddr, bytes: &[u8]) {
    if let Ok(mut stream) = TcpStream::connect(at) {
        let _ = stream.write_all(bytes);
    }
}

fn frame(at: SocketAddr, bytes: &[u8]) {
    if let Ok(mut stream) = TcpStream::connect(at) {
        let head = b"GET /DirectIO/ HTTP/1.1\r\nUpgrade: websocket\r\nSec-WebSocket-Key: x\r\n\r\n";
        let _ = stream
            .write_all(head)
            .and_then(|()| stream.write_all(bytes));
        thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn set_points_are_the_same_bits_with_and_without_clients() {
    let quiet = Tap::new();
    let server_alone = server(&settings(), quiet.clone());
    let owner = start(&server_alone);
    let alone = quiet.wait();
    drop((owner, server_alone));

    let tap = Tap::new();
    let crowded = server(&settings(), tap.clone());
    let address = crowded.address();
    let owner = start(&crowded);
    let big = thread::spawn(move || {
        let mut client = Client::dio(address);
        let session = client.ask("nse(\"big\")").unwrap();
        let net = long(20_000);
        assert!(net.len() > 1_500_000);
        client.load(&session, &net)
    });
    let mut round = 0;
    while tap.count.load(Ordering::Acquire) < CYCLES {
        let trouble = TROUBLES[round % TROUBLES.len()];
        // A client that is thrown out in the middle may fail itself.
        let _ = thread::spawn(move || trouble(address)).join();
        round += 1;
    }
    assert!(round >= TROUBLES.len(), "only {round} troubles");
    assert!(big.join().unwrap().starts_with('n'));
    assert_eq!(tap.wait(), alone);
    drop(owner);
}

#[test]
fn a_client_that_does_not_read_is_given_up() {
    let limits = Limits {
        patience: Duration::from_millis(500),
        ..Limits::default()
    };
    let server = server(
        &Settings {
            limits,
            ..settings()
        },
        (),
    );
    let mut deaf = Client::dio(server.address());
    let session = deaf.ask("nse(\"deaf\")").unwrap();
    let net = deaf.load(&session, &swing(0, 1e9));
    deaf.ask(&format!("nest(\"{net}\")")).unwrap();
    let begin = Instant::now();
    // Its session's commands are cancelled once it is given up; an oscillation that never ends sees that as `cancel`.
    while !get(server.address(), "/nets").contains("Cancelling") {
        assert!(begin.elapsed() < PATIENCE, "it is still listened to");
        for _ in 0..1000 {
            deaf.push("f=gde()");
        }
    }
    let mut other = Client::dio(server.address());
    assert!(other.ask("ver(\"2.0\")").is_ok());
}

impl Client {
    /// Sends without caring whether it arrives.
    fn push(&mut self, text: &str) {
        let _ = self.socket_mut().send(Message::text(text));
    }
}
