//! Arm angle of a redundant arm along a path: held, and moved smoothly where the ranges of the axes demand it.
//!
//! An arm angle that is clamped to the allowed interval in each place makes a kink in the joints. So places ahead are
//! looked at, and where the present arm angle is not allowed, it moves on the way there, with three continuous
//! derivatives.
//!
//! Where the upper arm stands upright, axes 1 and 3 are in line: with a held arm angle both turn at once, by the angle
//! between the plane of the arm and the way of the elbow. With the value of axis 3 held instead, nothing is singular
//! there. So a path that begins there holds axis 3 first, and then the arm angle.

use crate::held_axis::HeldAxis;

/// Maximum number of changes of the arm angle on one path.
const MOVES: usize = 32;

/// Smooth change of the arm angle (position of the elbow of a redundant arm) on a stretch of the path.
#[derive(Clone, Copy, Debug, Default)]
struct Move {
    /// Position along the path (path parameter) at which the change begins, m.
    from: f64,
    /// Length of the path on which the arm angle changes, m.
    length: f64,
    /// Change of the arm angle, rad.
    change: f64,
}

impl Move {
    fn change_at(&self, s: f64) -> f64 {
        self.change * smooth_step((s - self.from) / self.length)
    }
}

/// Returns the polynomial of `share` that rises from 0 (at 0 and below) to 1 (at 1 and above) and whose first three
/// derivatives are 0 at both ends.
pub(crate) fn smooth_step(share: f64) -> f64 {
    let u = share.clamp(0.0, 1.0);
    u * u * u * u * (35.0 - u * (84.0 - u * (70.0 - 20.0 * u)))
}

/// Arm angle (position of the elbow of a redundant arm) as a function of the position along the path.
#[derive(Clone, Copy, Debug, Default)]
pub struct ArmAngle {
    start: f64,
    moves: [Move; MOVES],
    count: usize,
    held: Option<HeldAxis>,
}

impl ArmAngle {
    /// Creates the constant arm angle `start`, rad.
    #[must_use]
    pub fn constant(start: f64) -> Self {
        Self {
            start,
            ..Self::default()
        }
    }

    /// Returns the arm angle (rad) at the position `s` (m) along the path. `of_third` returns the arm angle (rad) at
    /// this position for a value of axis 3 (rad), near to another arm angle (rad).
    #[must_use]
    pub fn at(&self, s: f64, of_third: impl FnOnce(f64, f64) -> Option<f64>) -> f64 {
        let begun = self.moves[..self.count]
            .iter()
            .take_while(|one| one.from < s);
        let moved = begun.map(|one| one.change_at(s)).sum::<f64>();
        let angle = self.start + moved;
        let held = self.held.map(|held| (held, held.weight_at(s)));
        let third = held
            .filter(|(_, weight)| *weight > 0.0)
            .and_then(|(held, weight)| of_third(held.third(), angle).map(|own| (own, weight)));
        third.map_or(angle, |(own, weight)| {
            angle + weight * (own + moved - angle)
        })
    }

    /// Returns the value (rad) at which axis 3 is held at the position `s` (m) along the path; `None` if the arm angle
    /// determines axis 3 there.
    #[must_use]
    pub fn held_third_axis(&self, s: f64) -> Option<f64> {
        let is_moved = self.count > 0 && self.moves[0].from < s;
        let held = self.held.filter(|held| held.weight_at(s) >= 1.0)?;
        (!is_moved).then(|| held.third())
    }

    /// Holds axis 3 at `third` (rad) from the start of the path on, instead of the arm angle.
    pub fn hold_axis(&mut self, third: f64) {
        self.held = Some(HeldAxis::new(third));
    }

    /// Returns true if axis 3 is held at its value without a known end.
    #[must_use]
    pub fn holds_axis(&self) -> bool {
        self.held.is_some_and(|held| held.is_open())
    }

    /// Ends the holding of axis 3: between the positions `from` and `to` (m) along the path, the arm passes over to the
    /// arm angle `angle` (rad), in which all changes added so far are included.
    pub fn release_axis(&mut self, from: f64, to: f64, angle: f64) {
        let Some(held) = &mut self.held else { return };
        held.end((from, to));
        let moves = self.moves[..self.count].iter();
        self.start = angle - moves.map(|one| one.change).sum::<f64>();
    }

    /// Returns the position along the path (m) at which the last change ends and a new one may begin.
    #[must_use]
    pub fn end(&self) -> f64 {
        let last = self.count.checked_sub(1).map(|k| self.moves[k]);
        last.map_or(f64::NEG_INFINITY, |one| one.from + one.length)
    }

    /// Adds a change of the arm angle by `change` (rad) between two positions along the path (m), both behind the last
    /// change. Returns false if there are too many changes, or if `to` is not greater than `from`.
    pub fn add(&mut self, from: f64, to: f64, change: f64) -> bool {
        let Some(slot) = self.moves.get_mut(self.count) else {
            return false;
        };
        if to <= from || to.is_nan() {
            return false;
        }
        *slot = Move {
            from,
            length: to - from,
            change,
        };
        self.count += 1;
        true
    }
}
