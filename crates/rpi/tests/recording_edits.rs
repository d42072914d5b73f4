//! `rpi recording cut` and `rpi recording merge`.

mod support;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use support::recordings::{record, replay};
use support::rpi_texts;

/// Runs the tool, which must succeed. Returns what it prints.
fn done(arguments: &[&str]) -> String {
    let (status, text, message) = rpi_texts(arguments);
    assert_eq!(status, 0, "{arguments:?}: {message}{text}");
    text
}

/// Runs the tool, which must reject its arguments. Returns the message.
fn rejected(arguments: &[&str]) -> String {
    let (status, text, message) = rpi_texts(arguments);
    assert_eq!(status, 2, "{arguments:?}: {message}{text}");
    message
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// Cuts a recording. Returns the new file.
fn cut(file: &Path, name: &str, options: &[&str]) -> PathBuf {
    let out = file.with_file_name(name);
    let mut arguments = vec!["recording", "cut", text(file), "--out", text(&out)];
    arguments.extend(options);
    done(&arguments);
    out
}

/// Merges two recordings. Returns what the tool prints.
fn merge(recordings: [&Path; 2], out: &Path, options: &[&str]) -> String {
    let [one, other] = recordings.map(text);
    let arguments = ["recording", "merge", one, other, "--out", text(out)];
    done(&[&arguments, options].concat())
}

/// Records an example in which commands follow one another, so that most of them have ended at the end.
fn blended(profile: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let (file, _) = record(folder.path(), &["--profile", profile, "--time", "25s"]);
    (folder, file)
}

/// Returns the columns of a table that have a value, by name.
fn table(arguments: &[&str]) -> BTreeMap<String, Vec<String>> {
    let table = done(&[&["export"], arguments].concat());
    let mut rows = table
        .lines()
        .map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
    let names = rows.next().unwrap();
    let rows: Vec<Vec<String>> = rows.collect();
    let column = |k: usize| rows.iter().map(|row| row[k].clone()).collect::<Vec<_>>();
    let columns = names
        .into_iter()
        .enumerate()
        .map(|(k, name)| (name, column(k)));
    // A command that does not exist in a part has no ports in it.
    columns
        .filter(|(_, values)| values.iter().any(|value| !value.is_empty()))
        .collect()
}

/// Returns topic and time of each message in a file, by topic, as any reader of MCAP finds them.
fn messages(file: &Path) -> BTreeMap<String, Vec<u64>> {
    let bytes = std::fs::read(file).unwrap();
    let mut times = BTreeMap::<String, Vec<u64>>::new();
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        let topic = message.channel.topic.clone();
        times.entry(topic).or_default().push(message.log_time);
    }
    times
}

#[test]
fn a_part_from_the_beginning_on_is_replayed_to_its_end() {
    let (_folder, file) = blended("json");
    for to in ["1ms", "3s", "9876ms", "20s"] {
        let part = cut(&file, "part.mcap", &["--to", to]);
        let (status, report) = replay(&part);
        assert_eq!(status, Some(0), "{to}: {report}");
        assert!(report.contains("the same bits throughout"), "{report}");
        assert!(
            table(&[text(&part)]) == table(&[text(&file), "--to", to]),
            "{to}"
        );
    }
    let whole = cut(&file, "whole.mcap", &[]);
    assert_eq!(replay(&whole), replay(&file));
}

/// The commands of a part are those that exist in it, so that their images have other numbers than before.
#[test]
fn a_later_part_has_the_values_of_its_time() {
    let (_folder, file) = blended("foxglove");
    for (from, to) in [
        ("1ms", "2ms"),
        ("2500ms", "7s"),
        ("13s", "21003ms"),
        ("20s", "100s"),
    ] {
        let time = ["--from", from, "--to", to];
        let part = cut(&file, "part.mcap", &time);
        let whole = table(&[&[text(&file)], &time[..]].concat());
        assert!(table(&[text(&part)]) == whole, "{time:?}");
        let info = done(&["recording", "info", text(&part), "--json"]);
        let info: serde_json::Value = serde_json::from_str(&info).unwrap();
        assert_eq!(info["replayable"], false, "{info}");
        let page = file.with_file_name("page.html");
        done(&["view", text(&part), "--report", text(&page)]);
    }
    let first = cut(&file, "first.mcap", &["--from", "5s", "--to", "15s"]);
    let second = cut(&first, "second.mcap", &["--from", "10s", "--to", "12s"]);
    let at_once = cut(&file, "once.mcap", &["--from", "10s", "--to", "12s"]);
    let tables = [second, at_once].map(|part| table(&[text(&part)]));
    assert!(tables[0] == tables[1]);
}

#[test]
fn a_later_part_is_not_replayed_and_the_message_says_what_to_do() {
    let (_folder, file) = blended("json");
    let part = cut(&file, "part.mcap", &["--from", "2s", "--to", "3s"]);
    let part = text(&part);
    for arguments in [
        vec!["replay", part],
        vec!["why", part, "MoveToA.way.zone"],
        vec!["debug", part],
        vec!["export", part, "--watch", "MoveToA.way"],
    ] {
        let message = rejected(&arguments);
        let expected = "begins 2.000 s after the start of the run and cannot be replayed";
        assert!(message.contains(expected), "{message}");
        assert!(
            message.contains("rpi recording cut FILE --to TIME"),
            "{message}"
        );
    }
}

#[test]
fn viewers_find_the_robot_at_the_beginning_of_a_part() {
    for profile in ["ros2", "foxglove"] {
        let (_folder, file) = blended(profile);
        let part = cut(&file, "part.mcap", &["--from", "2s", "--to", "3s"]);
        let (all, kept) = (messages(&file), messages(&part));
        let start = all["/joint_states"][2000];
        assert_eq!(kept["/robot_description"], [start], "{profile}");
        assert_eq!(kept["/joint_states"], all["/joint_states"][2000..3000]);
        let in_time = |times: &Vec<u64>| {
            times
                .iter()
                .all(|t| (start..start + 1_000_000_000).contains(t))
        };
        assert!(kept.values().all(in_time), "{profile}");
    }
}

#[test]
fn parts_and_recordings_that_were_cut_off_are_cut_like_others() {
    let folder = tempfile::tempdir().unwrap();
    let (file, _) = record(folder.path(), &["--part-time", "2s", "--time", "9s"]);
    assert!(folder.path().join("out.0003.mcap").exists());
    let part = cut(&file, "part.mcap", &["--to", "7s"]);
    assert_eq!(replay(&part).0, Some(0));
    // The end of the last file is missing.
    let last = folder.path().join("out.0003.mcap");
    let bytes = std::fs::read(&last).unwrap();
    std::fs::write(&last, &bytes[..bytes.len() / 2]).unwrap();
    let part = cut(&file, "part.mcap", &["--to", "4500ms"]);
    assert_eq!(replay(&part).0, Some(0));
    let part = cut(&file, "part.mcap", &[]);
    let (status, report) = replay(&part);
    assert!(
        status == Some(1) && report.contains("the recording is cut off"),
        "{report}"
    );
    // A damaged file is reported, and no incomplete recording is left.
    std::fs::remove_file(&part).unwrap();
    let mut bytes = std::fs::read(&file).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    std::fs::write(&file, bytes).unwrap();
    let message = rejected(&["recording", "cut", text(&file), "--out", text(&part)]);
    assert!(message.contains("RPI9021") && !part.exists(), "{message}");
}

#[test]
fn a_cut_needs_cycles_and_a_file_of_its_own() {
    let (_folder, file) = blended("json");
    let before = std::fs::read(&file).unwrap();
    let out = file.with_file_name("part.mcap");
    let none = [
        "recording",
        "cut",
        text(&file),
        "--from",
        "40s",
        "--out",
        text(&out),
    ];
    assert!(rejected(&none).contains("no cycles in this time"));
    assert!(!out.exists());
    let none = [
        "recording",
        "cut",
        text(&file),
        "--from",
        "2s",
        "--to",
        "1s",
        "--out",
        text(&out),
    ];
    assert!(rejected(&none).contains("--from must be before --to"));
    let same = ["recording", "cut", text(&file), "--out", text(&file)];
    assert!(rejected(&same).contains("cannot overwrite the input file"));
    let same = [
        "recording",
        "merge",
        text(&file),
        text(&file),
        "--out",
        text(&file),
    ];
    assert!(rejected(&same).contains("cannot overwrite the input file"));
    assert!(std::fs::read(&file).unwrap() == before);
}

#[test]
fn merged_recordings_have_all_messages_on_one_time_axis() {
    let folder = tempfile::tempdir().unwrap();
    let (one, _) = record(folder.path(), &["--profile", "ros2", "--time", "2s"]);
    let other = cut(&one, "other-arm.mcap", &["--from", "1s", "--to", "1500ms"]);
    let out = folder.path().join("merged.mcap");
    let report = merge([&one, &other], &out, &[]);
    assert!(
        report.contains("renamed /other_arm/joint_states\n"),
        "{report}"
    );
    let merged = messages(&out);
    for (file, prefix) in [(&one, "/out"), (&other, "/other_arm")] {
        for (topic, times) in messages(file) {
            // Only the whole recording has the states of devices, which are written when they change.
            let known = merged.get(&format!("{prefix}{topic}"));
            let known = known.or(merged.get(&topic));
            match topic.starts_with("/rpi/") {
                true => assert!(known.is_none() && !merged.contains_key(&topic)),
                false => assert_eq!(known, Some(&times), "{prefix}{topic}"),
            }
        }
    }
    // Events are reported before or after the messages of their cycle; all others are in the order of their times.
    let bytes = std::fs::read(&out).unwrap();
    let messages_in_file = mcap::MessageStream::new(&bytes)
        .unwrap()
        .map(Result::unwrap);
    let states = messages_in_file.filter(|m| m.channel.topic.ends_with("/joint_states"));
    let times: Vec<u64> = states.map(|m| m.log_time).collect();
    assert!(times.is_sorted() && times.len() > 2500, "{}", times.len());
    let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
    let named = |name: &str| summary.metadata_indexes.iter().any(|m| m.name == name);
    assert!(named("out/rpi") && named("other_arm/rpi"));
    // With a common start, both begin with the first one.
    merge([&one, &other], &out, &["--align", "start"]);
    let merged = messages(&out);
    let first = |topic: &str| merged[topic][0];
    assert_eq!(first("/out/joint_states"), first("/other_arm/joint_states"));
}

#[test]
fn a_merged_recording_is_for_viewers() {
    let folder = tempfile::tempdir().unwrap();
    let (one, _) = record(folder.path(), &["--time", "1s"]);
    let out = folder.path().join("merged.mcap");
    // The same name twice gets a number.
    let report = merge([&one, &one], &out, &[]);
    assert!(report.contains("renamed /out/events\n"), "{report}");
    assert!(report.contains("renamed /out_2/events\n"), "{report}");
    assert!(done(&["recording", "info", text(&out)]).starts_with("merged    out, out\n"));
    for verb in ["replay", "export", "view"] {
        let message = rejected(&[verb, text(&out)]);
        assert!(message.contains("merged from out, out"), "{message}");
    }
    // Without clashing topics, the names stay as they are.
    let program = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/first/first.rpi");
    let first = folder.path().join("first.mcap");
    done(&["run", text(&program), "--record", text(&first)]);
    merge([&one, &first], &out, &[]);
    let merged = messages(&out);
    assert!(
        merged.contains_key("/command/Follow"),
        "{:?}",
        merged.keys()
    );
    assert!(merged.contains_key("/first/events"));
}
