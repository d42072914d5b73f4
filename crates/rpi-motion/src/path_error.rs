//! Why a path cannot be followed, and where.

use rpi_kin::InverseKinematicsError;

/// Error: an arm cannot follow a path at some place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathError {
    /// Position along the path (path parameter) of the error, m (rad on a joint line).
    pub s: f64,
    /// Reason why the arm cannot follow the path there.
    pub kind: PathErrorKind,
}

/// Reason why an arm cannot follow a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathErrorKind {
    /// The inverse kinematics has no solution for a pose on the path, for example because it is out of reach.
    NoInverse(InverseKinematicsError),
    /// The arm would have to change its configuration at this place: an axis would jump.
    ConfigurationChange {
        /// Axis that would jump, counted from 0.
        axis: usize,
    },
    /// An axis would leave its range at this place.
    OutOfRange {
        /// Axis that would leave its range, counted from 0.
        axis: usize,
    },
    /// The derivatives of the joint positions cannot be computed, because the path is too near to a singularity or a
    /// range limits the arm angle (position of the elbow) abruptly.
    Unresolved {
        /// Axis that turns or bends most along the path there, counted from 0.
        axis: usize,
    },
    /// Start and end of the path coincide, and there is no rotation between them.
    NoLength,
}

impl core::fmt::Display for PathError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let at = self.s;
        match self.kind {
            PathErrorKind::NoInverse(InverseKinematicsError::OutOfReach) => {
                write!(
                    f,
                    "the path leaves the reach of the arm at the position {at:.4} along it"
                )
            }
            PathErrorKind::NoInverse(_) => write!(
                f,
                "an axis would leave its range at the position {at:.4} along the path"
            ),
            PathErrorKind::ConfigurationChange { axis } => write!(
                f,
                "axis {} would change the configuration at the position {at:.4} along the path",
                axis + 1
            ),
            PathErrorKind::OutOfRange { axis } => write!(
                f,
                "axis {} would leave its range at the position {at:.4} along the path",
                axis + 1
            ),
            PathErrorKind::Unresolved { axis } => write!(
                f,
                "the path comes too near to a singularity at the position {at:.4} along it: axis {} would turn too abruptly",
                axis + 1
            ),
            PathErrorKind::NoLength => f.write_str("the path has no length"),
        }
    }
}

impl core::error::Error for PathError {}
