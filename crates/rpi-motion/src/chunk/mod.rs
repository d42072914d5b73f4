//! Motion along chunks: short horizons of joint positions that a policy sends again and again, each while the arm still
//! executes the last one.
//!
//! The set-point of an axis is `q(t) = c(s(t)) + r(t)`, passed through a guard:
//!
//! - `curve` and `fit`: `c` is a quintic spline near the rows, smoothed by least squares: as little as the limits of the
//!   axes demand, and not by more than a bound;
//! - `corridor`: where rows jump, the curve rounds the jump off. It does not swing beyond the rows;
//! - `law`: `s` is the time of the curve. It passes at the rate 1, more slowly where a limit of an axis binds, changes its rate no faster than the axes can follow, and stops at the
//!   last row if no further chunk comes;
//! - `entry` and `residual`: `r` is what the axis has at a takeover and the new curve does not have. It decays along a
//!   polynomial whose duration is chosen such that the sum keeps the limits;
//! - `feedback`: the jerk that leads an axis back to its curve where a limit kept it off;
//! - `guard`: the jerk of each axis in each period is limited to the interval from which the axis can still brake within its
//!   limits and its range. So no chunk, late, wrong or wild, leads to a set-point that breaks a limit.
//!
//! A chunk comes into force a few cycles after it was given: each cycle tries one degree of smoothing. [`ChunkMotion`]
//! allocates when it is created; afterwards nothing allocates or panics, and the work of each cycle is bounded.
//!
//! Sources: Eilers and Marx 1996 (penalised splines); Zhao et al., Learning fine-grained bimanual manipulation with low-cost
//! hardware, RSS 2023 (ensembles of overlapping chunks); Black et al., Real-time execution of action chunking flow policies,
//! 2025 (rows that are frozen during inference).

mod corridor;
mod curve;
mod entry;
mod feedback;
mod fit;
mod guard;
mod law;
mod motion;
mod pending;
mod residual;
mod rows;
mod state;

pub use guard::LimitKind;
pub use law::BindingLimit;
pub use motion::{ChunkMotion, ChunkSetPoint};
pub use rows::{ChunkRows, MIN_ROWS, PERIODS};

/// Largest number of rows of a chunk.
pub const MAX_ROWS: usize = 200;

/// Place of a new chunk relative to the previous one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Seam {
    /// The rows of the new chunk have their own times and replace the rows of the previous one at the same times.
    #[default]
    Overlap,
    /// The first row of the new chunk follows one period after the last row of the previous one.
    Append,
}

/// Options of one chunk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChunkOptions {
    /// Place of the chunk relative to the previous one.
    pub seam: Seam,
    /// Weight of the previous chunk in the mean of both where they overlap, 0 to 0.95; 0 means that the new one replaces the
    /// previous one. The weight of older chunks decays as its powers.
    pub previous_weight: f64,
    /// Number of rows at the beginning of the chunk that are taken from the previous one, because the arm has executed them
    /// by the time the chunk arrives, or is bound to.
    pub frozen_rows: usize,
    /// Largest deviation of the smoothed curve from a row, rad. Stronger smoothing is not used; the arm is slowed down instead.
    /// Jumps between rows that the arm cannot follow are rounded off, which this value does not limit.
    pub smoothing: f64,
}

impl Default for ChunkOptions {
    fn default() -> Self {
        Self {
            seam: Seam::Overlap,
            previous_weight: 0.0,
            frozen_rows: 0,
            smoothing: 0.01,
        }
    }
}

/// Reason why a chunk is not accepted. The motion goes on with the chunks before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChunkError {
    /// The time between two rows is not 0.01 to 0.1 s.
    Period,
    /// The number of rows is not 4 to 200, or numbers are missing.
    Length,
    /// A number is not finite, or its magnitude is larger than 1e6.
    NotFinite,
    /// An option is out of its range.
    Option,
    /// Fewer than 4 rows are left: the chunk is too old.
    Stale,
    /// Too many rows of the previous chunks are still to be executed, or a chunk is appended to one that is in preparation and has
    /// another period.
    Full,
}

impl core::fmt::Display for ChunkError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            ChunkError::Period => "the period of a chunk is not 10 to 100 ms",
            ChunkError::Length => "a chunk does not have 4 to 200 complete rows",
            ChunkError::NotFinite => "a number of a chunk is not finite, or too large",
            ChunkError::Option => "an option of a chunk is out of its range",
            ChunkError::Stale => "fewer than 4 rows of a chunk lie in the future",
            ChunkError::Full => "too many rows are still to be executed",
        })
    }
}

impl core::error::Error for ChunkError {}
