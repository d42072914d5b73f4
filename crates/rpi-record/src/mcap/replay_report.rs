//! Report on the replay of a recording.

use std::fmt;

use rpi_words::with_noun;
use serde::Serialize;

/// Result of replaying a recording: counts of the compared data, the reasons for an early end, and the first
/// difference.
#[derive(Clone, PartialEq, Eq, Debug, Default, Serialize)]
pub struct ReplayReport {
    /// Number of ticks that were replayed.
    pub ticks: u64,
    /// Number of commands that were started.
    pub commands: u64,
    /// Number of values of flows, set-points and ports that were compared.
    pub values: u64,
    /// Number of events that were compared.
    pub events: u64,
    /// Number of ticks that are missing in the recording. The replay ends before the first of them.
    pub lost: u64,
    /// Number of the first tick in which a device was inserted or removed; `None` if there is none. The replay ends
    /// there, because the recording does not store the device.
    pub devices: Option<u64>,
    /// Reason why the recording has no end: it was cut off when the process was killed, or the disk was full. `None`
    /// for a complete recording.
    pub cut: Option<String>,
    /// Version of the elementary functions of the recording, 0 for those of libm; `None` if they are the present ones.
    pub functions: Option<u32>,
    /// First difference between the recording and the replay; `None` if there is none.
    pub difference: Option<Difference>,
}

/// Difference between a recording and its replay: the place, the recorded value and the replayed one.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct Difference {
    /// Number of the tick in which the replayed value first differs from the recorded one.
    pub tick: u64,
    /// Name of the command or device whose value differs.
    pub of: String,
    /// Name of the flow, port or event that differs.
    pub what: String,
    /// Value in the recording, as JSON text or words.
    pub recorded: String,
    /// Value that the replay computes in place of the recorded one, as JSON text or words.
    pub now: String,
}

impl ReplayReport {
    /// Returns true if the recording is complete and the replay had no difference.
    #[must_use]
    pub fn agrees(&self) -> bool {
        self.difference.is_none() && self.lost == 0 && self.devices.is_none() && self.cut.is_none()
    }

    /// Returns the report as one indented JSON object.
    #[must_use]
    pub fn to_json(&self) -> String {
        // Serialising strings and numbers cannot fail.
        serde_json::to_string_pretty(self).unwrap_or_default()
    }
}

impl fmt::Display for ReplayReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ReplayReport {
            ticks,
            commands,
            values,
            events,
            ..
        } = self;
        let counts = [
            with_noun(ticks, "tick"),
            with_noun(commands, "command"),
            with_noun(values, "value"),
            with_noun(events, "event"),
        ];
        writeln!(f, "{}", counts.join(", "))?;
        if self.lost > 0 {
            writeln!(
                f,
                "the recording has lost {}: later ticks are not replayed",
                with_noun(self.lost, "tick")
            )?;
        }
        if let Some(tick) = self.devices {
            writeln!(
                f,
                "a device was inserted or removed in tick {tick}: later ticks are not replayed"
            )?;
        }
        if let Some(why) = &self.cut {
            writeln!(f, "the recording is cut off after these ticks: {why}")?;
        }
        if let (Some(_), Some(version)) = (&self.difference, self.functions) {
            writeln!(
                f,
                "the recording was made with version {version} of sin, exp and others, this is version {}: \
                 the last bits of their values differ",
                rpi_math::REVISION
            )?;
        }
        match &self.difference {
            Some(difference) => write!(f, "{difference}"),
            None if !self.agrees() => writeln!(f, "the same bits up to there"),
            None => writeln!(f, "the same bits throughout"),
        }
    }
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "DIFFERENT from tick {} on: {} of {}",
            self.tick, self.what, self.of
        )?;
        writeln!(f, "  recorded  {}", self.recorded)?;
        writeln!(f, "  now       {}", self.now)
    }
}
