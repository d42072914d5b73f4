//! Options of the lowering.

use rpi_net::PortRef;
use rpi_prims::CycleTime;

/// Choices of the caller for the lowering of a net to an image.
#[derive(Clone, Copy)]
pub struct LowerOptions<'a> {
    /// Period of the command in nanoseconds.
    pub period_ns: u64,
    /// Length of a tick in nanoseconds. It divides the period, and values of type `time` count it.
    pub tick_ns: u64,
    /// Values that must be observable while the image runs.
    pub observe: Observe,
    /// Ports that may be absent even if their primitive is always present. A replay can force them to be absent.
    pub may_be_absent: &'a dyn Fn(PortRef) -> bool,
}

/// Set of values that can be observed while an image runs.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Observe {
    /// Every port of every node, one step per node: for replay, tracing and debugging.
    All,
    /// Only results, exports and set-points, so that the passes may optimise everything else.
    Exports,
}

impl LowerOptions<'_> {
    /// Options for running: only exports, results and set-points are observable.
    #[must_use]
    pub fn running(period_ns: u64) -> Self {
        LowerOptions {
            period_ns,
            tick_ns: period_ns,
            observe: Observe::Exports,
            may_be_absent: &|_| false,
        }
    }

    /// Options for observing every port.
    #[must_use]
    pub fn observed(period_ns: u64) -> Self {
        LowerOptions {
            observe: Observe::All,
            ..Self::running(period_ns)
        }
    }

    /// Period in seconds.
    #[must_use]
    pub fn dt(&self) -> f64 {
        self.period_ns as f64 / 1e9
    }

    /// The same options with another tick, in nanoseconds.
    #[must_use]
    pub fn with_tick(self, tick_ns: u64) -> Self {
        LowerOptions { tick_ns, ..self }
    }

    /// The values of time flows in cycle 0, which constant folding uses.
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
