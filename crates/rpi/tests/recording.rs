//! Recordings of the paper's example: a replay gives the same bits across all takeovers, and any error in a recording
//! is reported.

mod support;

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use rpi_record::mcap::Recording;
use support::{output_text, rpi};

fn blending() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/blending/blending.rpi")
}

/// Records the example. Returns the file and the output of the tool.
fn record(folder: &Path, options: &[&str]) -> (PathBuf, String) {
    let (program, file) = (blending(), folder.join("out.mcap"));
    let mut arguments = vec!["run", program.to_str().unwrap()];
    arguments.extend(["--record", file.to_str().unwrap()]);
    arguments.extend(options);
    let output = rpi(&arguments);
    assert_eq!(output.status.code(), Some(0), "{}", output_text(&output));
    (file, output_text(&output))
}

fn replay(file: &Path) -> (Option<i32>, String) {
    let output = rpi(&["replay", file.to_str().unwrap()]);
    (output.status.code(), output_text(&output))
}

/// Two takeovers and two regular ends; the device brakes at the end, as the run is cut off in motion.
const SOME_ROUNDS: [&str; 2] = ["--time", "7s"];

#[test]
fn a_recording_gives_the_same_bits_across_takeovers() {
    let folder = tempfile::tempdir().unwrap();
    let (file, ran) = record(folder.path(), &SOME_ROUNDS);
    assert!(
        ran.contains("taken over at at_b") && ran.contains(" 0 lost"),
        "{ran}"
    );
    let (code, report) = replay(&file);
    assert_eq!(code, Some(0), "{report}");
    assert!(report.contains("the same bits throughout"), "{report}");
    let output = rpi(&["replay", "--json", file.to_str().unwrap()]);
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(report["commands"].as_u64() > Some(2), "{report}");
    assert!(report["values"].as_u64() > Some(5_000), "{report}");
}

/// Records a program in real time and sends a signal to the run after a while.
#[cfg(unix)]
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
#[cfg(unix)]
const UNDER_WAY: Duration = Duration::from_secs(1);

#[cfg(unix)]
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

#[test]
fn a_recording_on_real_time_behind_a_fence_gives_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    let (file, ran) = record(folder.path(), &["--time", "4s", "--real-time", "--fence"]);
    assert!(ran.contains("no system call but the clock's: yes"), "{ran}");
    let (code, report) = replay(&file);
    assert_eq!(code, Some(0), "{report}");
}

/// A changed value in a recording is detected by the replay and reported with its tick.
#[test]
fn a_value_that_was_changed_is_told_with_its_tick() {
    let folder = tempfile::tempdir().unwrap();
    let (file, _) = record(folder.path(), &SOME_ROUNDS);
    let bytes = std::fs::read(&file).unwrap();
    let changed = tampered(&bytes);
    std::fs::write(&file, changed).unwrap();
    let (code, report) = replay(&file);
    assert_eq!(code, Some(1), "{report}");
    assert!(
        report.contains("DIFFERENT from tick") && report.contains("recorded"),
        "{report}"
    );
}

/// Changes the lowest bit of a number in the recorded log and corrects the checksums, which only detect accidental
/// changes.
fn tampered(bytes: &[u8]) -> Vec<u8> {
    let mut changed = Vec::new();
    let mut out = std::io::Cursor::new(&mut changed);
    let options = mcap::WriteOptions::new().compression(None);
    let mut writer = options.create(&mut out).unwrap();
    let mut seen = 0;
    for message in mcap::MessageStream::new(bytes).unwrap() {
        let mut message = message.unwrap();
        if message.channel.topic == "/rpi/tape" {
            seen += 1;
            if seen == 1000 {
                set_point(message.data.to_mut());
            }
        }
        writer.write(&message).unwrap();
    }
    for record in mcap::read::LinearReader::new(bytes).unwrap() {
        match record.unwrap() {
            mcap::records::Record::Attachment { header, data, .. } => {
                let attachment = mcap::Attachment {
                    log_time: 0,
                    create_time: 0,
                    name: header.name,
                    media_type: header.media_type,
                    data,
                };
                writer.attach(&attachment).unwrap();
            }
            mcap::records::Record::Metadata(metadata) => {
                writer.write_metadata(&metadata).unwrap();
            }
            _ => {}
        }
    }
    writer.finish().unwrap();
    drop(writer);
    changed
}

/// Finds the first set-point of a tick: an entry of kind 7 (`form.txt` of the recording describes the words).
fn set_point(tick: &mut [u8]) {
    let word = |tick: &[u8], k: usize| u64::from_le_bytes(tick[k * 8..][..8].try_into().unwrap());
    let mut at = 6;
    loop {
        let head = word(tick, at);
        if head >> 56 == 7 {
            tick[(at + 1) * 8] ^= 1;
            return;
        }
        at += 1 + (head >> 32 & 0x7f_ffff) as usize;
    }
}

#[test]
fn what_is_cut_off_or_foreign_is_told_with_its_code() {
    let folder = tempfile::tempdir().unwrap();
    let (file, _) = record(folder.path(), &["--time", "200ms"]);
    let bytes = std::fs::read(&file).unwrap();
    for len in [0, 7, 100, bytes.len() / 2, bytes.len() - 1] {
        std::fs::write(&file, &bytes[..len]).unwrap();
        let (code, report) = replay(&file);
        assert_eq!(code, Some(2), "{len} bytes: {report}");
        assert!(report.contains("RPI9021"), "{len} bytes: {report}");
    }
    std::fs::write(&file, "cycle,flow,value\n").unwrap();
    assert!(replay(&file).1.contains("RPI9021"));
}

/// Topics for viewers.
#[test]
fn flows_set_points_sensors_and_events_are_there_for_viewers() {
    let folder = tempfile::tempdir().unwrap();
    let (file, _) = record(folder.path(), &["--time", "100ms"]);
    let bytes = std::fs::read(&file).unwrap();
    let mut topics = std::collections::BTreeMap::new();
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        *topics.entry(message.channel.topic.clone()).or_insert(0) += 1;
        if message.channel.message_encoding == "json" {
            let schema = message.channel.schema.as_ref().unwrap();
            assert_eq!(schema.encoding, "jsonschema");
            serde_json::from_slice::<serde_json::Value>(&message.data).unwrap();
        }
    }
    for topic in [
        "/set_points/arm",
        "/sensors/arm",
        "/device/arm",
        "/rpi/tape",
    ] {
        assert!(
            topics.get(topic).is_some_and(|n| *n >= 100),
            "{topic}: {topics:?}"
        );
    }
    for topic in ["/events", "/rpi/requests"] {
        assert!(topics.contains_key(topic), "{topics:?}");
    }
}

/// An interrupted server closes in an orderly way, and its recording is complete.
#[cfg(unix)]
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

/// Checksums are verified: any changed bit is detected.
#[test]
fn a_flipped_bit_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let (file, _) = record(folder.path(), &["--time", "30ms"]);
    let mut bytes = std::fs::read(&file).unwrap();
    assert!(Recording::read(&bytes).is_ok());
    for at in (0..bytes.len()).step_by(bytes.len() / 400) {
        bytes[at] ^= 1 << (at % 8);
        assert!(Recording::read(&bytes).is_err(), "byte {at}");
        bytes[at] ^= 1 << (at % 8);
    }
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    std::fs::write(&file, &bytes).unwrap();
    let (code, report) = replay(&file);
    assert_eq!(code, Some(2), "{report}");
    assert!(report.contains("RPI9021"), "{report}");
}

/// Returns the messages of a topic.
fn messages(file: &Path, topic: &str) -> Vec<serde_json::Value> {
    let bytes = std::fs::read(file).unwrap();
    let messages = mcap::MessageStream::new(&bytes)
        .unwrap()
        .map(Result::unwrap);
    let wanted = messages.filter(|message| message.channel.topic == topic);
    let read = wanted.map(|m| serde_json::from_slice(&m.data).unwrap());
    read.collect()
}

/// A braking event belongs to the end of its command, and a device event has the tick of the change.
#[test]
fn events_have_their_own_ticks() {
    let folder = tempfile::tempdir().unwrap();
    let (file, ran) = record(folder.path(), &["--time", "1s"]);
    assert!(ran.contains("and arm braked"), "{ran}");
    let events = messages(&file, "/events");
    let of = |kind: &str| -> Vec<u64> {
        let own = events.iter().filter(|e| e["event"] == kind);
        own.map(|e| e["tick"].as_u64().unwrap()).collect()
    };
    assert_eq!(of("ended"), [1000]);
    assert_eq!(of("braked"), [1000; 7]);
    let moves = events.iter().filter(|e| e["event"] == "device");
    let moves: Vec<_> = moves
        .map(|e| (e["tick"].as_u64().unwrap(), e["moving"] == true))
        .collect();
    assert_eq!(moves.len(), 2, "{moves:?}");
    assert!(moves[0].0 < 10 && moves[0].1, "{moves:?}");
    assert!(moves[1].0 > 1000 && !moves[1].1, "{moves:?}");
    let (code, report) = replay(&file);
    assert_eq!(code, Some(0), "{report}");
}

/// Cycles that take too long end the run as a fault, and each one is an event.
#[test]
fn overruns_are_recorded_and_a_stop_for_them_is_a_fault() {
    let folder = tempfile::tempdir().unwrap();
    let (program, file) = (blending(), folder.path().join("out.mcap"));
    let mut arguments = vec![
        "run",
        program.to_str().unwrap(),
        "--record",
        file.to_str().unwrap(),
    ];
    arguments.extend(["--real-time", "--period", "1us", "--on-overrun", "stop:5/8"]);
    arguments.extend(["--cycle-share", "off"]);
    let output = rpi(&arguments);
    assert_eq!(output.status.code(), Some(3), "{}", output_text(&output));
    assert!(
        output_text(&output).contains("too many overruns"),
        "{}",
        output_text(&output)
    );
    let events = messages(&file, "/events");
    let overruns = events.iter().filter(|e| e["event"] == "overrun");
    let late: Vec<u64> = overruns.map(|e| e["late_ns"].as_u64().unwrap()).collect();
    assert!(late.len() >= 5 && late.iter().all(|ns| *ns > 0), "{late:?}");
    let (code, report) = replay(&file);
    assert_eq!(code, Some(0), "{report}");
}

#[cfg(unix)]
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
#[cfg(unix)]
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
#[cfg(unix)]
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
#[cfg(unix)]
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
