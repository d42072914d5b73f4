//! `--guard` and `--restart`: a control core that is killed or stalls, and the recording that it leaves.
#![cfg(target_os = "linux")]

mod cuts;
mod notify;
mod process;
#[path = "../support/mod.rs"]
mod support;

use std::path::Path;

use process::{Process, call, signal, wait_for_bytes, wait_until};
use support::recordings::{blending, replay, ticks_up_to_the_cut};

/// Starts the example in real time with a guard and a recording.
fn run(file: &Path, options: &[&str]) -> Process {
    let program = blending();
    let mut arguments = vec!["run", program.to_str().unwrap()];
    arguments.extend(["--real-time", "--record", file.to_str().unwrap()]);
    arguments.extend(options);
    Process::start(&arguments, &[])
}

/// Starts a server with a guard at a Unix socket of the folder, with a recording.
fn serve(folder: &Path, options: &[&str]) -> Process {
    let socket = folder.join("rpi.sock");
    let file = folder.join("out.mcap");
    let mut arguments = vec!["serve", "--listen", "127.0.0.1:0"];
    arguments.extend(["--socket", socket.to_str().unwrap()]);
    arguments.extend(["--record", file.to_str().unwrap()]);
    arguments.extend(options);
    Process::start(&arguments, &[])
}

/// Size in bytes of a recording with some seconds of the example.
const SECONDS: u64 = 600_000;

/// The guard of a killed run reports the signal and completes the recording, which replays up to the cut.
#[test]
fn the_guard_of_a_killed_run_completes_its_recording() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("out.mcap");
    let run = run(&file, &["--guard"]);
    wait_for_bytes(&file, SECONDS);
    signal(run.core(None), "-KILL");
    let (status, text) = run.end();
    assert_eq!(status, Some(4), "{text}");
    for part in ["was ended by SIGKILL, after ", "is completed, with "] {
        assert!(text.contains(part), "{text}");
    }
    assert!(ticks_up_to_the_cut(&file) >= 500, "{text}");
    let (_, report) = replay(&file);
    let reason = "cut off after these ticks: the control core was ended by SIGKILL";
    assert!(report.contains(reason), "{report}");
    cuts::assert_indexed(&std::fs::read(&file).unwrap());
}

/// Only the last part of a recording is completed; the others are complete.
#[test]
fn a_recording_of_several_parts_is_completed_in_its_last_one() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("out.mcap");
    let run = run(&file, &["--guard", "--part-time", "1s"]);
    wait_for_bytes(&folder.path().join("out.0003.mcap"), 100_000);
    signal(run.core(None), "-ABRT");
    let (status, text) = run.end();
    assert_eq!(status, Some(4), "{text}");
    assert!(text.contains("SIGABRT"), "{text}");
    assert!(ticks_up_to_the_cut(&file) >= 2000, "{text}");
}

/// A core that makes no cycle any more is ended; with `--restart` the server runs again, and its first recording is kept.
#[test]
fn a_stalled_server_is_ended_and_restarted() {
    let folder = tempfile::tempdir().unwrap();
    let server = serve(folder.path(), &["--restart", "--stall-timeout", "500ms"]);
    server.wait_for("serving at", 1);
    let core = server.core(None);
    wait_for_bytes(&folder.path().join("out.mcap"), 20_000);
    signal(core, "-STOP");
    server.wait_for("serving at", 2);
    server.wait_for("is completed, with", 1);
    let text = server.text();
    assert!(text.contains(" stalled for "), "{text}");
    assert!(text.contains("restart 1 of 3"), "{text}");
    assert!(ticks_up_to_the_cut(&folder.path().join("out.crash-1.mcap")) > 0);
    let answer = call(&folder.path().join("rpi.sock"), "ping");
    assert!(answer.get("result").is_some(), "{answer}");
    signal(server.id(), "-TERM");
    let (status, text) = server.end();
    assert_eq!(status, Some(0), "{text}");
    assert_eq!(replay(&folder.path().join("out.mcap")).0, Some(0), "{text}");
}

/// An emergency stop holds across a crash, until it is reset.
#[test]
fn an_emergency_stop_holds_across_a_restart() {
    let folder = tempfile::tempdir().unwrap();
    let socket = folder.path().join("rpi.sock");
    let server = serve(folder.path(), &["--restart"]);
    server.wait_for("serving at", 1);
    assert_eq!(call(&socket, "emergency.state")["result"]["stopped"], false);
    signal(server.id(), "-QUIT");
    server.wait_for("EMERGENCY STOP; ", 1);
    // The core reports the stop to the guard with its next cycles.
    std::thread::sleep(std::time::Duration::from_millis(500));
    let mut core = None;
    for crash in 1..=2 {
        core = Some(server.core(core));
        signal(core.unwrap(), "-KILL");
        server.wait_for("serving at", crash + 1);
        assert_eq!(call(&socket, "emergency.state")["result"]["stopped"], true);
        std::thread::sleep(std::time::Duration::from_millis(200));
    }
    let is_stopped = || call(&socket, "emergency.state")["result"]["stopped"] == true;
    wait_until(
        || {
            signal(server.id(), "-USR1");
            !is_stopped()
        },
        || "the stop is not reset".to_owned(),
    );
    signal(server.id(), "-TERM");
    assert_eq!(server.end().0, Some(0));
}

/// Without `--restart`, the guard of a killed server ends, and so does a guard whose core crashes too often.
#[test]
fn restarts_are_limited() {
    let folder = tempfile::tempdir().unwrap();
    let server = serve(folder.path(), &["--guard"]);
    server.wait_for("serving at", 1);
    signal(server.core(None), "-KILL");
    let (status, text) = server.end();
    assert_eq!(status, Some(4), "{text}");
    assert!(!text.contains("restart"), "{text}");
    let server = serve(folder.path(), &["--restart"]);
    let mut core = None;
    for start in 1..=4 {
        server.wait_for("serving at", start);
        core = Some(server.core(core));
        signal(core.unwrap(), "-KILL");
    }
    let (status, text) = server.end();
    assert_eq!(status, Some(4), "{text}");
    assert!(
        text.contains("no restart after 3 restarts within 60 s"),
        "{text}"
    );
}

/// The guard passes signals on, and its exit status is that of the core.
#[test]
fn a_signal_to_the_guard_ends_the_run_in_order() {
    let folder = tempfile::tempdir().unwrap();
    for (name, code) in [("-TERM", 143), ("-INT", 130), ("-QUIT", 3)] {
        let file = folder.path().join(format!("out{name}.mcap"));
        let run = run(&file, &["--guard"]);
        wait_for_bytes(&file, SECONDS / 2);
        signal(run.id(), name);
        let (status, text) = run.end();
        assert_eq!(status, Some(code), "{text}");
        assert!(!text.contains("guard:"), "{text}");
        assert_eq!(replay(&file).0, Some(0), "{text}");
    }
    let missing = Process::start(&["run", "--guard", "missing.rpi"], &[]);
    assert_eq!(missing.end().0, Some(2));
    let program = blending();
    let simulated = ["run", program.to_str().unwrap(), "--guard", "--restart"];
    let (status, text) = Process::start(&simulated, &[]).end();
    assert_eq!(status, Some(0), "{text}");
}

/// A core whose guard is killed ends in order: its devices brake and its recording is complete.
#[test]
fn a_core_without_its_guard_ends_in_order() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("out.mcap");
    let run = run(&file, &["--guard"]);
    wait_for_bytes(&file, SECONDS);
    let core = run.core(None);
    signal(run.id(), "-KILL");
    let is_running = || Path::new(&format!("/proc/{core}/exe")).exists();
    wait_until(|| !is_running(), || "the core still runs".to_owned());
    let (_, text) = run.end();
    assert!(text.contains("the guard has ended; stopping"), "{text}");
    assert_eq!(replay(&file).0, Some(0), "{text}");
}
