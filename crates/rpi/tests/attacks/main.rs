//! Attacks of clients on `rpi serve` as a process of its own: under each of them, a new client stops everything, no request
//! of it stays unanswered, and the memory of the server stays within its limit.
//!
//! Each attack takes a second, or the number of seconds in `RPI_CHAOS`. The cycle under attacks is the subject of the test
//! `chaos` of `rpi-serve`.
#![cfg(target_os = "linux")]

mod connection;
mod kinds;
mod loads;

use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use connection::{Target, line_answer, websocket_answer};
use kinds::ATTACKS;

/// Time until an answer must have arrived.
const TIMEOUT: Duration = Duration::from_secs(30);
/// Maximum growth of the resident memory of the server in kB: 300 MB.
const MAX_GROWTH: u64 = 300_000;
/// Number of clients of an attack.
const ATTACKERS: u64 = 3;
/// Time between two emergency stops.
const INTERVAL: Duration = Duration::from_millis(20);
/// Time within which an emergency stop of a new client should be answered.
const BAR: Duration = Duration::from_millis(100);

/// Running server, ended by the end of the test.
struct Server {
    child: Child,
    target: Target,
    _folder: tempfile::TempDir,
}

impl Server {
    fn start() -> Server {
        let folder = tempfile::tempdir().unwrap();
        let socket = folder.path().join("rpi.sock");
        let cell = folder.path().join("cell.toml");
        let text = "[devices.arm]\nkind = \"arm\"\nmodel = \"kuka-lwr4+\"\n";
        std::fs::write(&cell, text).unwrap();
        let mut child = Command::new(env!("CARGO_BIN_EXE_rpi"))
            .args(["serve", "--listen", "127.0.0.1:0", "--socket"])
            .arg(&socket)
            .arg("--cell")
            .arg(&cell)
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
        let address = lines.by_ref().map_while(Result::ok).find_map(|line| {
            let (_, address) = line.split_once("serving at ws://")?;
            address.split_whitespace().next()?.parse().ok()
        });
        // What the server reports later must not fill its pipe.
        thread::spawn(move || lines.for_each(drop));
        let address = address.expect("an address");
        Server {
            child,
            target: Target { address, socket },
            _folder: folder,
        }
    }

    /// Returns the resident memory of the server in kB, without its workers.
    fn resident_kb(&self) -> u64 {
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.child.id())).unwrap();
        let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
        let number = line.and_then(|line| line.split_whitespace().next());
        number.expect("the server runs").parse().unwrap()
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        // Both fail only if the server has ended.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Ends an attack when it is dropped, after a failed check, too: the test waits for its attackers.
struct EndOfAttack<'a>(&'a AtomicBool);

impl Drop for EndOfAttack<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

fn seconds() -> f64 {
    let long = std::env::var("RPI_CHAOS").ok();
    long.map_or(1.0, |text| text.parse().expect("a number of seconds"))
}

#[test]
fn a_new_client_stops_everything_under_each_attack() {
    let server = Server::start();
    let start = server.resident_kb();
    for (name, attack) in ATTACKS {
        let (over, rounds) = (AtomicBool::new(false), AtomicU64::new(0));
        let (mut times, peak) = thread::scope(|scope| {
            for attacker in 0..ATTACKERS {
                let (over, rounds, target) = (&over, &rounds, &server.target);
                scope.spawn(move || {
                    while !over.load(Ordering::Relaxed) {
                        attack(target, attacker, over);
                        rounds.fetch_add(1, Ordering::Relaxed);
                    }
                });
            }
            let _end = EndOfAttack(&over);
            stops(&server)
        });
        times.sort();
        let p99 = times[(times.len() - 1) * 99 / 100];
        let growth = peak.saturating_sub(start);
        println!(
            "{name}: {} stops, p99 {:.1} ms ({} {} ms), at most {:.1} ms; {} rounds, memory {start} kB + {growth} kB",
            times.len(),
            p99.as_secs_f64() * 1e3,
            if p99 <= BAR { "within" } else { "BEYOND" },
            BAR.as_millis(),
            times[times.len() - 1].as_secs_f64() * 1e3,
            rounds.load(Ordering::Relaxed),
        );
        assert!(
            growth <= MAX_GROWTH,
            "{name}: the memory grows by {growth} kB"
        );
    }
}

/// Requests emergency stops as new clients, at the Unix socket and over the network in turn. Returns the time of each, and
/// the largest resident memory of the server in kB.
fn stops(server: &Server) -> (Vec<Duration>, u64) {
    let begin = Instant::now();
    let (mut times, mut peak) = (Vec::new(), server.resident_kb());
    while begin.elapsed().as_secs_f64() < seconds() || times.len() < 10 {
        let requested = Instant::now();
        let ask = |method: &str| match times.len() % 2 {
            0 => line_answer(&server.target, method, TIMEOUT),
            _ => websocket_answer(&server.target, method, TIMEOUT),
        };
        let answer = ask("emergency.stop");
        times.push(requested.elapsed());
        assert!(answer.contains("\"result\""), "{answer}");
        // The stop is in force; the attack goes on with what it may still do, and with everything after the reset.
        let _ = line_answer(&server.target, "emergency.reset", TIMEOUT);
        peak = peak.max(server.resident_kb());
        thread::sleep(INTERVAL);
    }
    (times, peak)
}
