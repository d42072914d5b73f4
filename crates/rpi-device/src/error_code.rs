//! Error codes of devices.

use core::fmt;

/// Error code of a device, as its ports `joint.error`, `tcp.error`, `base.error` and `code` carry it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ErrorCode(pub i64);

/// Row of the table of error codes: number, name and explanation.
#[derive(Clone, Copy, Debug)]
pub struct ErrorCodeInfo {
    /// Number of the error, as ports and programs see it.
    pub code: ErrorCode,
    /// Short name of the error for display, such as `out-of-reach`.
    pub name: &'static str,
    /// Explanation of the error in one sentence, for users.
    pub description: &'static str,
}

impl ErrorCode {
    /// Code 0: the device has no error.
    pub const OK: Self = Self(0);
    /// The set-point is NaN or infinite.
    pub const NOT_A_NUMBER: Self = Self(1);
    /// The set-point is outside the joint's range.
    pub const POSITION: Self = Self(2);
    /// The step from the previous set-point exceeds the velocity limit of a joint or of the device.
    pub const VELOCITY: Self = Self(3);
    /// The change of the velocity between set-points exceeds the acceleration limit.
    pub const ACCELERATION: Self = Self(4);
    /// The change of the acceleration between set-points exceeds the jerk limit.
    pub const JERK: Self = Self(5);
    /// The first set-point of a command is too far from the present position of the arm.
    pub const DISCONTINUITY: Self = Self(6);
    /// The pose of the set-point is farther away, or nearer, than the arm can reach.
    pub const OUT_OF_REACH: Self = Self(7);
    /// The pose of the set-point requires a joint outside its range.
    pub const JOINTS_OUT_OF_RANGE: Self = Self(8);
    /// Code 9: a joint of the arm has failed; it rejects all set-points and the arm brakes.
    pub const JOINT_FAILED: Self = Self(9);
    /// The arm was moving and received no set-point.
    pub const SET_POINT_MISSING: Self = Self(10);
    /// The emergency stop is active.
    pub const EMERGENCY_STOP: Self = Self(11);
    /// The arm does not support a tool parameter or a control strategy of the set-point.
    pub const INVALID_PARAMETER: Self = Self(12);
    /// The mobile base cannot drive in the direction of the commanded velocity.
    pub const NOT_DRIVABLE: Self = Self(13);

    /// The whole arm brakes because another joint was stopped or received no set-point.
    pub const BRAKING: Self = Self(14);

    /// The path of a motion leaves the reach of the arm.
    pub const PATH_OUT_OF_REACH: Self = Self(15);
    /// The path of a motion needs an axis position outside the range of the axis.
    pub const PATH_OUT_OF_RANGE: Self = Self(16);
    /// The arm would have to change its configuration on the path of a motion.
    pub const PATH_CONFIGURATION: Self = Self(17);
    /// The path of a motion comes too near to a singularity.
    pub const PATH_SINGULAR: Self = Self(18);
    /// The points of an arc (start, via point or centre, end) lie on a line or coincide, so that they determine no
    /// circle.
    pub const COLINEAR: Self = Self(19);
    /// The speed, acceleration or jerk of a motion is not positive.
    pub const NOT_POSITIVE: Self = Self(20);
    /// The motion is along a path of the tool, but no inverse kinematics is known for the arm.
    pub const NO_INVERSE: Self = Self(21);
    /// A set-point or an event belongs to a motion that another motion of the arm has replaced, or to no motion of the arm.
    pub const SUPERSEDED: Self = Self(22);
    /// No rounded corner fits at the via pose of a motion: the zone is not positive, the path turns back, or the tool
    /// turns too far beside it.
    pub const NO_CORNER: Self = Self(23);
    /// Start and end of an arc differ in their distance from its centre by more than 1 mm.
    pub const UNEQUAL_RADII: Self = Self(24);
    /// The angle of an arc is 0 or not finite.
    pub const NO_ANGLE: Self = Self(25);
    /// An arc starts on its axis of rotation, or the axis has no direction.
    pub const ON_AXIS: Self = Self(26);
    /// The path of a motion has more than 16 points.
    pub const TOO_MANY_POINTS: Self = Self(27);
    /// Two successive points of a spline coincide.
    pub const SAME_POINT: Self = Self(28);
    /// A spline turns back so sharply that the tool would have to stop.
    pub const REVERSAL: Self = Self(29);
    /// The tool turns by more than 4 rad per metre between two points of a spline.
    pub const TURNING_DECIDES: Self = Self(30);
    /// An axis has reached the end of its range and stopped there.
    pub const RANGE_END: Self = Self(31);

    /// The controller of the device does not answer. The device brakes by its own watchdog.
    pub const CONNECTION_LOST: Self = Self(32);
    /// The controller of the device has stopped by itself, because of missing set-points or another cause.
    pub const CONTROLLER_STOPPED: Self = Self(33);
    /// A safety function of the controller has stopped the arm. An operator must clear the cause and release it there.
    pub const PROTECTIVE_STOP: Self = Self(34);
    /// A chunk of joint positions is not accepted: its period, its number of rows, a number or an option is out of range.
    pub const CHUNK_INVALID: Self = Self(35);
    /// A chunk of joint positions is too old: fewer than 4 of its rows lie in the future.
    pub const CHUNK_STALE: Self = Self(36);
    /// A chunk of joint positions was to be appended, but too many rows are still to be executed.
    pub const CHUNK_FULL: Self = Self(37);

    /// An event on the path of a motion did not occur: the motion ended, or another one took over, before its place.
    pub const EVENT_MISSED: Self = Self(38);
    /// The place of an event is not on the path of its motion.
    pub const NO_SUCH_PLACE: Self = Self(39);

    /// True for a code whose report carries a place on the path of the tool, as `value`, and the length of the path, as
    /// `limit`, both in m.
    #[must_use]
    pub const fn is_on_path(self) -> bool {
        matches!(
            self,
            Self::PATH_OUT_OF_REACH
                | Self::PATH_OUT_OF_RANGE
                | Self::PATH_CONFIGURATION
                | Self::PATH_SINGULAR
                | Self::NO_INVERSE
        )
    }

    /// True for a failure of the device itself: no set-point can avoid it.
    #[must_use]
    pub const fn is_failure(self) -> bool {
        matches!(
            self,
            Self::JOINT_FAILED
                | Self::EMERGENCY_STOP
                | Self::CONNECTION_LOST
                | Self::CONTROLLER_STOPPED
                | Self::PROTECTIVE_STOP
        )
    }

    /// Returns the row of the table of error codes for this code; `None` if the table has no such code.
    #[must_use]
    pub fn info(self) -> Option<&'static ErrorCodeInfo> {
        ERROR_CODES.iter().find(|line| line.code == self)
    }
}

impl fmt::Display for ErrorCode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.info().map_or("unknown", |line| line.name))
    }
}

const fn line(code: ErrorCode, word: &'static str, meaning: &'static str) -> ErrorCodeInfo {
    ErrorCodeInfo {
        code,
        name: word,
        description: meaning,
    }
}

/// Table of all error codes, in ascending order of their numbers.
pub const ERROR_CODES: &[ErrorCodeInfo] = &[
    line(ErrorCode::OK, "ok", "the device is well"),
    line(
        ErrorCode::NOT_A_NUMBER,
        "not-a-number",
        "the set-point is NaN or infinite",
    ),
    line(
        ErrorCode::POSITION,
        "position",
        "the set-point is out of the joint's range",
    ),
    line(
        ErrorCode::VELOCITY,
        "velocity",
        "the step from the set-point before is too fast",
    ),
    line(
        ErrorCode::ACCELERATION,
        "acceleration",
        "the velocity changes too fast",
    ),
    line(ErrorCode::JERK, "jerk", "the acceleration changes too fast"),
    line(
        ErrorCode::DISCONTINUITY,
        "discontinuity",
        "the first set-point of a command is too far from the present position of the arm",
    ),
    line(
        ErrorCode::OUT_OF_REACH,
        "out-of-reach",
        "the pose is farther away, or nearer, than the arm can reach",
    ),
    line(
        ErrorCode::JOINTS_OUT_OF_RANGE,
        "no-joints",
        "the pose can only be reached with a joint out of its range",
    ),
    line(
        ErrorCode::JOINT_FAILED,
        "joint-failed",
        "the joint has failed",
    ),
    line(
        ErrorCode::SET_POINT_MISSING,
        "set-point-missing",
        "no set-point came while the arm was moving; it brakes",
    ),
    line(
        ErrorCode::EMERGENCY_STOP,
        "emergency-stop",
        "the emergency stop is pressed; the arm brakes",
    ),
    line(
        ErrorCode::INVALID_PARAMETER,
        "bad-parameter",
        "the arm does not take this tool or way of control",
    ),
    line(
        ErrorCode::NOT_DRIVABLE,
        "not-drivable",
        "the platform cannot drive in this direction",
    ),
    line(
        ErrorCode::BRAKING,
        "braking",
        "the whole arm brakes, because another of its joints was stopped or got no set-point",
    ),
    line(
        ErrorCode::PATH_OUT_OF_REACH,
        "path-out-of-reach",
        "the path leaves the reach of the arm; nothing moves, or the arm stops on the path before that place",
    ),
    line(
        ErrorCode::PATH_OUT_OF_RANGE,
        "path-out-of-range",
        "on the path, an axis would leave its range; choose another arm angle, orientation or starting position",
    ),
    line(
        ErrorCode::PATH_CONFIGURATION,
        "path-configuration",
        "on the path, the arm would have to change its configuration; begin in the other one, or move by joints",
    ),
    line(
        ErrorCode::PATH_SINGULAR,
        "path-singular",
        "the path comes too near to a singularity of the arm; move it away, or move by joints there",
    ),
    line(
        ErrorCode::COLINEAR,
        "colinear",
        "start, via point (or centre) and end of the arc lie on a line, or two of them are the same; give a half circle by its via point or angle",
    ),
    line(
        ErrorCode::NOT_POSITIVE,
        "not-positive",
        "the speed, acceleration or jerk of the motion is not positive",
    ),
    line(
        ErrorCode::NO_INVERSE,
        "no-inverse",
        "no inverse kinematics is known for this arm: it moves by joints only",
    ),
    line(
        ErrorCode::SUPERSEDED,
        "superseded",
        "another motion of the arm has begun, this one was left out for a cycle, or the number is not that of a motion of this arm",
    ),
    line(
        ErrorCode::NO_CORNER,
        "no-corner",
        "no corner fits at the via pose: the zone is not positive, the path turns back, or the tool turns too far beside it",
    ),
    line(
        ErrorCode::UNEQUAL_RADII,
        "unequal-radii",
        "start and end of the arc differ in their distance from its centre by more than 1 mm; correct the centre, or give a via point",
    ),
    line(
        ErrorCode::NO_ANGLE,
        "no-angle",
        "the angle of the arc is 0 or not finite",
    ),
    line(
        ErrorCode::ON_AXIS,
        "on-axis",
        "the arc starts on its axis, or the axis has no direction",
    ),
    line(
        ErrorCode::TOO_MANY_POINTS,
        "too-many-points",
        "the path has more than 16 points; divide it",
    ),
    line(
        ErrorCode::SAME_POINT,
        "same-point",
        "two successive points of the spline are the same; leave one out",
    ),
    line(
        ErrorCode::REVERSAL,
        "reversal",
        "the spline turns back so sharply that the tool would have to stop; end the motion there",
    ),
    line(
        ErrorCode::TURNING_DECIDES,
        "turning-decides",
        "the tool turns by more than 4 rad per metre between two points of the spline; turn it on a longer way, or by a line",
    ),
    line(
        ErrorCode::RANGE_END,
        "range-end",
        "an axis has come to the end of its range and stopped there; move it back",
    ),
    line(
        ErrorCode::CONNECTION_LOST,
        "connection-lost",
        "the controller of the device does not answer; it brakes by its own watchdog",
    ),
    line(
        ErrorCode::CONTROLLER_STOPPED,
        "controller-stopped",
        "the controller of the device has stopped by itself, because set-points were missing or for a reason of its own",
    ),
    line(
        ErrorCode::PROTECTIVE_STOP,
        "protective-stop",
        "a safety function of the controller has stopped the arm; clear the cause and unlock it at the controller",
    ),
    line(
        ErrorCode::CHUNK_INVALID,
        "chunk-invalid",
        "the period, the number of rows, a number or an option of the chunk is out of range; the arm follows the chunk before",
    ),
    line(
        ErrorCode::CHUNK_STALE,
        "chunk-stale",
        "fewer than 4 rows of the chunk lie in the future; the arm follows the chunk before. Send longer chunks, or sooner",
    ),
    line(
        ErrorCode::CHUNK_FULL,
        "chunk-full",
        "more than 400 rows would be left to execute; the chunk is not appended. Send it later",
    ),
    line(
        ErrorCode::EVENT_MISSED,
        "event-missed",
        "an event on the path did not occur, because the motion ended or another one took over before its place",
    ),
    line(
        ErrorCode::NO_SUCH_PLACE,
        "no-such-place",
        "the place of an event is not on the path of its motion; correct the place, or the point or zone from which it counts",
    ),
];
