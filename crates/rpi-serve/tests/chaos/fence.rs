//! With the system-call fence up, the kernel verifies that the cycle thread makes no system call except those of the
//! clock, whatever clients request.
//!
//! A violation kills the process, so each case runs in its own process: this test program, started again for that case.

use std::os::unix::process::ExitStatusExt;
use std::process::ExitStatus;
use std::sync::atomic::AtomicU64;
use std::thread;

use rpi_runtime::realtime::{RealTime, TimeBase};
use rpi_serve::Settings;
use rpi_testkit::{report_skip, run_test_in_process};

use crate::bad_clients::BAD_CLIENTS;
use crate::client::settings;
use crate::digest::Digest;
use crate::good_client::all_requests;
use crate::{LONGEST, Scene, open, owner, run_bad_client, wait_for_calm};

/// Environment variable with the case of a child process.
const CASE: &str = "RPI_FENCE_CASE";
/// Signal by which the kernel kills a process after a forbidden system call.
const SIGSYS: i32 = 31;
/// Exit status of a child process if the kernel does not support the fence.
const NO_FENCE: i32 = 77;
/// Number of repetitions of all requests.
const ROUNDS: u64 = 10;

/// Wrapper around each tick.
type Around = fn(&mut dyn FnMut());

/// Forbidden operations in a tick, each with another system call.
const PLANTED: [(&str, Around); 2] = [
    ("file", |tick| {
        tick();
        drop(std::fs::metadata("/"));
    }),
    ("wait", |tick| {
        tick();
        thread::park_timeout(std::time::Duration::from_micros(1));
    }),
];

/// Runs a case in a child process; `None` if the kernel does not support the fence.
fn case(name: &str) -> Option<ExitStatus> {
    let run = run_test_in_process("fence::a_case", CASE, name);
    if run.status.code() == Some(NO_FENCE) {
        report_skip("the kernel puts up no fence (seccomp)");
        return None;
    }
    if !run.status.success() {
        eprintln!("{}", String::from_utf8_lossy(&run.stderr));
    }
    Some(run.status)
}

/// Entry point of the child processes; does nothing in the parent.
#[test]
fn a_case() {
    let Ok(name) = std::env::var(CASE) else {
        return;
    };
    let planted = PLANTED.iter().find(|(planted, _)| *planted == name);
    traffic(planted.map_or(|tick| tick(), |(_, around)| *around));
    // The fenced thread cannot exit, so the process does.
    std::process::exit(0);
}

#[test]
fn nothing_that_clients_ask_for_makes_the_cycle_call_the_system() {
    if let Some(status) = case("nothing planted") {
        assert!(status.success(), "{status}");
    }
}

#[test]
fn whatever_is_planted_is_caught() {
    for (name, _) in PLANTED {
        if let Some(status) = case(name) {
            assert_eq!(status.signal(), Some(SIGSYS), "{name}");
        }
    }
}

/// Runs a fenced, recording server that blends motions for one client while others send all kinds of valid and invalid
/// requests.
fn traffic(around_tick: Around) {
    let folder = tempfile::tempdir().unwrap();
    let real_time = RealTime {
        syscall_filter: true,
        ..RealTime::default()
    };
    let settings = Settings {
        pace: TimeBase::Real,
        real_time: Some(real_time),
        tick_wrapper: around_tick,
        ..settings()
    };
    let digest = Digest::new(LONGEST);
    let (server, scene) = open(&folder, settings, digest.clone(), true);
    let refused = server.grants().last().is_none_or(|g| g.refusal.is_some());
    if refused {
        std::process::exit(NO_FENCE);
    }
    owner::beside(scene.address, || {
        digest.wait(1);
        good_and_bad(&scene);
    });
    let written = server.close().unwrap().unwrap();
    assert!(written.ticks > 0, "{written:?}");
}

fn good_and_bad(scene: &Scene) {
    for round in 0..ROUNDS {
        all_requests(scene, round);
    }
    let count = AtomicU64::new(0);
    for run in BAD_CLIENTS {
        run_bad_client(*run, scene, 7, &count);
    }
    wait_for_calm(scene);
}
