//! Text output of an outcome.

use std::fmt;

use rpi_words::{times, with_noun};

use super::outcome::{
    CommandEnd, CommandOverruns, DeviceEnd, DeviceProblem, Outcome, ProblemPlace, RunEnd,
};
use crate::realtime::Percentiles;

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let width = self.commands.iter().map(|c| c.name.chars().count()).max();
        if self.unlisted > 0 {
            writeln!(f, "{} before these", with_noun(self.unlisted, "command"))?;
        }
        for command in &self.commands {
            self.command(f, command, width.unwrap_or(0))?;
        }
        let ticks = with_noun(self.figures.ticks, "tick");
        if self.cut_off {
            writeln!(f, "cut off after {ticks}, as asked for")?;
        }
        if let Some(why) = &self.stopped {
            writeln!(f, "STOPPED after {ticks}: {why}")?;
        }
        if self.late > 0 {
            writeln!(
                f,
                "{} a successor came after its predecessor had ended, {} too late to take over in motion",
                times(self.late),
                times(self.missed)
            )?;
        }
        self.statistics(f)?;
        self.timing(f)?;
        for grant in &self.grants {
            writeln!(f, "  {grant}")?;
        }
        for device in &self.devices {
            write!(f, "{device}")?;
        }
        self.written(f)
    }
}

impl Outcome {
    /// Prints the durations, delays and overruns of the ticks.
    fn timing(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "cycle time  {}", self.figures.tick)?;
        if let Some(lateness) = &self.figures.lateness {
            writeln!(f, "late by     {lateness}")?;
        }
        if let Some(overruns) = self.figures.overruns.filter(|o| o.count > 0) {
            write!(f, "overruns    {}", overruns.count)?;
            let (first, longest) = (
                overruns.first.unwrap_or(0),
                format_duration(overruns.longest),
            );
            write!(f, ", first in tick {first}, at most {longest} too late")?;
            match overruns.skipped {
                0 => writeln!(f)?,
                skipped => writeln!(f, ", {} skipped", with_noun(skipped, "period"))?,
            }
        }
        Ok(())
    }

    /// Prints the digest of the device values and the statistics of the recording, if there are any.
    fn written(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(digest) = &self.digest {
            writeln!(f, "digest      {digest}")?;
        }
        if let Some(recorded) = &self.recorded {
            writeln!(
                f,
                "recorded    {}, {} lost",
                with_noun(recorded.ticks, "tick"),
                recorded.lost
            )?;
        }
        if let Some(why) = &self.unrecorded {
            writeln!(f, "NOT RECORDED to the end: {why}")?;
        }
        match self.samples_lost {
            0 => Ok(()),
            lost => writeln!(
                f,
                "lost        {}: the recording could not keep up",
                with_noun(lost, "sample")
            ),
        }
    }

    fn command(
        &self,
        f: &mut fmt::Formatter<'_>,
        command: &CommandEnd,
        width: usize,
    ) -> fmt::Result {
        let seconds = |ticks: u64| ticks as f64 * self.tick_ns as f64 * 1e-9;
        write!(f, "{:width$}  {}", command.name, command.end)?;
        if command.handled {
            f.write_str(", handled by its task")?;
        }
        if !command.braked.is_empty() {
            write!(f, ", and {} braked", command.braked.join(", "))?;
        }
        match command.first_tick {
            None => writeln!(f)?,
            Some(first) => {
                let (cycles, from) = (with_noun(command.cycles, "cycle"), seconds(first));
                writeln!(f, "; {cycles} from {from:.3} s on")?;
            }
        }
        if let Some(blame) = &command.overruns {
            writeln!(f, "{:width$}  {blame}", "")?;
        }
        let jump = command.jump.iter();
        jump.into_iter()
            .try_for_each(|jump| writeln!(f, "{:width$}  at the takeover the {jump}", ""))
    }
}

impl fmt::Display for CommandOverruns {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (took, late) = (format_duration(self.took_ns), format_duration(self.late_ns));
        let (count, tick) = (with_noun(self.count, "tick"), self.tick);
        write!(
            f,
            "took too long in {count}, the longest {took} in tick {tick}"
        )?;
        if !self.fragment.is_empty() {
            write!(f, ", in {}", self.fragment)?;
        }
        write!(f, ", which ended {late} too late")
    }
}

impl fmt::Display for RunEnd {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RunEnd::Result {
                name,
                moving: false,
            } => write!(f, "finished with {name}"),
            RunEnd::Result { name, moving: true } => write!(f, "taken over at {name}"),
            RunEnd::Terminated => f.write_str("terminated without error"),
            RunEnd::Error {
                number,
                name: Some(name),
            } => write!(f, "FAILED with {name} (error {number})"),
            RunEnd::Error { number, name: None } => write!(f, "FAILED with error {number}"),
            RunEnd::Fault {
                what, place, at, ..
            } => {
                let at = at.as_deref();
                let places = [Some(&place[..]).filter(|place| !place.is_empty()), at];
                let places: Vec<&str> = places.into_iter().flatten().collect();
                match &places[..] {
                    [] => write!(f, "FAULT: {what}"),
                    places => write!(f, "FAULT at {}: {what}", places.join(", ")),
                }
            }
            RunEnd::CutOff => f.write_str("cut off"),
            RunEnd::Stopped { why } => write!(f, "STOPPED: {why}"),
            RunEnd::Refused { why } => write!(f, "REFUSED: {why}"),
        }
    }
}

impl fmt::Display for Percentiles {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [p50, p99, max] = [self.p50, self.p99, self.max].map(format_duration);
        write!(f, "p50 {p50}, p99 {p99}, max {max}")
    }
}

/// Formats a duration in nanoseconds with three significant digits and a unit, as in `1.25 ms`.
pub(crate) fn format_duration(nanos: u64) -> String {
    let (value, unit) = match nanos {
        0..1_000 => return format!("{nanos} ns"),
        1_000..1_000_000 => (nanos as f64 / 1e3, "us"),
        1_000_000..1_000_000_000 => (nanos as f64 / 1e6, "ms"),
        _ => (nanos as f64 / 1e9, "s"),
    };
    let decimals = if value < 10.0 {
        2
    } else {
        usize::from(value < 100.0)
    };
    format!("{value:.decimals$} {unit}")
}

impl fmt::Display for DeviceEnd {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rest = if self.moving {
            "still moving"
        } else {
            "at rest"
        };
        writeln!(f, "{}: {}, {rest}", self.name, self.condition)?;
        self.troubles
            .iter()
            .try_for_each(|error| writeln!(f, "  {error}"))
    }
}

impl fmt::Display for DeviceProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.what)?;
        if let Some(axis) = self.axis {
            write!(f, " at axis {axis}")?;
        }
        match self.times {
            1 => write!(f, ", at {:.3} s", self.first)?,
            times => write!(f, ", {times} times, first at {:.3} s", self.first)?,
        }
        let (value, limit) = (self.value, self.limit);
        match self.place {
            ProblemPlace::OnPath => write!(f, ": {value:.4} m along a path of {limit:.4} m"),
            ProblemPlace::OffPath if value.is_nan() => {
                write!(
                    f,
                    ": the path of length {limit:.6} has no such point or zone"
                )
            }
            ProblemPlace::OffPath => write!(f, ": {value:.6} on a path of length {limit:.6}"),
            ProblemPlace::Ahead => write!(f, ": at {value:.4}, the motion came to {limit:.4}"),
            ProblemPlace::None if limit != 0.0 => {
                write!(f, ": {value:.4} where {limit:.4} is the limit")
            }
            ProblemPlace::None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_three_digits() {
        assert_eq!(
            [999, 1_234, 23_456, 999_000_000].map(format_duration),
            ["999 ns", "1.23 us", "23.5 us", "999 ms"]
        );
    }
}
