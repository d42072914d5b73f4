//! What a motion gets and gives in each cycle: controls, set-points, and why it cannot go on.

use crate::Joints;
use crate::path_error::PathError;
use crate::time_law::PathState;

/// Controls of a running motion: speed and pause, set anew in each cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Controls {
    /// Share of the requested speed, from 0 to 1; 0 pauses.
    pub speed_share: f64,
    /// Whether the arm comes to rest on the path and stays there until this is false again.
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
    /// The path cannot be followed from some place on. The arm comes to rest before it.
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

/// Set-point of one cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SetPoint {
    /// Joints, rad.
    pub joints: Joints,
    /// Path parameter with its derivatives.
    pub path: PathState,
    /// Whether the arm is on the path: the residual has decayed.
    pub on_path: bool,
    /// Whether the arm rests at the end of the path.
    pub done: bool,
}

/// How an arm comes from its present motion on to the next path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EntryPreference {
    /// Within the requested bounds of the tool, if the limits of the axes allow it; else as [`EntryPreference::Shortest`].
    #[default]
    WithinToolBounds,
    /// As fast as the limits of the axes allow, whatever the tool does.
    Shortest,
}
