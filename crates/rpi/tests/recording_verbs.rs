//! `rpi recording info` and `rpi recording recover`, and what `rpi export` selects.

mod support;

use std::path::Path;
use support::rpi_texts;

/// Records the first example. Returns the folder with the file `run.mcap`.
fn recorded() -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("run.mcap").to_str().unwrap().to_owned();
    let program = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/first/first.rpi");
    let (status, _, message) = rpi_texts(&["run", program.to_str().unwrap(), "--record", &file]);
    assert_eq!(status, 0, "{message}");
    (folder, file)
}

#[test]
fn info_says_what_a_recording_has() {
    let (_folder, file) = recorded();
    let (status, text, _) = rpi_texts(&["recording", "info", &file, "--json"]);
    assert_eq!(status, 0);
    let info: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(info["program"], "first.rpi", "{text}");
    assert_eq!(info["devices"], serde_json::json!(["arm"]));
    let command = &info["commands"][0];
    let ticks = (
        command["started"].as_u64().unwrap(),
        command["ended"].as_u64().unwrap(),
    );
    assert!(
        ticks.0 < ticks.1 && ticks.1 < info["end_tick"].as_u64().unwrap(),
        "{text}"
    );
    let size = std::fs::metadata(&file).unwrap().len();
    assert_eq!(info["files"][0]["bytes"], size);
    assert!(info["cut"].is_null());
    let (_, text, _) = rpi_texts(&["recording", "info", &file]);
    assert!(text.starts_with("program   first.rpi\n"), "{text}");
}

#[test]
fn a_recording_that_was_cut_off_is_recovered_once() {
    let (_folder, file) = recorded();
    let bytes = std::fs::read(&file).unwrap();
    std::fs::write(&file, &bytes[..bytes.len() * 3 / 4]).unwrap();
    let (_, text, _) = rpi_texts(&["recording", "info", &file]);
    assert!(text.contains("\ncut off"), "{text}");
    let (status, text, message) = rpi_texts(&["recording", "recover", &file]);
    assert!(
        status == 0 && text.contains("recovered, with"),
        "{text}{message}"
    );
    assert!(std::fs::read(&file).unwrap().ends_with(b"\x89MCAP0\r\n"));
    let (_, text, _) = rpi_texts(&["recording", "recover", &file]);
    assert!(text.contains("complete already"), "{text}");
    let (status, text, message) = rpi_texts(&["replay", &file]);
    // What was lost is said; up to there, the replay has the same bits.
    assert!(
        status == 1 && text.contains("the same bits up to there"),
        "{text}{message}"
    );
}

#[test]
fn a_file_that_is_no_recording_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("notes.mcap");
    std::fs::write(&file, "notes").unwrap();
    for verb in ["info", "recover"] {
        let (status, _, message) = rpi_texts(&["recording", verb, file.to_str().unwrap()]);
        assert!(status == 2 && message.contains("notes.mcap"), "{message}");
        assert_eq!(std::fs::read(&file).unwrap(), b"notes");
    }
    let (status, _, message) = rpi_texts(&["recording", "info", "absent.mcap"]);
    assert!(status == 2 && message.contains("absent.mcap"), "{message}");
}

#[test]
fn export_selects_columns_and_times() {
    let (_folder, file) = recorded();
    let column = "/set_points/arm/joints[3]";
    let (status, table, message) = rpi_texts(&[
        "export", &file, "--column", column, "--from", "100ms", "--to", "200ms",
    ]);
    assert_eq!(status, 0, "{message}");
    let mut lines = table.lines();
    assert_eq!(
        lines.next(),
        Some("tick,time [s],/set_points/arm/joints[3] [rad]")
    );
    assert_eq!(lines.clone().count(), 100);
    let first: Vec<&str> = lines.next().unwrap().split(',').collect();
    assert_eq!(first[..2], ["100", "0.100000000"]);
    assert!(first[2].parse::<f64>().is_ok());
    let (status, _, message) = rpi_texts(&["export", &file, "--column", "/set_points/arn"]);
    assert!(
        status == 2 && message.contains("did you mean `/set_points/arm"),
        "{message}"
    );
}
