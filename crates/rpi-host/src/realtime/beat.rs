//! The beat of a cycle: waits for each tick, measures it, says what becomes of the next ones.

use std::time::Instant;

use super::clock::{Clock, Pace};
use super::figures::{Figures, Meter};
use super::overrun::{OverrunPolicy, Verdict};

/// A beat under way: [`Beat::wait`], the tick's work, [`Beat::over`], and again. Neither allocates.
pub struct Beat {
    clock: Clock,
    meter: Meter,
    policy: OverrunPolicy,
    /// By how much the latest tick ended too late, nanoseconds.
    over: u64,
    /// By how much it was longer than a period itself, however late it began, nanoseconds.
    excess: u64,
    /// How late the present tick began, nanoseconds, and when.
    late: u64,
    begin: Instant,
}

impl Beat {
    /// Tick 0, of a length in nanoseconds, is due now.
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

    /// Begins anew: tick 0 is due now.
    pub fn restart(&mut self) {
        self.clock.restart();
    }

    /// Waits until a tick is due; the wall clock that its commands see, nanoseconds since the Unix epoch.
    pub fn wait(&mut self, tick: u64) -> i64 {
        self.late = self.clock.wait(tick);
        self.begin = Instant::now();
        self.clock.wall_ns(tick)
    }

    /// The tick's work is done. True if it took too long, once too often: then every command is to be ended.
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

    /// By how many nanoseconds the latest tick ended after the next one was due, if it did, and by how many it was longer than a
    /// period itself: 0 where it only began too late.
    #[must_use]
    pub fn overrun(&self) -> Option<(u64, u64)> {
        Some((self.over, self.excess)).filter(|(over, _)| *over > 0)
    }

    /// What was measured so far.
    #[must_use]
    pub fn figures(&self) -> Figures {
        self.meter.figures()
    }
}
