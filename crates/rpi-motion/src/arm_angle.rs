//! Arm angle of a redundant arm along a path: held, and moved smoothly where the ranges of the axes demand it.
//!
//! An arm angle that is clamped to the allowed interval in each place makes a kink in the joints. So places ahead are
//! looked at, and where the present arm angle is not allowed, it moves on the way there, with three continuous
//! derivatives.

/// Number of moves of the arm angle that one path may have.
const MOVES: usize = 32;

/// Smooth change of the arm angle of a redundant arm, on a stretch of the path.
#[derive(Clone, Copy, Debug, Default)]
struct Move {
    /// Path parameter at the start.
    from: f64,
    /// Length of the stretch.
    length: f64,
    /// Change of the arm angle, rad.
    change: f64,
}

impl Move {
    fn change_at(&self, s: f64) -> f64 {
        let u = ((s - self.from) / self.length).clamp(0.0, 1.0);
        // The polynomial from 0 to 1 whose first three derivatives are 0 at both ends.
        self.change * (u * u * u * u * (35.0 - u * (84.0 - u * (70.0 - 20.0 * u))))
    }
}

/// The arm angle as a function of the path parameter.
#[derive(Clone, Copy, Debug, Default)]
pub struct ArmAngle {
    start: f64,
    moves: [Move; MOVES],
    count: usize,
}

impl ArmAngle {
    /// The constant arm angle `start`, rad.
    #[must_use]
    pub fn constant(start: f64) -> Self {
        Self {
            start,
            ..Self::default()
        }
    }

    /// Returns the arm angle at a value of the path parameter, rad.
    #[must_use]
    pub fn at(&self, s: f64) -> f64 {
        let begun = self.moves[..self.count]
            .iter()
            .take_while(|one| one.from < s);
        self.start + begun.map(|one| one.change_at(s)).sum::<f64>()
    }

    /// Returns the end of the last move: a new one may begin there.
    #[must_use]
    pub fn end(&self) -> f64 {
        let last = self.count.checked_sub(1).map(|k| self.moves[k]);
        last.map_or(f64::NEG_INFINITY, |one| one.from + one.length)
    }

    /// Adds a change (rad) between two values of the path parameter, both behind the last move. Returns false if there
    /// are too many, or the stretch has no length.
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
