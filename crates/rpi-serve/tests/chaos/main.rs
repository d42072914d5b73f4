//! Robustness against clients: the blending of the paper's Listing 1 runs for ever with the same bits, whatever other
//! clients do. No tick allocates, and nothing of those clients remains at the end.
//!
//! The test runs for a few seconds, or for the number of seconds in `RPI_CHAOS`; `cargo xtask soak` takes an hour.

mod bad_clients;
#[path = "../server/client.rs"]
#[expect(dead_code, reason = "the tests of the server use the rest")]
mod client;
mod digest;
mod fence;
mod good_client;
#[path = "../server/nets.rs"]
mod nets;
mod owner;

use std::fs::File;
use std::io::BufWriter;
use std::net::SocketAddr;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use rpi_record::mcap::{PartLimits, Profile, RecordingOptions, RunSources, single_part};
use rpi_runtime::realtime::TimeBase;
use rpi_serve::{ClientToken, Role, Server, Settings, SocketSettings};
use rpi_sim::Cell;
use rpi_testkit::resident_memory_kb;

use bad_clients::{BAD_CLIENTS, Random};
use client::{PATIENCE, http, settings};
use digest::Digest;

rpi_testkit::trap_allocations!();

/// Token of the server.
const TOKEN: &str = "a-secret";
/// Maximum seconds for one client of each kind and the idle times before and after.
const LONGEST: u64 = 120;
/// Number of concurrent bad clients.
const ROGUES: u64 = 3;
/// Maximum growth of the allocated memory in bytes, independent of the duration: the latest log lines and a few
/// thousand inactive rules are kept.
const MAX_GROWTH: usize = 1 << 20;

/// The server under test.
struct Scene {
    address: SocketAddr,
    socket: PathBuf,
}

/// Opens a server with its own address and socket for the cell of the blending example. It may record into a file.
fn open(
    folder: &tempfile::TempDir,
    other: Settings,
    watch: Digest,
    records: bool,
) -> (Server, Scene) {
    let cell = rpi_testkit::workspace_root().join("examples/blending/cell.toml");
    let text = std::fs::read_to_string(cell).unwrap();
    let cell = Cell::parse("cell.toml", &text).unwrap_or_else(|errors| panic!("{errors}"));
    let socket = folder.path().join("rpi.sock");
    let settings = Settings {
        tokens: vec![ClientToken::new("chaos", Role::Programmer, TOKEN)],
        sockets: vec![SocketSettings::new(socket.clone())],
        ..other
    };
    let out = || File::create(folder.path().join("out.mcap")).unwrap();
    let recording = records.then(|| RecordingOptions {
        parts: single_part(BufWriter::new(out())),
        limits: PartLimits::default(),
        profile: Profile::default(),
        origin: RunSources {
            cell: text,
            ..RunSources::default()
        },
    });
    let server = Server::open_recorded(&cell, &settings, watch, recording).unwrap();
    let address = server.address();
    (server, Scene { address, socket })
}

fn seconds() -> u64 {
    let long = std::env::var("RPI_CHAOS").ok();
    long.map_or(6, |text| text.parse().expect("a number of seconds"))
}

#[test]
fn set_points_are_the_same_bits_with_and_without_clients() {
    let crowded = run(TimeBase::Real, |scene, digest| {
        attack(scene, digest, seconds())
    });
    let passed = crowded.len();
    assert!(passed as u64 > seconds(), "{passed} s");
    let quiet = run(TimeBase::Accelerated(5), |_, digest| {
        digest.wait(passed as u64)
    });
    assert_eq!(quiet[..passed], crowded[..]);
}

/// Returns the digests of each second of blending beside these clients.
fn run(pace: TimeBase, clients: impl FnOnce(&Scene, &Digest)) -> Vec<u64> {
    let folder = tempfile::tempdir().unwrap();
    let digest = Digest::new(seconds() + LONGEST);
    let settings = Settings {
        pace,
        tick_wrapper: |tick| rpi_testkit::no_alloc(tick),
        ..settings()
    };
    let (server, scene) = open(&folder, settings, digest.clone(), false);
    let ((), late) = owner::beside(scene.address, || clients(&scene, &digest));
    assert_eq!(
        late, 0,
        "commands came too late for their predecessors: the machine has too much else to do"
    );
    drop(server);
    digest.marks()
}

fn attack(scene: &Scene, digest: &Digest, seconds: u64) {
    let counts: Vec<AtomicU64> = BAD_CLIENTS.iter().map(|_| AtomicU64::new(0)).collect();
    digest.wait(1);
    // Run each kind once first, so that permanent allocations exist before memory is measured.
    for (run, count) in BAD_CLIENTS.iter().zip(&counts) {
        run_bad_client(*run, scene, 0, count);
    }
    wait_for_calm(scene);
    let (held, before) = (MEMORY.allocated(), resident_memory_kb("VmRSS:"));
    let until = digest.passed() + seconds;
    thread::scope(|scope| {
        for rogue in 0..ROGUES {
            let counts = &counts;
            scope.spawn(move || {
                let mut random = Random(rogue + 1);
                while digest.passed() < until {
                    let which = random.below(BAD_CLIENTS.len());
                    run_bad_client(BAD_CLIENTS[which], scene, random.next(), &counts[which]);
                }
            });
        }
        digest.wait(until);
    });
    wait_for_calm(scene);
    let (holds, after) = (MEMORY.allocated(), resident_memory_kb("VmRSS:"));
    println!("troubles {counts:?}");
    println!(
        "{held} bytes held before, {holds} after; for that the system gave {before} kB, {after} kB"
    );
    assert!(
        holds < held + MAX_GROWTH,
        "{held} bytes have become {holds}"
    );
}

/// Runs one bad client. A client that the server disconnects may panic.
fn run_bad_client(run: bad_clients::BadClient, scene: &Scene, seed: u64, count: &AtomicU64) {
    let mut random = Random(seed | 1);
    drop(catch_unwind(AssertUnwindSafe(|| run(scene, &mut random))));
    count.fetch_add(1, Ordering::Relaxed);
}

/// Waits until nothing of the bad clients remains.
fn wait_for_calm(scene: &Scene) {
    let begin = Instant::now();
    loop {
        let sessions = page(scene, "/sessions").matches("<session ").count();
        let nets = page(scene, "/nets");
        let strange = nets.lines().filter(|line| line.contains("<net ")).count()
            - nets.matches(owner::TITLE).count();
        if (sessions, strange) == (1, 0) {
            return;
        }
        assert!(begin.elapsed() < PATIENCE, "{sessions} sessions, {nets}");
        thread::sleep(Duration::from_millis(50));
    }
}

fn page(scene: &Scene, path: &str) -> String {
    http(
        scene.address,
        &format!("GET {path} HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer {TOKEN}\r\n\r\n"),
    )
}
