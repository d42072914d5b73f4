//! Options of the lowering.

use rpi_net::PortRef;
use rpi_prims::CycleTime;

/// Choices of the caller for the translation of a net to an image.
#[derive(Clone, Copy)]
pub struct LowerOptions<'a> {
    /// Period of the command, the time between two of its cycles, in nanoseconds.
    pub period_ns: u64,
    /// Length of a tick, the smallest time step of the core, in nanoseconds. The period is a whole multiple of it, and
    /// values of the source type `time` count ticks.
    pub tick_ns: u64,
    /// Set of values that an observer must be able to read while the image runs.
    pub observe: Observe,
    /// Predicate that is true for out-ports that may be absent although their primitive always outputs a value, because
    /// a replay may force an absent value on them.
    pub may_be_absent: &'a dyn Fn(PortRef) -> bool,
    /// Whether the image has the source location of every operation, for a text that is read by people. Otherwise it has
    /// those of the operations that may fault.
    pub locates_all: bool,
}

/// Set of values that an observer can read while an image runs.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Observe {
    /// Every out-port of every node. Each node has a step of its own, and no pass optimises: for replay, tracing and
    /// debugging.
    All,
    /// Only results, exports and set-points, so that the passes may optimise all other values away.
    Exports,
}

impl LowerOptions<'_> {
    /// Returns the options for normal operation, with a tick as long as the period: only exports, results and
    /// set-points are observable.
    #[must_use]
    pub fn running(period_ns: u64) -> Self {
        LowerOptions {
            period_ns,
            tick_ns: period_ns,
            observe: Observe::Exports,
            may_be_absent: &|_| false,
            locates_all: false,
        }
    }

    /// Returns the options for debugging, with a tick as long as the period: every port is observable.
    #[must_use]
    pub fn observed(period_ns: u64) -> Self {
        LowerOptions {
            observe: Observe::All,
            ..Self::running(period_ns)
        }
    }

    /// Returns the period of the command in seconds.
    #[must_use]
    pub fn dt(&self) -> f64 {
        self.period_ns as f64 / 1e9
    }

    /// Returns the options with a different length of the core's tick, in nanoseconds.
    #[must_use]
    pub fn with_tick(self, tick_ns: u64) -> Self {
        LowerOptions { tick_ns, ..self }
    }

    /// Returns the times of cycle 0, with all clocks at 0, for the evaluation of constant expressions at compile time.
    pub(crate) fn clock(&self) -> CycleTime {
        CycleTime {
            dt: self.dt(),
            tick_ns: self.tick_ns,
            period_ticks: self.period_ns / self.tick_ns.max(1),
            cycle_index: 0,
            net_ns: 0,
            wall_ns: 0,
        }
    }
}
