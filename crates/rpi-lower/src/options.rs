//! What a lowering is asked for.

use rpi_net::PortRef;

/// How a net is lowered.
#[derive(Clone, Copy)]
pub struct LowerOptions<'a> {
    /// Period in nanoseconds.
    pub period_ns: u64,
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
        self.period_ns as f64 * 1e-9
    }
}
