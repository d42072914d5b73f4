//! Recordings of runs that end by a signal, a kill or a full disk.
#![cfg(unix)]

mod support;

use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use support::recordings::{blending, replay, ticks_up_to_the_cut};
use support::{output_text, rpi};

/// Records a program in real time and sends a signal to the run after a while.
fn signalled(arguments: &[&str], file: &Path, signal: &str, after: Duration) -> Output {
    let mut run = Command::new(env!("CARGO_BIN_EXE_rpi"));
    let run = run
        .arg("run")
        .args(arguments)
        .args(["--real-time", "--record"]);
    let run = run.arg(file).env("NO_COLOR", "1");
    let run = run.stdout(Stdio::piped()).stderr(Stdio::piped());
    let run = run.spawn().unwrap();
    // The signal handlers are installed before the file is created.
    let begin = Instant::now();
    while !file.exists() {
        assert!(begin.elapsed() < Duration::from_secs(30));
        sleep(Duration::from_millis(10));
    }
    sleep(after);
    let status = Command::new("kill")
        .args([signal, &run.id().to_string()])
        .status();
    assert!(status.unwrap().success());
    run.wait_with_output().unwrap()
}

/// Time after which the arm moves.
const UNDER_WAY: Duration = Duration::from_secs(1);

#[test]
fn a_run_that_is_interrupted_ends_in_order() {
    let folder = tempfile::tempdir().unwrap();
    let program = blending();
    for (signal, code) in [("-INT", 130), ("-HUP", 129)] {
        let file = folder.path().join(format!("out{signal}.mcap"));
        let output = signalled(&[program.to_str().unwrap()], &file, signal, UNDER_WAY);
        assert_eq!(output.status.code(), Some(code), "{}", output_text(&output));
        assert!(
            output_text(&output).contains("cut off"),
            "{}",
            output_text(&output)
        );
        let (code, report) = replay(&file);
        assert_eq!(code, Some(0), "{report}");
    }
}

/// A killed process leaves a recording that lacks at most the last chunk.
#[test]
fn a_killed_run_leaves_a_recording_that_reads() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("out.mcap");
    let program = blending();
    let arguments = [program.to_str().unwrap()];
    let killed = signalled(&arguments, &file, "-KILL", Duration::from_secs(3));
    assert_eq!(killed.status.code(), None, "{}", output_text(&killed));
    assert!(ticks_up_to_the_cut(&file) >= 500);
}

/// An interrupted server closes in an orderly way, and its recording is complete.
#[test]
fn a_server_records_until_it_is_interrupted() {
    use std::io::{BufRead, BufReader};
    use std::process::Stdio;

    let folder = tempfile::tempdir().unwrap();
    let (file, socket) = (
        folder.path().join("out.mcap"),
        folder.path().join("rpi.sock"),
    );
    let mut server = Command::new(env!("CARGO_BIN_EXE_rpi"))
        .args(["serve", "--listen", "127.0.0.1:0", "--record"])
        .arg(&file)
        .arg("--socket")
        .arg(&socket)
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(server.stderr.take().unwrap()).lines();
    let serving = lines.next().unwrap().unwrap();
    assert!(serving.starts_with("serving at"), "{serving}");
    std::thread::sleep(std::time::Duration::from_millis(200));
    let number = server.id().to_string();
    let status = Command::new("kill").args(["-TERM", &number]).status();
    assert!(status.unwrap().success());
    let summary = lines.next().unwrap().unwrap();
    assert!(server.wait().unwrap().success(), "{summary}");
    assert!(
        summary.starts_with("recorded ") && summary.ends_with(" 0 lost"),
        "{summary}"
    );
    assert!(!socket.exists());
    let (code, report) = replay(&file);
    assert_eq!(code, Some(0), "{report}");
}

#[test]
fn what_cannot_be_written_is_told_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let full = folder.path().join("full.mcap");
    std::os::unix::fs::symlink("/dev/full", &full).unwrap();
    for file in [Path::new("/dev/full"), &full] {
        let program = blending();
        let [program, name] = [&program, file].map(|path| path.to_str().unwrap());
        let output = rpi(&["run", program, "--time", "50ms", "--record", name]);
        assert_eq!(output.status.code(), Some(2), "{}", output_text(&output));
        assert!(
            output_text(&output).contains(name),
            "{}",
            output_text(&output)
        );
        assert!(
            output_text(&output).contains("No space left"),
            "{}",
            output_text(&output)
        );
    }
}

/// After a write error of the recording, the summary is still printed, with the error.
#[test]
fn what_has_happened_is_told_where_the_file_takes_no_more() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let text = "command Count ()\nlet\n  n = 1 -> pre n + 1;\n  export n;\n  finish done when n >= 30000;\ntel\n";
    std::fs::write(path("count.rpi"), text).unwrap();
    std::fs::write(path("cell.toml"), "").unwrap();
    // Files of 32 kB at most; a write beyond is an error instead of a signal.
    let limited = "trap '' XFSZ; ulimit -f 64; exec \"$0\" \"$@\"";
    let program = [env!("CARGO_BIN_EXE_rpi"), "run", &path("count.rpi")].map(str::to_owned);
    let mut shell = std::process::Command::new("sh");
    shell.args(["-c", limited]).args(program);
    let output = shell
        .args(["--record", &path("out.mcap")])
        .output()
        .unwrap();
    let text = output_text(&output);
    assert_eq!(output.status.code(), Some(2), "{text}");
    assert!(text.contains("30000 cycles"), "{text}");
    assert!(
        text.contains("NOT RECORDED to the end: File too large"),
        "{text}"
    );
}

/// An emergency stop ends everything with that cause and reports what was still moving.
#[test]
fn sigquit_is_an_emergency_stop() {
    let folder = tempfile::tempdir().unwrap();
    let (program, file) = (blending(), folder.path().join("out.mcap"));
    let output = signalled(&[program.to_str().unwrap()], &file, "-QUIT", UNDER_WAY);
    assert_eq!(output.status.code(), Some(3), "{}", output_text(&output));
    let text = output_text(&output);
    assert!(
        text.contains("STOPPED: emergency stop, and arm braked"),
        "{text}"
    );
    assert!(text.contains("arm: ok, at rest"), "{text}");
    let (code, report) = replay(&file);
    assert_eq!(code, Some(0), "{report}");
}

/// An emergency stop is reported whether a command ran in that tick or not.
#[test]
fn sigquit_between_commands_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let (program, file) = (
        folder.path().join("short.rpi"),
        folder.path().join("out.mcap"),
    );
    let text = "command Rest () let finish done when true; tel
task Short let repeat let Rest(); Rest(); tel tel
";
    std::fs::write(&program, text).unwrap();
    let arguments = [program.to_str().unwrap(), "--json"];
    let output = signalled(&arguments, &file, "-QUIT", UNDER_WAY / 2);
    assert_eq!(output.status.code(), Some(3), "{}", output_text(&output));
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(summary["stopped"], "emergency stop");
}
