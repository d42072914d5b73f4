//! Pieces of a family of extremal motions: position and duration in closed form.
//!
//! All values are divided by the maximum jerk, so that the jerk is 1 and an acceleration is a time.

/// Kind of a piece of a family of extremal motions: which limits of the acceleration and the velocity the motions
/// reach. Each piece has one parameter, and all quantities are divided by the maximum jerk.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum PieceKind {
    /// No limit is reached. The parameter is the duration of the phase in which the acceleration falls (s).
    #[default]
    Switching,
    /// The maximum acceleration is held for a time. The parameter is the depth of the following dip below it (s).
    HoldHigh,
    /// The minimum acceleration is held for a time. The parameter is the height of the preceding peak above it (s).
    HoldLow,
    /// The maximum and the minimum acceleration are both held for a time. The parameter is the peak velocity (s²).
    HoldBoth,
    /// The maximum velocity is held for a time. The parameter is this time (s).
    Cruise,
}

/// One motion of a family of extremal motions: its piece (`kind`) and the value of the parameter of the piece (`at`).
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Member {
    pub(super) kind: PieceKind,
    pub(super) at: f64,
}

/// Boundary values of a family of motions whose acceleration rises, falls and rises. A *line* is the motion with the
/// jerk 1 through the start, or through the end, extended to the acceleration 0. Positions and durations count between
/// these two zeros.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Lines {
    /// Velocity at which the first line has the acceleration 0, divided by the maximum jerk (s²).
    pub(super) first: f64,
    /// Velocity at which the last line has the acceleration 0, divided by the maximum jerk (s²).
    pub(super) last: f64,
    /// Change of velocity between the two lines, `last - first`, divided by the maximum jerk (s²); not negative.
    pub(super) gain: f64,
    /// Maximum acceleration, divided by the maximum jerk (s); positive.
    pub(super) top: f64,
    /// Magnitude of the minimum acceleration, divided by the maximum jerk (s); positive.
    pub(super) bottom: f64,
    /// Change of velocity from the first line to the maximum velocity, divided by the maximum jerk (s²); not below `gain`.
    pub(super) rise: f64,
    /// Change of velocity from the maximum velocity to the last line, divided by the maximum jerk (s²); not negative.
    pub(super) fall: f64,
    /// Maximum velocity, divided by the maximum jerk (s²).
    pub(super) fastest: f64,
    /// Acceleration at the end of the motion, divided by the maximum jerk (s). It decides the shape of a motion whose
    /// start and end lie on the same line.
    pub(super) end_acceleration: f64,
}

/// Accelerations and hold times of a motion, divided by the maximum jerk: peak and its hold, cruise, trough and its
/// hold.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Shape {
    pub(super) peak: f64,
    pub(super) peak_hold: f64,
    pub(super) cruise: Option<f64>,
    pub(super) trough: f64,
    pub(super) trough_hold: f64,
}

/// Motions in which one acceleration, `level`, is held for a time, described by the velocities of both lines at this
/// acceleration (`from`, `to`). All quantities are divided by the maximum jerk.
#[derive(Clone, Copy)]
struct Hold {
    level: f64,
    gain: f64,
    from: f64,
    to: f64,
}

impl Hold {
    /// Returns the velocity at the end of the hold that precedes a dip of the acceleration of depth `dip`.
    fn velocity(&self, dip: f64) -> f64 {
        self.to + dip * (dip - 2.0 * self.level)
    }

    fn position(&self, dip: f64) -> f64 {
        let before = self.velocity(dip);
        let centre = self.to + dip * (dip / 2.0 - self.level);
        let held = (before - self.from) * (before + self.from) / (2.0 * self.level);
        held + 2.0 * dip * centre - self.gain * self.level
    }

    fn slope(&self, dip: f64) -> f64 {
        2.0 * dip / self.level * (dip * (dip - 1.5 * self.level) + self.to)
    }

    fn duration(&self, dip: f64) -> f64 {
        (self.gain + dip * dip) / self.level
    }

    fn time(&self, dip: f64) -> f64 {
        (self.gain + dip * (dip - 2.0 * self.level)) / self.level
    }

    fn dip_of(&self, duration: f64) -> f64 {
        libm::sqrt((self.level * duration - self.gain).max(0.0))
    }

    /// Returns the depths of the dip at which the position has an extremum; `None` if there are none.
    fn extrema(&self) -> Option<[f64; 2]> {
        let centre = 0.75 * self.level;
        let radius = centre * centre - self.to;
        (radius >= 0.0).then(|| {
            let root = libm::sqrt(radius);
            [centre - root, centre + root]
        })
    }
}

impl Lines {
    fn high(&self) -> Hold {
        let risen = self.top * self.top / 2.0;
        Hold {
            level: self.top,
            gain: self.gain,
            from: self.first + risen,
            to: self.last + risen,
        }
    }

    /// Returns the motions with a held minimum acceleration: those with a held maximum acceleration in reversed time.
    fn low(&self) -> Hold {
        let risen = self.bottom * self.bottom / 2.0;
        Hold {
            level: self.bottom,
            gain: -self.gain,
            from: self.last + risen,
            to: self.first + risen,
        }
    }

    /// Returns the sum of the peak and the trough of the acceleration if no limit is reached and the acceleration falls
    /// for the time `fall`.
    fn sum(&self, fall: f64) -> f64 {
        if fall > 0.0 {
            self.gain / fall
        } else {
            2.0 * self.end_acceleration
        }
    }

    /// Returns the travel of a motion between the zeros of its lines, divided by the maximum jerk (s³).
    pub(super) fn position(&self, member: Member) -> f64 {
        let x = member.at;
        match member.kind {
            PieceKind::Switching => {
                (self.first + self.last) * x + (x * x * x - self.gain * self.sum(x)) / 4.0
            }
            PieceKind::HoldHigh => self.high().position(x),
            PieceKind::HoldLow => self.low().position(x),
            PieceKind::HoldBoth => {
                let [rise, fall] = self.ramps(x);
                (self.first + x) / 2.0 * rise + (self.last + x) / 2.0 * fall
            }
            PieceKind::Cruise => {
                let [rise, fall] = self.ramps_to_fastest();
                let ramps = (self.first + self.fastest) * rise + (self.last + self.fastest) * fall;
                ramps / 2.0 + self.fastest * x
            }
        }
    }

    /// Returns the derivative of the travel of a motion with respect to the parameter of its piece.
    pub(super) fn slope(&self, member: Member) -> f64 {
        let x = member.at;
        match member.kind {
            PieceKind::Switching => {
                let sum = self.sum(x);
                self.first + self.last + (3.0 * x * x + sum * sum) / 4.0
            }
            PieceKind::HoldHigh => self.high().slope(x),
            PieceKind::HoldLow => self.low().slope(x),
            PieceKind::HoldBoth => x / self.top + x / self.bottom + (self.top + self.bottom) / 2.0,
            PieceKind::Cruise => self.fastest,
        }
    }

    /// Returns the duration (s) of a motion between the zeros of its lines; it grows with the parameter of the piece.
    pub(super) fn duration(&self, member: Member) -> f64 {
        let x = member.at;
        match member.kind {
            PieceKind::Switching => 2.0 * x,
            PieceKind::HoldHigh => self.high().duration(x),
            PieceKind::HoldLow => self.low().duration(x),
            PieceKind::HoldBoth => self.ramps(x).iter().sum(),
            PieceKind::Cruise => self.ramps_to_fastest().iter().sum::<f64>() + x,
        }
    }

    /// Returns the motion of the family that consists of a piece of this kind and takes `duration` (s).
    pub(super) fn at_duration(&self, kind: PieceKind, duration: f64) -> Member {
        let at = match kind {
            PieceKind::Switching => duration / 2.0,
            PieceKind::HoldHigh => self.high().dip_of(duration),
            PieceKind::HoldLow => self.low().dip_of(duration),
            PieceKind::HoldBoth => {
                let left = duration - self.top - self.bottom
                    + self.first / self.top
                    + self.last / self.bottom;
                left / (1.0 / self.top + 1.0 / self.bottom)
            }
            PieceKind::Cruise => duration - self.ramps_to_fastest().iter().sum::<f64>(),
        };
        Member { kind, at }
    }

    /// Returns the parameters of a piece at which the travel has an extremum, in ascending order; NaN if there is none.
    pub(super) fn extrema(&self, kind: PieceKind) -> [f64; 2] {
        const NONE: [f64; 2] = [f64::NAN; 2];
        match kind {
            PieceKind::Switching => {
                let sum = self.first + self.last;
                let radius = 4.0 * sum * sum - 3.0 * self.gain * self.gain;
                if sum >= 0.0 || radius < 0.0 {
                    return NONE;
                }
                // The smaller root by the product of both, against cancellation.
                let larger = (libm::sqrt(radius) - 2.0 * sum) / 3.0;
                let smaller = self.gain * self.gain / (3.0 * larger);
                [libm::sqrt(smaller), libm::sqrt(larger)]
            }
            PieceKind::HoldHigh => self.high().extrema().unwrap_or(NONE),
            PieceKind::HoldLow => self.low().extrema().unwrap_or(NONE),
            PieceKind::HoldBoth => [-self.top * self.bottom / 2.0, f64::NAN],
            PieceKind::Cruise => NONE,
        }
    }

    /// Returns the durations (s) of the rise to the velocity `peak` and of the fall from it, both with a held
    /// acceleration.
    fn ramps(&self, peak: f64) -> [f64; 2] {
        [
            (peak - self.first) / self.top + self.top,
            (peak - self.last) / self.bottom + self.bottom,
        ]
    }

    fn ramps_to_fastest(&self) -> [f64; 2] {
        let ramp = |change: f64, level: f64| {
            if change >= level * level {
                change / level + level
            } else {
                2.0 * libm::sqrt(change)
            }
        };
        [ramp(self.rise, self.top), ramp(self.fall, self.bottom)]
    }

    /// Returns the accelerations and hold times of a motion of the family.
    pub(super) fn shape(&self, member: Member) -> Shape {
        let x = member.at;
        let mut shape = Shape {
            peak: self.top,
            trough: -self.bottom,
            ..Shape::default()
        };
        match member.kind {
            PieceKind::Switching => {
                shape.peak = (self.sum(x) + x) / 2.0;
                shape.trough = (self.sum(x) - x) / 2.0;
            }
            PieceKind::HoldHigh => {
                shape.trough = self.top - x;
                shape.peak_hold = self.high().time(x);
            }
            PieceKind::HoldLow => {
                shape.peak = x - self.bottom;
                shape.trough_hold = self.low().time(x);
            }
            PieceKind::HoldBoth => {
                shape.peak_hold = (x - self.first) / self.top - self.top;
                shape.trough_hold = (x - self.last) / self.bottom - self.bottom;
            }
            PieceKind::Cruise => {
                shape.peak = libm::sqrt(self.rise).min(self.top);
                shape.peak_hold = self.rise / self.top - self.top;
                shape.trough = -libm::sqrt(self.fall).min(self.bottom);
                shape.trough_hold = self.fall / self.bottom - self.bottom;
                shape.cruise = Some(x);
            }
        }
        shape.peak_hold = shape.peak_hold.max(0.0);
        shape.trough_hold = shape.trough_hold.max(0.0);
        shape
    }
}
