//! Places of connections: who stays silent or fills all places keeps nobody from an emergency stop.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use rpi_serve::{Limits, PlaceLimits, Settings, SocketSettings};
use serde_json::{Value, json};

use crate::client::{Client, PATIENCE, server, settings};
use crate::native::call;

/// Number of new clients that try to stop everything under an attack.
const TRIES: usize = 40;

/// Keeps connections open that send one byte and no more, and opens new ones for those that the server closes.
fn hold_silent(address: SocketAddr, over: &AtomicBool) {
    let mut held: Vec<TcpStream> = Vec::new();
    while !over.load(Ordering::Relaxed) {
        held.retain_mut(|stream| {
            let end = stream.read(&mut [0]);
            end.is_err_and(|why| why.kind() == std::io::ErrorKind::WouldBlock)
        });
        while held.len() < 60 {
            let Ok(mut stream) = TcpStream::connect(address) else {
                break;
            };
            let _ = stream.write_all(b"G");
            let _ = stream.set_nonblocking(true);
            held.push(stream);
        }
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// Stops everything as a new client at the Unix socket. Returns the answer.
fn stop_at_socket(path: &Path) -> Value {
    let mut stream = std::os::unix::net::UnixStream::connect(path).unwrap();
    stream.set_read_timeout(Some(PATIENCE)).unwrap();
    let request = json!({"jsonrpc": "2.0", "id": 1, "method": "emergency.stop"});
    stream.write_all(format!("{request}\n").as_bytes()).unwrap();
    let mut answer = String::new();
    BufReader::new(stream).read_line(&mut answer).unwrap();
    serde_json::from_str(&answer).unwrap()
}

/// Stops everything as a new client over the network. Returns the answer; `None` if the connection was closed for
/// another one before the server had read its request.
fn stop_over_network(address: SocketAddr) -> Option<Value> {
    let attempt = AssertUnwindSafe(|| {
        let mut client = Client::rpc(address);
        call(&mut client, 1, "emergency.stop", &json!({}))
    });
    catch_unwind(attempt).ok()
}

/// Stops everything as new clients over the network and at the socket in turn. Returns the times, longest last.
fn times_of_stops(address: SocketAddr, path: &Path) -> Vec<Duration> {
    let stop = |number: usize| {
        let begin = Instant::now();
        let answer = match number % 2 {
            0 => stop_at_socket(path),
            // The machine of the tests may be so busy that a new connection is the oldest one already.
            _ => (0..10).find_map(|_| stop_over_network(address)).unwrap(),
        };
        assert_eq!(answer["result"], json!({}), "{answer}");
        begin.elapsed()
    };
    let mut times: Vec<Duration> = (0..TRIES).map(stop).collect();
    times.sort();
    println!(
        "an emergency stop of a new client takes {:?} to {:?}",
        times[0],
        times[TRIES - 1]
    );
    times
}

/// Ends an attack when it is dropped, also by a failed assertion.
struct End<'a>(&'a AtomicBool);

impl Drop for End<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

#[test]
fn silent_connections_keep_nobody_out() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rpi.sock");
    let settings = Settings {
        sockets: vec![SocketSettings::new(path.clone())],
        ..settings()
    };
    let server = server(&settings, ());
    let over = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| hold_silent(server.address(), &over));
        let _end = End(&over);
        std::thread::sleep(Duration::from_millis(200));
        let times = times_of_stops(server.address(), &path);
        // The bar is 100 ms on an idle machine; machines that run tests are busy.
        assert!(times[TRIES - 1] < Duration::from_secs(2), "{times:?}");
    });
    let warnings = server.warnings().join("\n");
    assert!(
        warnings.contains("a connection beyond the limit"),
        "{warnings}"
    );
}

#[test]
fn a_place_is_kept_for_an_emergency_stop() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rpi.sock");
    let limits = Limits {
        connections: 8,
        places: PlaceLimits {
            socket: 4,
            emergency: 3,
            ..PlaceLimits::default()
        },
        ..Limits::default()
    };
    let settings = Settings {
        sockets: vec![SocketSettings::new(path.clone())],
        limits,
        ..settings()
    };
    let server = server(&settings, ());
    // Twelve clients each over the network and at the socket: more than there are places, the kept ones included.
    let _network: Vec<Client> = (0..12).map(|_| Client::rpc(server.address())).collect();
    let connect = || std::os::unix::net::UnixStream::connect(&path).unwrap();
    let _sockets: Vec<_> = (0..12).map(|_| connect()).collect();
    // Sockets are accepted in order: after this answer the twelve have got or lost their places.
    stop_at_socket(&path);
    let mut late = Client::rpc(server.address());
    let refused = call(&mut late, 1, "commands", &json!({}));
    assert_eq!(refused["error"]["code"], -32004, "{refused}");
    times_of_stops(server.address(), &path);
    let full = crate::client::get(server.address(), "/nets");
    assert!(full.starts_with("HTTP/1.1 503"), "{full}");
}
