//! Pieces of a family of extremal motions, in the order of their durations.

use super::lines::{Lines, Member, PieceKind};
use super::root::root;

/// Piece of a family of extremal motions: an interval (`low` to `high`) of its parameter in which the same limits are
/// reached.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Piece {
    pub(super) kind: PieceKind,
    pub(super) low: f64,
    pub(super) high: f64,
}

/// Pieces of a family of extremal motions, in the order of their durations, in one or two segments without gaps.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pieces {
    pieces: [Piece; 8],
    count: usize,
    /// Number of pieces of the first segment; 0 if there is only one segment.
    split: usize,
}

/// Bounds of the piece whose motions reach no limit: `side` is the magnitude of the trough of the acceleration whose
/// peak just reaches the maximum acceleration. `room` is its square; if it is not positive, there is no such motion.
struct Bounds {
    room: f64,
    side: f64,
}

impl Pieces {
    /// Collects the intervals of the parameter in which the profiles of a family have one shape. `lines` are the boundary
    /// values of the family, `start` is the acceleration at the start of its profiles.
    pub(super) fn new(lines: &Lines, start: f64) -> Self {
        let room = lines.top * lines.top - lines.gain;
        let bounds = Bounds {
            room,
            side: libm::sqrt(room.max(0.0)),
        };
        let mut pieces = Self::default();
        let shortest = pieces.add_before_zero(lines, start, &bounds);
        pieces.add_without_both(lines, start, shortest, &bounds);
        let lowest =
            (lines.first + lines.top * lines.top).max(lines.last + lines.bottom * lines.bottom);
        pieces.push(PieceKind::HoldBoth, lowest, lines.fastest);
        pieces.push(PieceKind::Cruise, 0.0, f64::INFINITY);
        pieces
    }

    fn push(&mut self, kind: PieceKind, low: f64, high: f64) {
        if low <= high {
            self.pieces[self.count] = Piece { kind, low, high };
            self.count += 1;
        }
    }

    /// Adds the first segment, or the piece in which the trough of the acceleration is still positive. Returns the
    /// shortest duration (s) of the falling acceleration in the piece after it.
    fn add_before_zero(&mut self, lines: &Lines, start: f64, bounds: &Bounds) -> f64 {
        let (gain, top, end) = (lines.gain, lines.top, lines.end_acceleration);
        let end_root = libm::sqrt(end * end + gain);
        // Shortest fall for which the last rise is not negative.
        let shortest = if end > 0.0 {
            gain / (end + end_root)
        } else {
            end_root - end
        };
        let at_top = gain / (top + bounds.side);
        let gap = start * start - gain;
        if start > 0.0 && gap > 0.0 {
            // Falls between both roots would need a peak below the start acceleration.
            let trough = libm::sqrt(gap);
            if end >= trough {
                self.push(PieceKind::HoldHigh, top - end, top - bounds.side);
                let longest = gain / (start + trough);
                self.push(
                    PieceKind::Switching,
                    shortest.max(at_top).min(longest),
                    longest,
                );
                self.split = self.count;
            }
            shortest.max(start + trough)
        } else if bounds.room > 0.0 && end > bounds.side {
            self.push(PieceKind::HoldHigh, top - end, top - bounds.side);
            shortest.max(at_top)
        } else {
            shortest
        }
    }

    /// Adds the pieces whose motions reach no limit of the acceleration, or only one of both. `shortest` is the
    /// shortest duration (s) of the falling acceleration.
    fn add_without_both(&mut self, lines: &Lines, start: f64, shortest: f64, bounds: &Bounds) {
        let Lines {
            gain,
            top,
            bottom,
            rise,
            fall,
            end_acceleration: end,
            ..
        } = *lines;
        let Bounds { room, side } = *bounds;
        let at_bottom = libm::sqrt(bottom * bottom + gain);
        if room > 0.0 {
            let longest = (top + side)
                .min(bottom + at_bottom)
                .min(libm::sqrt(rise) + libm::sqrt(fall));
            self.push(PieceKind::Switching, shortest, longest);
        }
        if room <= 0.0 || side <= bottom {
            let highest = if room > 0.0 { end.min(-side) } else { end };
            let deepest = libm::sqrt(fall).min(bottom);
            self.push(PieceKind::HoldHigh, top - highest, top + deepest);
        }
        if room > 0.0 && side >= bottom {
            let lowest = at_bottom.max(start);
            let highest = libm::sqrt(rise).min(top);
            self.push(PieceKind::HoldLow, lowest + bottom, highest + bottom);
        }
    }

    /// Returns true if the possible durations form two separate intervals (segments).
    pub(super) fn has_two_segments(&self) -> bool {
        self.split > 0
    }

    /// Returns the pieces of the first of two segments if `is_first`, else of the last or only segment.
    pub(super) fn segment(&self, is_first: bool) -> &[Piece] {
        let (from, to) = if is_first {
            (0, self.split)
        } else {
            (self.split, self.count)
        };
        &self.pieces[from..to]
    }
}

/// Part of a piece in which the position only grows or only shrinks: an interval of the parameter (`low` to `high`),
/// with the distance of the position from the target at both ends (`off_low`, `off_high`).
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Part {
    pub(super) kind: PieceKind,
    pub(super) low: f64,
    pub(super) off_low: f64,
    pub(super) high: f64,
    pub(super) off_high: f64,
    /// True if the position has an extremum at `high`, or if the segment ends there.
    pub(super) is_extremum: bool,
}

impl Part {
    /// Returns the motion of this part whose position is nearest to `target`.
    pub(super) fn solve(&self, lines: &Lines, target: f64) -> Member {
        let kind = self.kind;
        let at = if kind == PieceKind::Cruise {
            (-self.off_low / lines.fastest).max(0.0)
        } else {
            root((self.low, self.off_low), (self.high, self.off_high), |at| {
                let member = Member { kind, at };
                (lines.position(member) - target, lines.slope(member))
            })
        };
        Member { kind, at }
    }
}
