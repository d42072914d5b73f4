//! What a device has against a set-point, or what has become of it: error codes.

use core::fmt;

/// An error code, as the ports `joint.error`, `tcp.error`, `base.error` and `code` give it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Code(pub i64);

/// A line of the table of codes.
#[derive(Clone, Copy, Debug)]
pub struct CodeText {
    /// The code.
    pub code: Code,
    /// A word for it.
    pub word: &'static str,
    /// What it means.
    pub meaning: &'static str,
}

impl Code {
    /// The device is well.
    pub const OK: Self = Self(0);
    /// NaN or infinity.
    pub const NOT_A_NUMBER: Self = Self(1);
    /// Out of the joint's range.
    pub const POSITION: Self = Self(2);
    /// Too fast.
    pub const VELOCITY: Self = Self(3);
    /// Changes its velocity too fast.
    pub const ACCELERATION: Self = Self(4);
    /// Changes its acceleration too fast.
    pub const JERK: Self = Self(5);
    /// Does not join where the arm stands.
    pub const DISCONTINUITY: Self = Self(6);
    /// The pose is out of reach.
    pub const OUT_OF_REACH: Self = Self(7);
    /// The pose can only be reached with a joint out of its range.
    pub const NO_JOINTS: Self = Self(8);
    /// The joint has failed.
    pub const JOINT_FAILED: Self = Self(9);
    /// The arm was moving and got no set-point.
    pub const SET_POINT_MISSING: Self = Self(10);
    /// Emergency stop.
    pub const EMERGENCY_STOP: Self = Self(11);
    /// A parameter of the tool or of the way of control that the arm does not take.
    pub const BAD_PARAMETER: Self = Self(12);
    /// A velocity in a direction in which the platform cannot drive.
    pub const NOT_DRIVABLE: Self = Self(13);

    /// The arm brakes as a whole, as another of its joints was left without a set-point.
    pub const BRAKING: Self = Self(14);

    /// The device has failed, whatever the set-point.
    #[must_use]
    pub const fn is_failure(self) -> bool {
        matches!(self, Self::JOINT_FAILED | Self::EMERGENCY_STOP)
    }

    /// Its line in the table.
    #[must_use]
    pub fn text(self) -> Option<&'static CodeText> {
        CODES.iter().find(|line| line.code == self)
    }
}

impl fmt::Display for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.text().map_or("unknown", |line| line.word))
    }
}

const fn line(code: Code, word: &'static str, meaning: &'static str) -> CodeText {
    CodeText {
        code,
        word,
        meaning,
    }
}

/// All codes, ascending.
pub const CODES: &[CodeText] = &[
    line(Code::OK, "ok", "the device is well"),
    line(
        Code::NOT_A_NUMBER,
        "not-a-number",
        "the set-point is NaN or infinite",
    ),
    line(
        Code::POSITION,
        "position",
        "the set-point is out of the joint's range",
    ),
    line(
        Code::VELOCITY,
        "velocity",
        "the step from the set-point before is too fast",
    ),
    line(
        Code::ACCELERATION,
        "acceleration",
        "the velocity changes too fast",
    ),
    line(Code::JERK, "jerk", "the acceleration changes too fast"),
    line(
        Code::DISCONTINUITY,
        "discontinuity",
        "the first set-point does not join where the arm stands",
    ),
    line(
        Code::OUT_OF_REACH,
        "out-of-reach",
        "the pose is farther away, or nearer, than the arm can reach",
    ),
    line(
        Code::NO_JOINTS,
        "no-joints",
        "the pose can only be reached with a joint out of its range",
    ),
    line(Code::JOINT_FAILED, "joint-failed", "the joint has failed"),
    line(
        Code::SET_POINT_MISSING,
        "set-point-missing",
        "no set-point came while the arm was moving; it brakes",
    ),
    line(
        Code::EMERGENCY_STOP,
        "emergency-stop",
        "the emergency stop is pressed; the arm brakes",
    ),
    line(
        Code::BAD_PARAMETER,
        "bad-parameter",
        "the arm does not take this tool or way of control",
    ),
    line(
        Code::NOT_DRIVABLE,
        "not-drivable",
        "the platform cannot drive in this direction",
    ),
    line(
        Code::BRAKING,
        "braking",
        "the arm brakes as a whole: another of its joints was stopped or left alone",
    ),
];
