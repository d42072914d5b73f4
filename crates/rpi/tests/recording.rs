//! Recordings of the paper's example: a replay gives the same bits across all takeovers, and any error in a recording
//! is reported.

mod support;

use std::path::Path;

use rpi_record::mcap::{Recording, part_path};
use support::recordings::{blending, record, replay, ticks_up_to_the_cut};
use support::{output_text, rpi};

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

/// A file that was cut off is replayed up to the cut. What is not a recording is refused.
#[test]
fn what_is_cut_off_or_foreign_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let (file, _) = record(folder.path(), &SOME_ROUNDS);
    let bytes = std::fs::read(&file).unwrap();
    let mut most = 0;
    for len in [bytes.len() / 3, bytes.len() / 2, bytes.len() - 1] {
        std::fs::write(&file, &bytes[..len]).unwrap();
        let ticks = ticks_up_to_the_cut(&file);
        assert!(ticks > most, "{len} bytes: {ticks} ticks");
        most = ticks;
    }
    assert!(most >= 7000, "{most}");
    for len in [0, 7, 100] {
        std::fs::write(&file, &bytes[..len]).unwrap();
        let (code, report) = replay(&file);
        assert_eq!(code, Some(2), "{len} bytes: {report}");
        assert!(report.contains("RPI9021"), "{len} bytes: {report}");
    }
    std::fs::write(&file, "cycle,flow,value\n").unwrap();
    assert!(replay(&file).1.contains("RPI9021"));
}

/// A recording in parts is replayed as one. A part that is missing is a cut.
#[test]
fn a_recording_in_parts_gives_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    let (file, _) = record(folder.path(), &["--time", "7s", "--part-time", "2s"]);
    let part = |number: u32| part_path(&file, number);
    assert!(part(4).exists() && !part(5).exists());
    let (code, report) = replay(&file);
    assert_eq!(code, Some(0), "{report}");
    assert!(report.contains("the same bits throughout"), "{report}");
    let (code, report) = replay(&part(2));
    assert_eq!(code, Some(2), "{report}");
    assert!(
        report.contains("name the file of its first part"),
        "{report}"
    );
    for number in 1..=4 {
        // Each part is a complete file for viewers.
        let seen = messages(&part(number), "/set_points/arm").len();
        assert!(seen > 500, "part {number}: {seen}");
    }
    let third = std::fs::read(part(3)).unwrap();
    for len in [0, 50, third.len() / 2] {
        std::fs::write(part(3), &third[..len]).unwrap();
        assert!(ticks_up_to_the_cut(&file) >= 4001, "{len} bytes");
    }
    std::fs::remove_file(part(3)).unwrap();
    let (_, report) = replay(&file);
    assert!(report.contains("out.0003.mcap is missing"), "{report}");
    assert_eq!(ticks_up_to_the_cut(&file), 4001);
}

/// The parts of two recordings do not mix.
#[test]
fn a_part_of_another_recording_is_refused() {
    let (folder, other) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let (file, _) = record(folder.path(), &["--time", "3s", "--part-time", "1s"]);
    let (other_file, _) = record(other.path(), &["--time", "4s", "--part-time", "2s"]);
    std::fs::copy(part_path(&other_file, 2), part_path(&file, 2)).unwrap();
    let (code, report) = replay(&file);
    assert_eq!(code, Some(2), "{report}");
    assert!(
        report.contains("part 2 belongs to another recording"),
        "{report}"
    );
}

/// The times of the messages are those of the run, from its first tick to its last one.
#[test]
fn the_span_of_a_recording_is_that_of_the_run() {
    let folder = tempfile::tempdir().unwrap();
    for profile in ["json", "ros2", "foxglove"] {
        let options = ["--time", "1s", "--real-time", "--profile", profile];
        let (file, _) = record(folder.path(), &options);
        let bytes = std::fs::read(&file).unwrap();
        let messages = mcap::MessageStream::new(&bytes)
            .unwrap()
            .map(Result::unwrap);
        let times: Vec<u64> = messages.map(|m| m.log_time).collect();
        let (first, last) = (times.iter().min().unwrap(), times.iter().max().unwrap());
        // The arm brakes after the end of the command.
        let seconds = (last - first) / 1_000_000_000;
        assert!((1..3).contains(&seconds), "{profile}: {first} to {last}");
    }
}

/// Viewers address a value by a path: members of objects and elements of lists.
#[test]
fn fields_are_nested_like_their_names() {
    let folder = tempfile::tempdir().unwrap();
    let (file, _) = record(folder.path(), &["--time", "100ms"]);
    for message in messages(&file, "/device/arm") {
        let joints = &message["joint"]["commanded_position"];
        assert_eq!(joints.as_array().map(Vec::len), Some(7), "{message}");
        let x = &message["tcp"]["commanded_position"]["position"]["x"];
        assert!(x.is_f64(), "{message}");
    }
    for message in messages(&file, "/set_points/arm") {
        let names: Vec<&String> = message.as_object().unwrap().keys().collect();
        assert!(names.iter().all(|n| !n.contains(['.', '['])), "{names:?}");
    }
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

/// Checksums are verified: any changed bit is detected.
#[test]
fn a_flipped_bit_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let (file, _) = record(folder.path(), &["--time", "30ms"]);
    let mut bytes = std::fs::read(&file).unwrap();
    assert!(Recording::read(&bytes).is_ok());
    for at in (0..bytes.len()).step_by(bytes.len() / 400) {
        bytes[at] ^= 1 << (at % 8);
        // A changed byte at the very end looks like a file that was cut off.
        let read = Recording::read(&bytes);
        let found = read
            .as_ref()
            .map_or(true, |recording| recording.cut.is_some());
        assert!(found, "byte {at}");
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
