//! The second of two tools for the same promise: the kernel itself sees that the cycle's thread makes no system call but those of the
//! clock, whatever is asked of it meanwhile. The first one is the allocation trap.
//!
//! A violation ends a process, so each case runs in one of its own: this program, started again for that case.

use std::io::Write;
use std::os::unix::process::ExitStatusExt;
use std::process::ExitStatus;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use rpi_host::control::{Event, Executive, Rule, Setting, Why};
use rpi_host::realtime::fence;
use rpi_sim::SimBank;
use rpi_testkit::own_process;

use crate::support::{Rig, counter};

/// Says which case a process is for.
const CASE: &str = "RPI_FENCE_CASE";
/// Signal by which the kernel ends a process for a forbidden call.
const SIGSYS: i32 = 31;

/// Something that the cycle's thread does in each tick beside ticking.
type Beside = fn();

/// What must not be done there, each by another way into the kernel.
const PLANTED: [(&str, Beside); 4] = [
    ("file", || drop(std::fs::metadata("/"))),
    ("print", || drop(std::io::stderr().write_all(b"late\n"))),
    ("memory", || drop(std::hint::black_box(vec![1_u8; 1 << 26]))),
    ("wait", || {
        std::thread::park_timeout(Duration::from_millis(1))
    }),
];

/// Runs a case in a process of its own.
fn case(name: &str) -> ExitStatus {
    own_process("fence::a_case", CASE, name).status
}

/// What the others start; by itself there is nothing to do.
#[test]
fn a_case() {
    let Ok(name) = std::env::var(CASE) else {
        return;
    };
    let planted = PLANTED.iter().find(|(planted, _)| *planted == name);
    traffic(planted.map_or(|| (), |(_, beside)| *beside));
    // The thread behind the fence cannot end.
    std::process::exit(0);
}

#[test]
fn nothing_that_is_asked_of_the_cycle_makes_it_call_the_system() {
    let status = case("nothing planted");
    assert!(status.success(), "{status}");
}

#[test]
fn whatever_is_planted_is_caught() {
    for (name, _) in PLANTED {
        assert_eq!(case(name).signal(), Some(SIGSYS), "{name}");
    }
}

/// A thread behind a fence ticks while everything is asked of it that can be.
fn traffic(beside: Beside) {
    let mut rig = Rig::new(8);
    let over = Arc::new(AtomicBool::new(false));
    let told = Arc::clone(&over);
    let executive = std::mem::replace(&mut rig.executive, Rig::new(1).executive);
    std::thread::spawn(move || behind_the_fence(executive, &told, beside));
    for round in 0..50 {
        all_requests(&mut rig, round);
    }
    over.store(true, Ordering::Relaxed);
    std::thread::sleep(Duration::from_millis(20));
}

fn behind_the_fence(mut executive: Executive<SimBank>, over: &AtomicBool, beside: Beside) {
    let grant = fence();
    assert_eq!(grant.refused, None);
    while !over.load(Ordering::Relaxed) {
        executive.tick(0, &mut ());
        beside();
        std::thread::sleep(Duration::from_micros(200));
    }
    loop {
        std::thread::sleep(Duration::from_secs(3600));
    }
}

/// Loads, starts, rules, switches, cancels, aborts, parameters, subscriptions, unloads, an emergency stop.
fn all_requests(rig: &mut Rig, round: u32) {
    let ids = ["A", "B", "C"].map(|name| rig.load(counter(name, 5 + round % 7)));
    let [a, b, c] = ids;
    let control = &mut rig.control;
    control.schedule(Rule::follow(a).start(b)).unwrap();
    control.subscribe(a, &[0, 1], 1).unwrap();
    control.start(a).unwrap();
    let step = Setting {
        command: a,
        input: 0,
        value: [2.0_f64.to_bits()].into(),
    };
    control.set(vec![step]).unwrap();
    control.start(c).unwrap();
    control.cancel(c).unwrap();
    control.abort(c, Why::ClientLost).unwrap();
    if round.is_multiple_of(5) {
        control.emergency_stop().unwrap();
    }
    wait_for_end(rig, &ids);
}

/// Unloads what has ended until nothing is left.
fn wait_for_end(rig: &mut Rig, ids: &[rpi_host::control::CommandId]) {
    let mut left = ids.len();
    while left > 0 {
        while let Some(event) = rig.control.poll() {
            left -= usize::from(matches!(event, Event::Freed(_)));
        }
        rig.control.samples(|_, _, _, _| {});
        for id in ids {
            let ended = rig
                .control
                .get(*id)
                .is_some_and(|info| info.ending.is_some());
            if ended {
                // Asked for again and again until it is gone.
                let _ = rig.control.unload(*id);
            }
        }
        std::thread::sleep(Duration::from_micros(500));
    }
}
