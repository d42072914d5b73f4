//! Settings of the server that apply to all commands.

use rpi_core::{CommandOverrunPolicy, Continuity};

/// Tick length, axes of the arms, and policies that apply to commands unless their clients specify others.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CommandDefaults {
    /// Length of a tick in nanoseconds; at least 1.
    pub(super) tick_ns: u64,
    /// Number of axes of the arms of the cell; `None` if they differ.
    pub(crate) arm_axes: Option<u32>,
    /// Policy for a command whose cycles take too long, unless its client specifies one.
    pub(super) on_overrun: CommandOverrunPolicy,
    /// Policy for a takeover with a discontinuity of the set-points; `None` for the default of the command's language.
    pub(super) continuity: Option<Continuity>,
}

impl CommandDefaults {
    /// Rounds a requested period in nanoseconds up to whole ticks, at least one tick.
    pub(crate) fn round_period(&self, wanted_ns: u64) -> u64 {
        let ticks = wanted_ns.div_ceil(self.tick_ns).max(1);
        ticks.saturating_mul(self.tick_ns)
    }
}
