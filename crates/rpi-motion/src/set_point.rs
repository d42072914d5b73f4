//! What a motion gets and gives in each cycle: controls, set-points, and why it cannot go on.

use crate::Joints;
use crate::path_error::PathError;
use crate::time_law::PathState;

/// Controls of a running motion: speed and pause, set anew in each cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Controls {
    /// Share of the requested speed, from 0 to 1; 0 pauses.
    pub speed_share: f64,
    /// True while the motion pauses: the arm comes to rest on the path and stays there.
    pub paused: bool,
}

impl Default for Controls {
    fn default() -> Self {
        Self {
            speed_share: 1.0,
            paused: false,
        }
    }
}

/// Reason why a motion cannot begin or continue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MotionError {
    /// The path cannot be followed beyond some place. The arm comes to rest before it.
    Path(PathError),
    /// A bound, a pose or a state is not finite, or a bound is not positive.
    NotFinite,
}

impl core::fmt::Display for MotionError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            MotionError::Path(error) => error.fmt(f),
            MotionError::NotFinite => {
                f.write_str("a number of the motion is not finite, or a bound is not positive")
            }
        }
    }
}

impl core::error::Error for MotionError {}

impl From<PathError> for MotionError {
    fn from(error: PathError) -> Self {
        MotionError::Path(error)
    }
}

/// Set-point of one cycle of a motion along a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SetPoint {
    /// Positions of the axes, rad.
    pub joints: Joints,
    /// Position along the path (path parameter), with velocity and acceleration.
    pub path: PathState,
    /// True if the arm is on the path: its differences from the path after the takeover have decayed.
    pub on_path: bool,
    /// True if the arm rests at the end of the path.
    pub done: bool,
}

/// Way in which an arm comes from its present motion on to the next path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EntryPreference {
    /// The tool keeps the requested bounds during the takeover, if the limits of the axes allow it; otherwise as
    /// [`EntryPreference::Shortest`].
    #[default]
    WithinToolBounds,
    /// The takeover is as fast as the limits of the axes allow; meanwhile, the tool may exceed its requested bounds.
    Shortest,
}
