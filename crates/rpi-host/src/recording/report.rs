//! What came of running a recording again.

use std::fmt;

use rpi_diag::counted;
use serde::Serialize;

/// What came of it.
#[derive(Clone, PartialEq, Eq, Debug, Default, Serialize)]
pub struct Rerun {
    /// Ticks that were run.
    pub ticks: u64,
    /// Commands that were started.
    pub commands: u64,
    /// Values of flows, set-points and ports that were compared.
    pub values: u64,
    /// Events that were compared.
    pub events: u64,
    /// Ticks that the recording has lost. Nothing is known of them, nor of what comes after the first of them.
    pub lost: u64,
    /// The first tick in which a device was put in or taken out, if one was. Which one is not recorded: nothing is run from there on.
    pub devices: Option<u64>,
    /// The first thing that was not as recorded.
    pub difference: Option<Difference>,
}

/// Something that was not as recorded.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct Difference {
    /// In which tick.
    pub tick: u64,
    /// Of which command or device.
    pub of: String,
    /// Which flow, port or event.
    pub what: String,
    /// As recorded.
    pub recorded: String,
    /// As it was now.
    pub now: String,
}

impl Rerun {
    /// True if all was as recorded, and all was recorded.
    #[must_use]
    pub fn agrees(&self) -> bool {
        self.difference.is_none() && self.lost == 0 && self.devices.is_none()
    }

    /// The report for programs: one JSON object, indented.
    #[must_use]
    pub fn to_json(&self) -> String {
        // Strings and numbers cannot fail to be written.
        serde_json::to_string_pretty(self).unwrap_or_default()
    }
}

impl fmt::Display for Rerun {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Rerun {
            ticks,
            commands,
            values,
            events,
            ..
        } = self;
        let told = [
            counted(ticks, "tick"),
            counted(commands, "command"),
            counted(values, "value"),
            counted(events, "event"),
        ];
        writeln!(f, "{}", told.join(", "))?;
        if self.lost > 0 {
            writeln!(
                f,
                "the recording has lost {}: what comes after is not known",
                counted(self.lost, "tick")
            )?;
        }
        if let Some(tick) = self.devices {
            writeln!(
                f,
                "devices came or went in tick {tick}: which ones is not recorded"
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
