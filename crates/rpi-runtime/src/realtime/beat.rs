//! Tick timer: waits for each tick, measures it and handles overruns.

use std::time::Instant;

use super::clock::{Clock, Pace};
use super::figures::{Figures, Meter};
use super::overrun::{OverrunPolicy, Verdict};

/// A running tick timer. The caller repeats [`Beat::wait`], the work of the tick and [`Beat::over`]. No method
/// allocates.
pub struct Beat {
    clock: Clock,
    meter: Meter,
    policy: OverrunPolicy,
    /// Nanoseconds by which the latest tick ended after the next one was due.
    over: u64,
    /// Nanoseconds by which the latest tick took longer than a period, regardless of when it began.
    excess: u64,
    /// Nanoseconds by which the current tick began too late. `begin` is its start time.
    late: u64,
    begin: Instant,
}

impl Beat {
    /// Starts a timer. Tick 0 is due now; `tick_ns` is the period.
    #[must_use]
    pub fn start(pace: Pace, tick_ns: u64, policy: OverrunPolicy) -> Beat {
        Beat {
            clock: Clock::start(pace, tick_ns),
            meter: Meter::new(pace == Pace::Real),
            policy,
            over: 0,
            excess: 0,
            late: 0,
            begin: Instant::now(),
        }
    }

    /// Restarts the timer: tick 0 is due now.
    pub fn restart(&mut self) {
        self.clock.restart();
    }

    /// Waits until a tick is due. Returns the wall clock of the commands, nanoseconds since the Unix epoch.
    pub fn wait(&mut self, tick: u64) -> i64 {
        self.late = self.clock.wait(tick);
        self.begin = Instant::now();
        self.clock.wall_ns(tick)
    }

    /// Ends the measurement of a tick. Returns true if the overrun policy requires that all commands are ended.
    #[must_use]
    pub fn over(&mut self, tick: u64) -> bool {
        let took = u64::try_from(self.begin.elapsed().as_nanos()).unwrap_or(u64::MAX);
        self.meter.record(took, self.late);
        let over = self.clock.overrun(self.late, took);
        (self.over, self.excess) = (over, took.saturating_sub(self.clock.tick_ns()));
        let overruns = &mut self.meter.overruns;
        match overruns.judge(tick, over, self.clock.tick_ns(), self.policy) {
            Verdict::GoOn => false,
            Verdict::PutOff(periods) => {
                self.clock.put_off(periods);
                false
            }
            Verdict::Stop => true,
        }
    }

    /// Returns the overrun of the latest tick, or `None` if it ended in time.
    ///
    /// The first number is the time in nanoseconds by which the tick ended after the next one was due. The second
    /// number is the time by which it took longer than a period; 0 if it only began too late.
    #[must_use]
    pub fn overrun(&self) -> Option<(u64, u64)> {
        Some((self.over, self.excess)).filter(|(over, _)| *over > 0)
    }

    /// Returns the statistics of the ticks so far.
    #[must_use]
    pub fn figures(&self) -> Figures {
        self.meter.figures()
    }
}
