//! What a lowering is asked for.

use rpi_net::PortRef;
use rpi_prims::Clock;

/// How a net is lowered.
#[derive(Clone, Copy)]
pub struct LowerOptions<'a> {
    /// Period in nanoseconds.
    pub period_ns: u64,
    /// Length of a tick, nanoseconds: a whole fraction of the period, which values of the type `time` count.
    pub tick_ns: u64,
    /// What must be visible while it runs.
    pub observe: Observe,
    /// Ports that may turn out absent whatever their primitive says: a replay may force that on them.
    pub may_be_absent: &'a dyn Fn(PortRef) -> bool,
}

/// What must be visible while an image runs.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Observe {
    /// Every port of every node, node by node: for replay, tracing and debugging.
    All,
    /// Results, exports and set-points only: what the passes may rearrange for speed.
    Exports,
}

impl LowerOptions<'_> {
    /// For running: only what leaves the command is visible.
    #[must_use]
    pub fn running(period_ns: u64) -> Self {
        LowerOptions {
            period_ns,
            tick_ns: period_ns,
            observe: Observe::Exports,
            may_be_absent: &|_| false,
        }
    }

    /// For looking at everything.
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

    /// The same with another tick.
    #[must_use]
    pub fn with_tick(self, tick_ns: u64) -> Self {
        LowerOptions { tick_ns, ..self }
    }

    /// The clocks as constants see them, in cycle 0.
    pub(crate) fn clock(&self) -> Clock {
        Clock {
            dt: self.dt(),
            tick_ns: self.tick_ns,
            ticks: self.period_ns / self.tick_ns.max(1),
            cycle: 0,
            net_ns: 0,
            wall_ns: 0,
        }
    }
}
