//! The kernel itself sees that the server's cycle makes no system call but those of the clock, whatever clients ask of it.
//!
//! A violation ends a process, so each case runs in one of its own: this program, started again for that case.

use std::os::unix::process::ExitStatusExt;
use std::process::ExitStatus;
use std::sync::atomic::AtomicU64;
use std::thread;

use rpi_host::realtime::{Pace, RealTime};
use rpi_serve::Settings;
use rpi_testkit::{own_process, report_skip};

use crate::client::settings;
use crate::digest::Digest;
use crate::good::all_requests;
use crate::rogues::TROUBLES;
use crate::{LONGEST, Scene, make, open, owner, wait_for_calm};

/// Says which case a process is for.
const CASE: &str = "RPI_FENCE_CASE";
/// Signal by which the kernel ends a process for a forbidden call.
const SIGSYS: i32 = 31;
/// Exit status that says that the kernel puts up no fence.
const NO_FENCE: i32 = 77;
/// How often everything is asked.
const ROUNDS: u64 = 10;

/// How a tick is run.
type Around = fn(&mut dyn FnMut());

/// What must not be done in a tick, each by another way into the kernel.
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

/// Runs a case in a process of its own; none where there can be no fence.
fn case(name: &str) -> Option<ExitStatus> {
    let run = own_process("fence::a_case", CASE, name);
    if run.status.code() == Some(NO_FENCE) {
        report_skip("the kernel puts up no fence (seccomp)");
        return None;
    }
    if !run.status.success() {
        eprintln!("{}", String::from_utf8_lossy(&run.stderr));
    }
    Some(run.status)
}

/// What the others start; by itself there is nothing to do.
#[test]
fn a_case() {
    let Ok(name) = std::env::var(CASE) else {
        return;
    };
    let planted = PLANTED.iter().find(|(planted, _)| *planted == name);
    traffic(planted.map_or(|tick| tick(), |(_, around)| *around));
    // The thread behind the fence cannot end.
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

/// The server behind a fence, recording, and blending for one client while others ask for everything that there is, in order and out of it.
fn traffic(around_tick: Around) {
    let folder = tempfile::tempdir().unwrap();
    let real_time = RealTime {
        fence: true,
        ..RealTime::default()
    };
    let settings = Settings {
        pace: Pace::Real,
        real_time: Some(real_time),
        around_tick,
        ..settings()
    };
    let digest = Digest::new(LONGEST);
    let (server, scene) = open(&folder, settings, digest.clone(), true);
    let refused = server.grants().last().is_none_or(|g| g.refused.is_some());
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
    for trouble in TROUBLES {
        make(*trouble, scene, 7, &count);
    }
    wait_for_calm(scene);
}
