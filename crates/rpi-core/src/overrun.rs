//! Overruns: cycles of a command that take too long, their statistics and the reaction to them.
//!
//! The core has no clock. The caller measures time and reports an overrun after a tick, with the command that took the
//! longest.

use core::fmt;
use core::str::FromStr;

use crate::command::{AbortReason, Command};
use crate::control_core::Core;
use crate::ids::CommandId;
use rpi_device::DeviceBank;

/// Reaction to overruns of a command: cycles that end after the next tick is due. Overruns are counted in any case.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum CommandOverrunPolicy {
    /// Counts the overruns without any other reaction.
    #[default]
    Count,
    /// Aborts the command when the threshold is reached. Its devices stop on their own; other commands continue.
    Abort(OverrunThreshold),
    /// Aborts all commands when the threshold is reached. For cells whose devices must move in step.
    Stop(OverrunThreshold),
}

/// Threshold of an overrun policy: a number of overruns within a number of latest cycles of a command.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct OverrunThreshold {
    overruns: u32,
    window: u32,
}

impl OverrunThreshold {
    /// Maximum number of cycles in which overruns are counted for a threshold: the bits of a `u64`.
    pub const MAX_WINDOW: u32 = 64;

    /// Threshold that a single overrun reaches.
    pub const FIRST_OVERRUN: OverrunThreshold = OverrunThreshold {
        overruns: 1,
        window: 1,
    };

    /// Creates a threshold of `overruns` overruns within the latest `of` cycles; `None` unless 1 <= `overruns` <= `of`
    /// <= [`OverrunThreshold::MAX_WINDOW`].
    #[must_use]
    pub fn new(overruns: u32, of: u32) -> Option<OverrunThreshold> {
        let sound = (1..=of).contains(&overruns) && of <= OverrunThreshold::MAX_WINDOW;
        sound.then_some(OverrunThreshold {
            overruns,
            window: of,
        })
    }

    /// True if the latest cycles reach the threshold. Bit 0 of `history` is the latest cycle, bit 1 the one before; a
    /// set bit is an overrun.
    #[must_use]
    pub fn is_reached(self, history: u64) -> bool {
        let latest = history & (u64::MAX >> (OverrunThreshold::MAX_WINDOW - self.window));
        latest.count_ones() >= self.overruns
    }

    /// Parses the suffix of the name of a policy: empty for the first overrun, or `:N/M` for N overruns within M
    /// cycles. `None` if the text has another form.
    #[must_use]
    pub fn parse_suffix(text: &str) -> Option<OverrunThreshold> {
        if text.is_empty() {
            return Some(OverrunThreshold::FIRST_OVERRUN);
        }
        let (overruns, of) = text.strip_prefix(':')?.split_once('/')?;
        OverrunThreshold::new(overruns.parse().ok()?, of.parse().ok()?)
    }
}

impl fmt::Display for OverrunThreshold {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.overruns, self.window)
    }
}

/// Error of parsing an overrun policy: the text is not `count`, `abort` or `stop`, or its threshold is invalid.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ParseOverrunPolicyError;

impl fmt::Display for ParseOverrunPolicyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let most = OverrunThreshold::MAX_WINDOW;
        write!(
            f,
            "expected `count`, `abort`, `stop`, or `abort:N/M`, `stop:N/M` with N of M cycles, M at most {most}"
        )
    }
}

impl core::error::Error for ParseOverrunPolicyError {}

impl FromStr for CommandOverrunPolicy {
    type Err = ParseOverrunPolicyError;

    /// Parses `count`, `abort` (at the first overrun), `abort:3/10` (at the third within ten cycles), `stop` or
    /// `stop:3/10`.
    fn from_str(text: &str) -> Result<Self, ParseOverrunPolicyError> {
        if text == "count" {
            return Ok(CommandOverrunPolicy::Count);
        }
        let of = |name: &str| {
            text.strip_prefix(name)
                .and_then(OverrunThreshold::parse_suffix)
        };
        let abort = of("abort").map(CommandOverrunPolicy::Abort);
        abort
            .or(of("stop").map(CommandOverrunPolicy::Stop))
            .ok_or(ParseOverrunPolicyError)
    }
}

impl fmt::Display for CommandOverrunPolicy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            CommandOverrunPolicy::Count => f.write_str("count"),
            CommandOverrunPolicy::Abort(often) => write!(f, "abort:{often}"),
            CommandOverrunPolicy::Stop(often) => write!(f, "stop:{often}"),
        }
    }
}

/// An overrun: a tick that ended after the next one was due, blamed on the command that took the longest.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Overrun {
    /// Number of the tick whose computation took too long, counted from the creation of the core.
    pub tick: u64,
    /// Computing time of the command, nanoseconds.
    pub took_ns: u64,
    /// Time between the due time of the next tick and the end of this tick, nanoseconds.
    pub late_ns: u64,
    /// Index of the probable place of the overrun: the active fragment of the command whose own steps have the most
    /// work.
    pub fragment: u32,
}

/// Overrun statistics of a command.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct OverrunStats {
    /// Number of cycles of the command that caused an overrun.
    pub count: u64,
    /// The overrun with the longest computing time of the command; `None` without an overrun.
    pub worst: Option<Overrun>,
    /// Overruns of the 64 cycles up to `last_cycle`, as a bit set: bit 0 is cycle `last_cycle`, bit 1 the cycle before.
    history: u64,
    last_cycle: u64,
}

impl OverrunStats {
    /// Records an overrun in the cycle with number `cycle` of the command. All cycles since the previous overrun count
    /// as in time.
    fn record(&mut self, cycle: u64, overrun: Overrun) {
        let since = u32::try_from(cycle.saturating_sub(self.last_cycle)).unwrap_or(u32::MAX);
        self.history = self.history.checked_shl(since).unwrap_or(0) | 1;
        self.last_cycle = cycle;
        self.count += 1;
        if self.worst.is_none_or(|w| overrun.took_ns > w.took_ns) {
            self.worst = Some(overrun);
        }
    }
}

impl Command {
    /// Sets the reaction to overruns of this command. The default is [`CommandOverrunPolicy::Count`].
    pub fn set_overrun_policy(&mut self, policy: CommandOverrunPolicy) {
        self.overrun_policy = policy;
    }

    /// Returns the reaction to overruns of this command.
    #[must_use]
    pub fn overrun_policy(&self) -> CommandOverrunPolicy {
        self.overrun_policy
    }

    /// Returns the number of overruns of the command and the overrun with the longest computing time.
    #[must_use]
    pub fn overrun_stats(&self) -> &OverrunStats {
        &self.overruns
    }
}

impl Core {
    /// Records an overrun of the last tick and applies the policy of the command `id`, which took the longest:
    /// `took_ns` nanoseconds. The tick ended `late_ns` nanoseconds after the next one was due. Returns true if the
    /// caller must abort all commands.
    pub fn report_overrun(
        &mut self,
        id: CommandId,
        (took_ns, late_ns): (u64, u64),
        bank: &mut dyn DeviceBank,
    ) -> bool {
        let tick = self.now().saturating_sub(1);
        let Some(command) = self.command_mut(id) else {
            return false;
        };
        let overrun = Overrun {
            tick,
            took_ns,
            late_ns,
            fragment: command.instance.heaviest_active_fragment(),
        };
        command.overruns.record(command.instance.cycle(), overrun);
        let history = command.overruns.history;
        match command.overrun_policy {
            CommandOverrunPolicy::Abort(often) if often.is_reached(history) => {
                // The abort fails if the command ended in that cycle; then it takes no more time anyway.
                let _ = self.abort(id, AbortReason::Overrun, bank);
                false
            }
            CommandOverrunPolicy::Stop(often) => often.is_reached(history),
            CommandOverrunPolicy::Abort(_) | CommandOverrunPolicy::Count => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::string::ToString;

    fn overrun(took_ns: u64) -> Overrun {
        Overrun {
            tick: 0,
            took_ns,
            late_ns: 1,
            fragment: 0,
        }
    }

    #[test]
    fn policies_are_read_as_they_are_written() {
        for text in ["count", "abort:1/1", "abort:3/10", "stop:2/64"] {
            assert_eq!(
                text.parse::<CommandOverrunPolicy>().unwrap().to_string(),
                text
            );
        }
        assert_eq!(
            "abort".parse(),
            Ok(CommandOverrunPolicy::Abort(OverrunThreshold::FIRST_OVERRUN))
        );
        for bad in ["", "abort:", "stop:0/3", "stop:4/3", "abort:1/65", "stops"] {
            assert_eq!(
                bad.parse::<CommandOverrunPolicy>(),
                Err(ParseOverrunPolicyError),
                "{bad}"
            );
        }
    }

    #[test]
    fn cycles_in_time_are_counted_without_being_told() {
        let often = OverrunThreshold::new(2, 3).unwrap();
        let mut overruns = OverrunStats::default();
        let mut reached = |cycle| {
            overruns.record(cycle, overrun(5));
            often.is_reached(overruns.history)
        };
        // Cycles 1 and 4, 4 and 7 are too far apart; 7 and 9 are not.
        assert_eq!([1, 4, 7, 9].map(&mut reached), [false, false, false, true]);
        assert!(!reached(1 << 40));
        assert_eq!(overruns.count, 5);
    }

    #[test]
    fn the_worst_is_kept() {
        let mut overruns = OverrunStats::default();
        (1..).zip([7, 9, 8]).for_each(|(cycle, took)| {
            overruns.record(cycle, overrun(took));
        });
        assert_eq!(overruns.worst, Some(overrun(9)));
    }
}
