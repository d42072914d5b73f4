//! Options of the guard, common to `rpi run` and `rpi serve`.

use std::time::Duration;

use clap::Args;

/// Options of the guard, common to `rpi run` and `rpi serve`.
#[derive(Args, Debug)]
pub(crate) struct GuardArgs {
    /// Run the control core in a process of its own, which this process watches: if the core crashes or stalls, its
    /// recording is completed, the terminal reports the reason, and the exit status is 4.
    #[arg(long, help_heading = "Guard")]
    guard: bool,
    /// Start the control core again after a crash or a stall, at most three times in a minute; implies --guard. The
    /// recording of the previous core is kept as out.crash-1.mcap, ...
    #[arg(long, help_heading = "Guard")]
    restart: bool,
    /// Time without a cycle after which the control core counts as stalled and is ended, at least 100ms.
    #[arg(long, value_name = "TIME", value_parser = stall_timeout, default_value = "2s", help_heading = "Guard")]
    stall_timeout: u64,
    /// The process is the control core of a guard, to which its standard input is connected.
    #[arg(long, hide = true)]
    pub(crate) guarded: bool,
    /// An emergency stop is in force from the start, because it was in force when the previous core crashed.
    #[arg(long, hide = true, requires = "guarded")]
    pub(crate) emergency_stopped: bool,
}

impl GuardArgs {
    /// Returns whether this process is to be the guard.
    pub(crate) fn is_guard(&self) -> bool {
        (self.guard || self.restart) && !self.guarded
    }

    /// Returns whether the control core is started again after a crash.
    pub(crate) fn restarts(&self) -> bool {
        self.restart
    }

    /// Returns the time without a cycle after which the control core counts as stalled.
    pub(crate) fn stall_timeout(&self) -> Duration {
        Duration::from_nanos(self.stall_timeout)
    }
}

/// Shortest time in nanoseconds after which a core may count as stalled. The core reports its cycles every 20 ms.
const MIN_STALL_NS: u64 = 100_000_000;

fn stall_timeout(text: &str) -> Result<u64, String> {
    let time = rpi_driver::parse_duration(text).map_err(|why| why.to_string())?;
    match time >= MIN_STALL_NS {
        true => Ok(time),
        false => Err("expected a time of at least 100ms".to_owned()),
    }
}
