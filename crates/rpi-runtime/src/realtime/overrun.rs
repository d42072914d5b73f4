//! Overruns: ticks that end after the next one was due.

use std::fmt;
use std::str::FromStr;

use rpi_core::OverrunThreshold;
use serde::Serialize;

/// Reaction to an overrun: a tick that ends after the next one was due. Every policy counts overruns.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum OverrunPolicy {
    /// Overdue ticks run immediately, with less than a period between them, until the delay is caught up. No tick is
    /// dropped.
    #[default]
    CatchUp,
    /// All later ticks are postponed by whole periods, so that no tick begins late because of the overrun.
    Skip,
    /// All commands are aborted and their devices brake once the threshold is reached: a number of overruns within a
    /// number of latest ticks. Until then overdue ticks run immediately.
    Stop(OverrunThreshold),
}

/// Error: a text is not the name of an overrun policy.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ParseOverrunPolicyError;

impl fmt::Display for ParseOverrunPolicyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let most = OverrunThreshold::MAX_WINDOW;
        write!(
            f,
            "expected `catch-up`, `skip`, `stop` or `stop:N/M` (N overruns in M cycles, M at most {most})"
        )
    }
}

impl std::error::Error for ParseOverrunPolicyError {}

impl FromStr for OverrunPolicy {
    type Err = ParseOverrunPolicyError;

    /// Parses `catch-up`, `skip`, `stop` (at the first overrun) or `stop:N/M` (at N overruns within M cycles).
    fn from_str(text: &str) -> Result<Self, ParseOverrunPolicyError> {
        match text {
            "catch-up" => return Ok(OverrunPolicy::CatchUp),
            "skip" => return Ok(OverrunPolicy::Skip),
            _ => {}
        }
        text.strip_prefix("stop")
            .and_then(OverrunThreshold::parse_suffix)
            .map(OverrunPolicy::Stop)
            .ok_or(ParseOverrunPolicyError)
    }
}

impl fmt::Display for OverrunPolicy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            OverrunPolicy::CatchUp => f.write_str("catch-up"),
            OverrunPolicy::Skip => f.write_str("skip"),
            OverrunPolicy::Stop(often) => write!(f, "stop:{often}"),
        }
    }
}

/// Statistics of the overruns of a run: ticks that ended after the next one was due. Counting neither allocates nor
/// fails.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Serialize)]
pub struct OverrunStats {
    /// Number of overruns.
    pub count: u64,
    /// Number of the tick of the first overrun, from 0; `None` if there was none.
    pub first: Option<u64>,
    /// Longest time in nanoseconds by which a tick ended after the next one was due.
    pub longest: u64,
    /// Total number of periods by which later ticks were postponed because of overruns.
    pub skipped: u64,
    /// Bits of the last 64 ticks, 1 for an overrun; the latest tick is the lowest bit.
    #[serde(skip)]
    history: u64,
}

/// Action that the overrun policy requires after a tick.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum OverrunAction {
    /// No reaction: the next tick follows as planned.
    Continue,
    /// Postpone all later ticks by this number of periods.
    Postpone(u64),
    /// Abort all commands.
    Stop,
}

impl OverrunStats {
    /// Counts the tick with this number, which ended `over` nanoseconds after the next one was due (0 if it ended in
    /// time). Returns the action that the policy requires.
    pub(super) fn record(
        &mut self,
        tick: u64,
        over: u64,
        tick_ns: u64,
        policy: OverrunPolicy,
    ) -> OverrunAction {
        self.history = self.history << 1 | u64::from(over > 0);
        if over == 0 {
            return OverrunAction::Continue;
        }
        self.count += 1;
        self.first.get_or_insert(tick);
        self.longest = self.longest.max(over);
        match policy {
            OverrunPolicy::CatchUp => OverrunAction::Continue,
            OverrunPolicy::Skip => {
                let periods = over.div_ceil(tick_ns.max(1));
                self.skipped += periods;
                OverrunAction::Postpone(periods)
            }
            OverrunPolicy::Stop(often) => match often.is_reached(self.history) {
                true => OverrunAction::Stop,
                false => OverrunAction::Continue,
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: u64 = 1_000_000;

    fn judged(policy: &str, overs: &[u64]) -> (Vec<OverrunAction>, OverrunStats) {
        let mut overruns = OverrunStats::default();
        let policy = policy.parse().unwrap();
        let verdicts = (0..)
            .zip(overs)
            .map(|(tick, over)| overruns.record(tick, *over, MS, policy));
        (verdicts.collect(), overruns)
    }

    #[test]
    fn overruns_are_counted_whatever_the_policy() {
        for policy in ["catch-up", "skip", "stop:64/64"] {
            let (_, overruns) = judged(policy, &[0, 5, 0, 700]);
            assert_eq!(
                (overruns.count, overruns.first, overruns.longest),
                (2, Some(1), 700)
            );
        }
    }

    #[test]
    fn skipping_puts_off_by_whole_periods() {
        let (verdicts, overruns) = judged("skip", &[1, MS, MS + 1]);
        assert_eq!(verdicts, [1, 1, 2].map(OverrunAction::Postpone));
        assert_eq!(overruns.skipped, 4);
    }

    #[test]
    fn the_nth_of_the_last_m_stops() {
        let (verdicts, _) = judged("stop:2/3", &[1, 0, 0, 1, 0, 1]);
        assert_eq!(verdicts[..5], [OverrunAction::Continue; 5]);
        assert_eq!(verdicts[5], OverrunAction::Stop);
        assert_eq!(
            judged("stop", &[0, 1]).0,
            [OverrunAction::Continue, OverrunAction::Stop]
        );
    }

    #[test]
    fn what_means_nothing_is_refused_with_the_forms() {
        for bad in ["", "stop:", "stop:0/3", "stop:4/3", "stop:1/65", "halt"] {
            let why = bad.parse::<OverrunPolicy>().unwrap_err().to_string();
            assert!(why.contains("stop:N/M"), "{why}");
        }
        assert_eq!(
            "stop:2/3".parse::<OverrunPolicy>().unwrap().to_string(),
            "stop:2/3"
        );
    }
}
