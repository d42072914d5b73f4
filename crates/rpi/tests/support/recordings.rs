//! Recordings of the blending example and their replays.

use std::path::{Path, PathBuf};

use super::{output_text, rpi};

pub(crate) fn blending() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/blending/blending.rpi")
}

/// Records the example. Returns the file and the output of the tool.
pub(crate) fn record(folder: &Path, options: &[&str]) -> (PathBuf, String) {
    let (program, file) = (blending(), folder.join("out.mcap"));
    let mut arguments = vec!["run", program.to_str().unwrap()];
    arguments.extend(["--record", file.to_str().unwrap()]);
    arguments.extend(options);
    let output = rpi(&arguments);
    assert_eq!(output.status.code(), Some(0), "{}", output_text(&output));
    (file, output_text(&output))
}

pub(crate) fn replay(file: &Path) -> (Option<i32>, String) {
    let output = rpi(&["replay", file.to_str().unwrap()]);
    (output.status.code(), output_text(&output))
}

/// Replays a recording that was cut off. Returns the number of ticks before the cut.
pub(crate) fn ticks_up_to_the_cut(file: &Path) -> u64 {
    let (code, report) = replay(file);
    assert_eq!(code, Some(1), "{report}");
    assert!(report.contains("the recording is cut off"), "{report}");
    assert!(report.contains("the same bits up to there"), "{report}");
    report.split(' ').next().unwrap().parse().unwrap()
}
