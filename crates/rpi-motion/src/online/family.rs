//! Families of extremal motions between two velocities and accelerations.
//!
//! Of all motions with a given duration, the one that travels farthest has a rising, a falling and a rising
//! acceleration, each with the maximum jerk, with holds at the limits of the acceleration and of the velocity
//! (Pontryagin). These motions form a family with one parameter, along which the duration grows. The family of the
//! shortest travel is its mirror image. The family is not connected if a fast start acceleration leaves a range of
//! durations in which no motion reaches the end velocity; then it has two segments.

use super::limits::AxisLimits;
pub(super) use super::lines::Member;
use super::lines::{Lines, Shape};
use super::pieces::{Part, Piece, Pieces};
use rpi_kin::state_to_rest::AxisState;

/// Velocities and accelerations at the start and at the end of a motion, and limits. All are divided by the maximum
/// jerk, so that velocities are in s² and accelerations in s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ends {
    pub(super) start_velocity: f64,
    pub(super) start_acceleration: f64,
    pub(super) end_velocity: f64,
    pub(super) end_acceleration: f64,
    pub(super) max_velocity: f64,
    pub(super) min_velocity: f64,
    pub(super) max_acceleration: f64,
    pub(super) min_acceleration: f64,
}

impl Ends {
    pub(super) fn new(start: &AxisState, target: &AxisState, limits: &AxisLimits) -> Self {
        let jerk = limits.max_jerk;
        Self {
            start_velocity: start.velocity / jerk,
            start_acceleration: start.acceleration / jerk,
            end_velocity: target.velocity / jerk,
            end_acceleration: target.acceleration / jerk,
            max_velocity: limits.max_velocity / jerk,
            min_velocity: limits.min_velocity / jerk,
            max_acceleration: limits.max_acceleration / jerk,
            min_acceleration: limits.min_acceleration / jerk,
        }
    }

    pub(super) fn mirrored(&self) -> Self {
        Self {
            start_velocity: -self.start_velocity,
            start_acceleration: -self.start_acceleration,
            end_velocity: -self.end_velocity,
            end_acceleration: -self.end_acceleration,
            max_velocity: -self.min_velocity,
            min_velocity: -self.max_velocity,
            max_acceleration: -self.min_acceleration,
            min_acceleration: -self.max_acceleration,
        }
    }
}

/// Durations (s) of the seven phases of constant jerk, named by the acceleration: rise, hold, fall, cruise, fall, hold,
/// rise.
pub(super) type Times = [f64; 7];

/// Family of extremal motions between two velocities and accelerations: for each duration, the motion that travels
/// farthest. The acceleration rises, falls and rises.
#[derive(Clone, Copy, Debug)]
pub(super) struct Family {
    lines: Lines,
    start_acceleration: f64,
    /// Difference between the travel of a motion extended to acceleration 0 at both ends and that of the motion itself,
    /// divided by the maximum jerk (s³).
    extra_position: f64,
    extra_time: f64,
    /// True if the values in `lines` are those of the motion in reversed time.
    reversed: bool,
    pieces: Pieces,
}

impl Family {
    /// Creates the family of the motions between the given ends. Limits that start or end exceed are widened to them.
    pub(super) fn new(ends: &Ends) -> Self {
        let (a0, af) = (ends.start_acceleration, ends.end_acceleration);
        let first = ends.start_velocity - a0 * a0 / 2.0;
        let last = ends.end_velocity - af * af / 2.0;
        // Differences of velocities come first: the rest is exact then, however small the accelerations are.
        let gain = ends.end_velocity - ends.start_velocity + (a0 - af) * (a0 + af) / 2.0;
        let fastest = widened_velocity(ends);
        let rise = (fastest - ends.start_velocity + a0 * a0 / 2.0)
            .max(a0.max(0.0) * a0)
            .max(gain);
        let fall = (fastest - ends.end_velocity + af * af / 2.0)
            .max(af.min(0.0) * af)
            .max(-gain);
        let on_line = |velocity: f64, a: f64| a * (velocity + a * a / 6.0);
        let reversed = gain < 0.0;
        let top = ends.max_acceleration.max(a0).max(af);
        let bottom = -ends.min_acceleration.min(a0).min(af);
        let mut lines = Lines {
            first,
            last,
            gain,
            rise,
            fall,
            top,
            bottom,
            fastest,
            end_acceleration: af,
        };
        let mut start_acceleration = a0;
        if reversed {
            (lines.first, lines.last, lines.gain) = (last, first, -gain);
            (lines.rise, lines.fall) = (fall, rise);
            (lines.top, lines.bottom) = (bottom, top);
            (start_acceleration, lines.end_acceleration) = (-af, -a0);
        }
        Self {
            pieces: Pieces::new(&lines, start_acceleration),
            lines,
            start_acceleration,
            extra_position: on_line(first, a0) - on_line(last, af),
            extra_time: a0 - af,
            reversed,
        }
    }

    /// Returns true if the possible durations form two separate intervals (segments).
    pub(super) fn has_two_segments(&self) -> bool {
        self.pieces.has_two_segments()
    }

    /// Returns the travel of a motion of the family, divided by the maximum jerk (s³).
    pub(super) fn position(&self, member: Member) -> f64 {
        self.lines.position(member) - self.extra_position
    }

    /// Returns the duration of a motion of the family, s.
    pub(super) fn duration(&self, member: Member) -> f64 {
        self.lines.duration(member) - self.extra_time
    }

    /// Returns the shortest motion of a segment of the family: of the first of two segments if `is_first`, else of the
    /// last or only one.
    pub(super) fn segment_start(&self, is_first: bool) -> Member {
        let piece = &self.pieces.segment(is_first)[0];
        Member {
            kind: piece.kind,
            at: piece.low,
        }
    }

    /// Returns the shortest motion of a segment that travels `distance`, provided that the first motion of the segment
    /// travels less; `None` if there is none. An extremum of the travel, or the end of the segment, that misses the
    /// distance by at most `tolerance` counts as reaching it.
    pub(super) fn first_reaching(
        &self,
        is_first: bool,
        distance: f64,
        tolerance: f64,
    ) -> Option<Member> {
        if is_first && !self.has_two_segments() {
            return None;
        }
        let target = distance + self.extra_position;
        let mut found = None;
        self.walk(is_first, target, |part| {
            let near = if part.is_extremum { -tolerance } else { 0.0 };
            if part.off_high >= near {
                found = Some(self.shortened(part, part.solve(&self.lines, target), target));
            }
            found.is_some()
        });
        found
    }

    /// Returns the shortest motion whose travel differs from `target` by rounding only, near to the solution `member`.
    /// Near an extremum of the travel, this rounding changes the duration by up to 1e-5 s, and motions that are planned
    /// again on their way would become longer each time.
    fn shortened(&self, part: &Part, member: Member, target: f64) -> Member {
        let slope = self.lines.slope(member).abs();
        let duration = self.lines.duration(member);
        // The velocities of the lines are differences of larger numbers.
        let ends = self.start_acceleration * self.start_acceleration
            + self.lines.end_acceleration * self.lines.end_acceleration;
        let speed = self.lines.first.abs() + self.lines.last.abs() + ends;
        let size = target.abs() + self.extra_position.abs() + speed * duration;
        let slack = 16.0 * f64::EPSILON * size;
        let mut step = slack / slope;
        if step < 1e-12 * duration {
            return member;
        }
        for _ in 0..4 {
            let at = (member.at - step).max(part.low);
            let shorter = Member { at, ..member };
            if self.lines.position(shorter) >= target - 2.0 * slack {
                return shorter;
            }
            step /= 4.0;
        }
        member
    }

    /// Calls `add` with the durations (s) of all motions that travel `distance`, and with those of the ends of the
    /// segments.
    pub(super) fn durations_at(&self, distance: f64, mut add: impl FnMut(f64)) {
        let target = distance + self.extra_position;
        for is_first in [true, false] {
            let pieces = self.pieces.segment(is_first);
            let Some((head, tail)) = pieces.first().zip(pieces.last()) else {
                continue;
            };
            for (piece, at) in [(head, head.low), (tail, tail.high)] {
                let duration = self.duration(Member {
                    kind: piece.kind,
                    at,
                });
                if duration.is_finite() {
                    add(duration);
                }
            }
            self.walk(is_first, target, |part| {
                if (part.off_low <= 0.0) != (part.off_high <= 0.0) {
                    add(self.duration(part.solve(&self.lines, target)));
                }
                false
            });
        }
    }

    /// Returns the motion of the family that takes `duration` (s); `None` if the end velocity cannot be reached in this
    /// time.
    pub(super) fn with_duration(&self, duration: f64) -> Option<Member> {
        let between_lines = duration + self.extra_time;
        // Rounding at the limits of a segment.
        let slack = 1e-13 * (duration.abs() + self.extra_time.abs()) + 1e-300;
        let end_of = |piece: &Piece, at: f64| {
            self.lines.duration(Member {
                kind: piece.kind,
                at,
            })
        };
        for is_first in [true, false] {
            for piece in self.pieces.segment(is_first) {
                if between_lines < end_of(piece, piece.low) - slack {
                    return None;
                }
                if between_lines <= end_of(piece, piece.high) + slack {
                    let mut member = self.lines.at_duration(piece.kind, between_lines);
                    member.at = member.at.max(piece.low).min(piece.high);
                    return Some(member);
                }
            }
        }
        None
    }

    /// Calls `visit` with the parts of a segment in which the travel only grows or only shrinks with the duration,
    /// until `visit` returns true.
    fn walk(&self, is_first: bool, target: f64, mut visit: impl FnMut(&Part) -> bool) {
        let pieces = self.pieces.segment(is_first);
        for (number, piece) in pieces.iter().enumerate() {
            let off = |at: f64| {
                self.lines.position(Member {
                    kind: piece.kind,
                    at,
                }) - target
            };
            let mut part = Part {
                kind: piece.kind,
                low: piece.low,
                off_low: off(piece.low),
                ..Part::default()
            };
            let extrema = self.lines.extrema(piece.kind);
            let inside = extrema
                .iter()
                .filter(|at| **at > piece.low && **at < piece.high);
            for (at, is_extremum) in inside
                .map(|at| (*at, true))
                .chain([(piece.high, number + 1 == pieces.len())])
            {
                (part.high, part.off_high) = (at, off(at));
                part.is_extremum = is_extremum;
                if visit(&part) {
                    return;
                }
                (part.low, part.off_low) = (part.high, part.off_high);
            }
        }
    }

    /// Returns the accelerations and hold times of a motion of the family, in reversed time if `lines` are reversed.
    pub(super) fn shape(&self, member: Member) -> Shape {
        let mut shape = self.lines.shape(member);
        // The acceleration at an end is never passed by rounding: a cruise that starts with the smallest acceleration
        // that is not zero would go on with it.
        shape.peak = shape.peak.max(self.start_acceleration);
        shape.trough = shape.trough.min(self.lines.end_acceleration);
        shape
    }

    /// Returns the velocity (divided by the maximum jerk, s²) at which the acceleration of a motion falls through zero;
    /// `None` if it does not.
    pub(super) fn peak_velocity(&self, member: Member) -> Option<f64> {
        let shape = self.shape(member);
        let peak = self.lines.first + shape.peak * (shape.peak + shape.peak_hold);
        (shape.peak >= 0.0 && shape.trough <= 0.0).then_some(peak)
    }

    /// Returns the durations (s) of the seven phases of a motion of the family.
    pub(super) fn times(&self, member: Member) -> Times {
        let shape = self.shape(member);
        let (fall, cruise, second_fall) = match shape.cruise {
            Some(cruise) => (shape.peak, cruise, -shape.trough),
            None => (shape.peak - shape.trough, 0.0, 0.0),
        };
        let mut times = [
            shape.peak - self.start_acceleration,
            shape.peak_hold,
            fall,
            cruise,
            second_fall,
            shape.trough_hold,
            self.lines.end_acceleration - shape.trough,
        ]
        .map(|time| time.max(0.0));
        if self.reversed {
            times.reverse();
        }
        times
    }
}

/// Returns the maximum velocity of the limits, or the one that start and end of the motion need if it is higher.
fn widened_velocity(ends: &Ends) -> f64 {
    let (a0, af) = (ends.start_acceleration, ends.end_acceleration);
    ends.max_velocity
        .max(ends.start_velocity + a0.max(0.0) * a0 / 2.0)
        .max(ends.start_velocity)
        .max(ends.end_velocity + af.min(0.0) * af / 2.0)
        .max(ends.end_velocity)
}
