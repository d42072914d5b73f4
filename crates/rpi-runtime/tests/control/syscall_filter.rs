//! Tests of the system call filter: the kernel checks that the cycle thread makes no system calls except those of the
//! clock, whatever the clients request. The allocation trap is the other test of this property.
//!
//! A violation ends the process, so each case runs in a process of its own: this test program, started again for the
//! case.

use std::io::Write;
use std::os::unix::process::ExitStatusExt;
use std::process::ExitStatus;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use rpi_runtime::control::{AbortReason, Event, Executive, InputValue, Rule};
use rpi_runtime::realtime::install_syscall_filter;
use rpi_sim::SimBank;
use rpi_testkit::run_test_in_process;

use crate::support::{TestCore, counter};

/// Environment variable with the case of a child process.
const CASE: &str = "RPI_FENCE_CASE";
/// Signal by which the kernel ends a process after a forbidden system call.
const SIGSYS: i32 = 31;

/// An action of the cycle thread in each tick, in addition to the tick.
type ExtraAction = fn();

/// Forbidden actions. Each of them enters the kernel in a different way.
const PLANTED: [(&str, ExtraAction); 4] = [
    ("file", || drop(std::fs::metadata("/"))),
    ("print", || drop(std::io::stderr().write_all(b"late\n"))),
    ("memory", || drop(std::hint::black_box(vec![1_u8; 1 << 26]))),
    ("wait", || {
        std::thread::park_timeout(Duration::from_millis(1))
    }),
];

/// Runs a case in a child process.
fn case(name: &str) -> ExitStatus {
    run_test_in_process("syscall_filter::a_case", CASE, name).status
}

/// Entry point of the child processes. Without a case in the environment it does nothing.
#[test]
fn a_case() {
    let Ok(name) = std::env::var(CASE) else {
        return;
    };
    let planted = PLANTED.iter().find(|(planted, _)| *planted == name);
    traffic(planted.map_or(|| (), |(_, beside)| *beside));
    // The thread behind the filter cannot exit.
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

/// Ticks on a thread behind the filter while the host makes requests of every kind.
fn traffic(beside: ExtraAction) {
    let mut rig = TestCore::new(8);
    let over = Arc::new(AtomicBool::new(false));
    let stop = Arc::clone(&over);
    let executive = std::mem::replace(&mut rig.executive, TestCore::new(1).executive);
    std::thread::spawn(move || behind_the_fence(executive, &stop, beside));
    for round in 0..50 {
        all_requests(&mut rig, round);
    }
    over.store(true, Ordering::Relaxed);
    std::thread::sleep(Duration::from_millis(20));
}

fn behind_the_fence(mut executive: Executive<SimBank>, over: &AtomicBool, beside: ExtraAction) {
    let grant = install_syscall_filter();
    assert_eq!(grant.refusal, None);
    while !over.load(Ordering::Relaxed) {
        executive.tick(0, &mut ());
        beside();
        std::thread::sleep(Duration::from_micros(200));
    }
    loop {
        std::thread::sleep(Duration::from_secs(3600));
    }
}

/// Makes requests of every kind: load, start, rule, takeover, cancel, abort, set, subscribe, unload, emergency stop.
fn all_requests(rig: &mut TestCore, round: u32) {
    let ids = ["A", "B", "C"].map(|name| rig.load(counter(name, 5 + round % 7)));
    let [a, b, c] = ids;
    let control = &mut rig.control;
    control.schedule(Rule::follow(a).start(b)).unwrap();
    control.subscribe(a, &[0, 1], 1).unwrap();
    control.start(a).unwrap();
    let step = InputValue {
        command: a,
        input: 0,
        value: [2.0_f64.to_bits()].into(),
    };
    control.set(vec![step]).unwrap();
    control.start(c).unwrap();
    control.cancel(c).unwrap();
    control.abort(c, AbortReason::ClientLost).unwrap();
    if round.is_multiple_of(5) {
        control.emergency_stop().unwrap();
    }
    wait_for_end(rig, &ids);
}

/// Unloads all ended commands until every command is freed.
fn wait_for_end(rig: &mut TestCore, ids: &[rpi_runtime::control::CommandId]) {
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
                // The request is repeated until the command is freed, so a refusal is ignored.
                let _ = rig.control.unload(*id);
            }
        }
        std::thread::sleep(Duration::from_micros(500));
    }
}
