//! Why a path cannot be followed, and where.

use rpi_kin::InverseKinematicsError;

/// Error: the path cannot be followed at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathError {
    /// Place of the error: path parameter, m (rad on a joint line).
    pub s: f64,
    /// Reason of the error.
    pub kind: PathErrorKind,
}

/// Reason why an arm cannot follow a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathErrorKind {
    /// The inverse kinematics has no solution.
    NoInverse(InverseKinematicsError),
    /// The arm would have to change its configuration: an axis would jump.
    ConfigurationChange {
        /// Axis that would jump, counted from 0.
        axis: usize,
    },
    /// The path ends with an axis outside its range.
    OutOfRange {
        /// Axis outside its range, counted from 0.
        axis: usize,
    },
    /// The path is too near to a singularity, or the range of the elbow makes a kink: the derivatives of the joints
    /// cannot be resolved.
    Unresolved,
    /// The path has no length.
    NoLength,
}

impl core::fmt::Display for PathError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let at = self.s;
        match self.kind {
            PathErrorKind::NoInverse(InverseKinematicsError::OutOfReach) => {
                write!(
                    f,
                    "the path leaves the reach of the arm {at:.4} m from its start"
                )
            }
            PathErrorKind::NoInverse(_) => write!(
                f,
                "an axis would leave its range {at:.4} m from the start of the path"
            ),
            PathErrorKind::ConfigurationChange { axis } => write!(
                f,
                "axis {} would change the configuration {at:.4} m from the start of the path",
                axis + 1
            ),
            PathErrorKind::OutOfRange { axis } => {
                write!(f, "the path ends with axis {} outside its range", axis + 1)
            }
            PathErrorKind::Unresolved => write!(
                f,
                "the path comes too near to a singularity {at:.4} m from its start"
            ),
            PathErrorKind::NoLength => f.write_str("the path has no length"),
        }
    }
}

impl core::error::Error for PathError {}
