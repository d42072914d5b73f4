//! Reasons for which the arm cannot move along a path, as error codes with the axis and the place.

use super::limits::Violation;
use super::port::inverse_error_code;
use crate::error_code::ErrorCode;
use rpi_kin::{AxisLimits, InverseKinematicsError};
use rpi_motion::{Path, PathError, PathErrorKind};

/// Error: a motion of the arm is not possible; with the axis concerned, if any. For a path of the tool, the value of
/// the violation is the place on the path, and its limit the length of the path, both in m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PathFault {
    pub(super) axis: Option<usize>,
    pub(super) violation: Violation,
}

impl PathFault {
    /// Creates the error for a path that an arm with these limits cannot follow.
    pub(super) fn new(error: &PathError, path: &Path, limits: &[AxisLimits]) -> Self {
        let at = |axis, code| Self {
            axis,
            violation: Violation {
                code,
                value: error.s,
                limit: path.length(),
            },
        };
        match (error.kind, path) {
            (PathErrorKind::OutOfRange { axis }, Path::Joints(line)) => {
                out_of_range(axis, line.joints(error.s)[axis], limits)
            }
            (PathErrorKind::ConfigurationChange { axis }, _) => {
                at(Some(axis), ErrorCode::PATH_CONFIGURATION)
            }
            (PathErrorKind::NoInverse(error), _) => at(None, path_error_code(error)),
            (PathErrorKind::OutOfRange { axis }, _) => at(Some(axis), ErrorCode::PATH_OUT_OF_RANGE),
            (PathErrorKind::Unresolved { axis }, _) => at(Some(axis), ErrorCode::PATH_SINGULAR),
            (PathErrorKind::NoLength, _) => ErrorCode::NOT_A_NUMBER.into(),
        }
    }
}

impl From<ErrorCode> for PathFault {
    fn from(code: ErrorCode) -> Self {
        Self {
            axis: None,
            violation: Violation::from_code(code),
        }
    }
}

impl From<InverseKinematicsError> for PathFault {
    fn from(error: InverseKinematicsError) -> Self {
        inverse_error_code(error).into()
    }
}

/// Creates the error for the target `value` (rad) of an axis that lies outside its range.
pub(super) fn out_of_range(axis: usize, value: f64, limits: &[AxisLimits]) -> PathFault {
    let range = limits.get(axis).map(|limits| limits.position);
    let limit = range.map_or(0.0, |range| {
        if value > range.upper {
            range.upper
        } else {
            range.lower
        }
    });
    PathFault {
        axis: Some(axis),
        violation: Violation {
            code: ErrorCode::POSITION,
            value,
            limit,
        },
    }
}

fn path_error_code(error: InverseKinematicsError) -> ErrorCode {
    match error {
        InverseKinematicsError::OutOfReach => ErrorCode::PATH_OUT_OF_REACH,
        InverseKinematicsError::OutOfLimits => ErrorCode::PATH_OUT_OF_RANGE,
        InverseKinematicsError::NoClosedForm => ErrorCode::NO_INVERSE,
        InverseKinematicsError::NotFinite => ErrorCode::NOT_A_NUMBER,
    }
}
