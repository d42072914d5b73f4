//! Options of a recording, common to `rpi run` and `rpi serve`, and the recordings that they create.

use std::fs::File;
use std::path::Path;
use std::time::Duration;

use clap::Args;
use rpi_record::mcap::{PartLimits, Profile, RecordingOptions, RunSources, part_files};

/// Options of a recording, common to `rpi run` and `rpi serve`.
#[derive(Args, Debug)]
pub(crate) struct RecordingArgs {
    /// Encoding of a recording for viewers: `json`, `ros2` (all messages as ROS 2 messages, with /joint_states, /tf and
    /// /robot_description) or `foxglove` (JSON, with these topics in the schemas of Foxglove).
    #[arg(long, value_name = "NAME", value_parser = profile, default_value = "json", help_heading = "Recording")]
    profile: Profile,
    /// Begin a new file when the current file of a recording has reached this size: out.mcap, out.0002.mcap, ...
    #[arg(long, value_name = "SIZE", value_parser = size, help_heading = "Recording")]
    part_size: Option<u64>,
    /// Begin a new file when the current file of a recording covers this time, such as 10s.
    #[arg(long, value_name = "TIME", value_parser = rpi_driver::parse_duration, help_heading = "Recording")]
    part_time: Option<u64>,
}

impl RecordingArgs {
    /// Returns the options of a recording to the file `path`, which is already open as `first`. `origin` is what the
    /// recording contains about the program and the cell.
    pub(crate) fn options(
        &self,
        (path, first): (&Path, File),
        origin: RunSources,
    ) -> RecordingOptions {
        RecordingOptions {
            parts: part_files(path, first),
            limits: PartLimits {
                bytes: self.part_size,
                time: self.part_time.map(Duration::from_nanos),
            },
            profile: self.profile,
            origin,
        }
    }

    /// Returns true if an option is present that only recordings in the format MCAP have.
    pub(crate) fn needs_mcap(&self) -> bool {
        self.profile != Profile::default() || self.part_size.is_some() || self.part_time.is_some()
    }
}

fn profile(name: &str) -> Result<Profile, String> {
    Profile::from_name(name).ok_or_else(|| {
        let known = Profile::ALL.map(|(name, _)| name);
        format!("expected one of {}", known.join(", "))
    })
}

/// Units of sizes, each with its number of bytes.
const UNITS: [(&str, u64); 7] = [
    ("B", 1),
    ("kB", 1_000),
    ("MB", 1_000_000),
    ("GB", 1_000_000_000),
    ("KiB", 1 << 10),
    ("MiB", 1 << 20),
    ("GiB", 1 << 30),
];

/// Parses a size in bytes: a whole number with a unit, as in `500MB`. Returns a message for any other text.
fn size(text: &str) -> Result<u64, String> {
    let unit = text.trim_start_matches(|c: char| c.is_ascii_digit());
    let number = text[..text.len() - unit.len()].parse::<u64>().ok();
    let factor = UNITS.iter().find(|(name, _)| *name == unit.trim());
    let size = number
        .zip(factor)
        .and_then(|(number, (_, factor))| number.checked_mul(*factor));
    size.filter(|size| *size > 0).ok_or_else(|| {
        let units = UNITS.map(|(name, _)| name);
        format!(
            "expected a whole number above 0 with one of the units {}, as in 500MB",
            units.join(", ")
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_have_a_unit() {
        assert_eq!(size("500MB"), Ok(500_000_000));
        assert_eq!(size("2 GiB"), Ok(2 << 30));
        for text in [
            "",
            "5",
            "MB",
            "0MB",
            "-1MB",
            "1.5MB",
            "99999999999GB",
            "5 mb",
        ] {
            assert!(size(text).is_err(), "{text}");
        }
    }
}
