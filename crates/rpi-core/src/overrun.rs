//! Cycles of a command that take too long: how often, which was the worst, where in the program, and what becomes of it.
//!
//! The core knows no clock. Whoever has one says after a tick that it has ended too late, and which command took the longest.

use core::fmt;
use core::str::FromStr;

use crate::command::{Command, Why};
use crate::commands::Core;
use crate::id::CommandId;
use rpi_device::DeviceBank;

/// What becomes of a command whose cycles take too long. They are counted in any case.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum OnOverrun {
    /// Nothing.
    #[default]
    Count,
    /// It is ended once it was so often; its devices stop on their own. Others run on.
    Abort(Often),
    /// All commands are ended once it was so often, for devices that must keep together.
    Stop(Often),
}

/// So many of the last so many cycles.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Often {
    overruns: u32,
    of: u32,
}

impl Often {
    /// Cycles that can be looked back on.
    pub const LONGEST: u32 = 64;

    /// At once.
    pub const FIRST: Often = Often { overruns: 1, of: 1 };

    /// `overruns` of `of` cycles: at least 1, at most all of them, of [`Often::LONGEST`] at most.
    #[must_use]
    pub fn new(overruns: u32, of: u32) -> Option<Often> {
        let sound = (1..=of).contains(&overruns) && of <= Often::LONGEST;
        sound.then_some(Often { overruns, of })
    }

    /// Whether it was so often; the latest cycle is the lowest bit.
    #[must_use]
    pub fn is_reached(self, history: u64) -> bool {
        let latest = history & (u64::MAX >> (Often::LONGEST - self.of));
        latest.count_ones() >= self.overruns
    }

    /// What stands behind a policy's name: nothing for the first, or `:N/M`.
    #[must_use]
    pub fn after(text: &str) -> Option<Often> {
        if text.is_empty() {
            return Some(Often::FIRST);
        }
        let (overruns, of) = text.strip_prefix(':')?.split_once('/')?;
        Often::new(overruns.parse().ok()?, of.parse().ok()?)
    }
}

impl fmt::Display for Often {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.overruns, self.of)
    }
}

/// No policy has this name.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct NoPolicy;

impl fmt::Display for NoPolicy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let most = Often::LONGEST;
        write!(
            f,
            "expected `count`, `abort`, `stop`, or `abort:N/M`, `stop:N/M` with N of M cycles, M at most {most}"
        )
    }
}

impl core::error::Error for NoPolicy {}

impl FromStr for OnOverrun {
    type Err = NoPolicy;

    /// `count`, `abort` (at the first one), `abort:3/10` (at the third of ten cycles), `stop` and `stop:3/10` alike.
    fn from_str(text: &str) -> Result<Self, NoPolicy> {
        if text == "count" {
            return Ok(OnOverrun::Count);
        }
        let of = |name: &str| text.strip_prefix(name).and_then(Often::after);
        let abort = of("abort").map(OnOverrun::Abort);
        abort.or(of("stop").map(OnOverrun::Stop)).ok_or(NoPolicy)
    }
}

impl fmt::Display for OnOverrun {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            OnOverrun::Count => f.write_str("count"),
            OnOverrun::Abort(often) => write!(f, "abort:{often}"),
            OnOverrun::Stop(often) => write!(f, "stop:{often}"),
        }
    }
}

/// A cycle that took too long.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Overrun {
    /// Its tick.
    pub tick: u64,
    /// How long the command computed, nanoseconds.
    pub took_ns: u64,
    /// By how much the tick ended too late, nanoseconds.
    pub late_ns: u64,
    /// Where it was at work, as an index into the image's fragments: of those that were active the one with the most work of its own.
    pub fragment: u32,
}

/// The cycles of a command that took too long.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Overruns {
    /// How many there were.
    pub count: u64,
    /// The longest of them.
    pub worst: Option<Overrun>,
    /// The last cycles, the latest in the lowest bit, up to the cycle of this number.
    history: u64,
    upto: u64,
}

impl Overruns {
    /// Takes in that the cycle of this number was too long. What lies between it and the one before was in time.
    fn note(&mut self, cycle: u64, overrun: Overrun) {
        let since = u32::try_from(cycle.saturating_sub(self.upto)).unwrap_or(u32::MAX);
        self.history = self.history.checked_shl(since).unwrap_or(0) | 1;
        self.upto = cycle;
        self.count += 1;
        if self.worst.is_none_or(|w| overrun.took_ns > w.took_ns) {
            self.worst = Some(overrun);
        }
    }
}

impl Command {
    /// What becomes of it if its cycles take too long; [`OnOverrun::Count`] unless said.
    pub fn bound_overruns(&mut self, policy: OnOverrun) {
        self.on_overrun = policy;
    }

    /// What becomes of it if its cycles take too long.
    #[must_use]
    pub fn on_overrun(&self) -> OnOverrun {
        self.on_overrun
    }

    /// Its cycles that took too long.
    #[must_use]
    pub fn overruns(&self) -> &Overruns {
        &self.overruns
    }
}

impl Core {
    /// The tick that is over has ended `late_ns` nanoseconds after the next one was due, and this command took the longest in
    /// it, `took_ns`: it is counted, and ended if its policy says so. True if all commands are to be ended.
    pub fn overran(
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
            fragment: command.machine.busiest(),
        };
        command.overruns.note(command.machine.cycle(), overrun);
        let history = command.overruns.history;
        match command.on_overrun {
            OnOverrun::Abort(often) if often.is_reached(history) => {
                // Who has ended in that cycle takes no more time.
                let _ = self.abort(id, Why::Overrun, bank);
                false
            }
            OnOverrun::Stop(often) => often.is_reached(history),
            OnOverrun::Abort(_) | OnOverrun::Count => false,
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
            assert_eq!(text.parse::<OnOverrun>().unwrap().to_string(), text);
        }
        assert_eq!("abort".parse(), Ok(OnOverrun::Abort(Often::FIRST)));
        for bad in ["", "abort:", "stop:0/3", "stop:4/3", "abort:1/65", "stops"] {
            assert_eq!(bad.parse::<OnOverrun>(), Err(NoPolicy), "{bad}");
        }
    }

    #[test]
    fn cycles_in_time_are_counted_without_being_told() {
        let often = Often::new(2, 3).unwrap();
        let mut overruns = Overruns::default();
        let mut reached = |cycle| {
            overruns.note(cycle, overrun(5));
            often.is_reached(overruns.history)
        };
        // Cycles 1 and 4, 4 and 7 lie too far apart; 7 and 9 do not.
        assert_eq!([1, 4, 7, 9].map(&mut reached), [false, false, false, true]);
        assert!(!reached(1 << 40));
        assert_eq!(overruns.count, 5);
    }

    #[test]
    fn the_worst_is_kept() {
        let mut overruns = Overruns::default();
        (1..).zip([7, 9, 8]).for_each(|(cycle, took)| {
            overruns.note(cycle, overrun(took));
        });
        assert_eq!(overruns.worst, Some(overrun(9)));
    }
}
