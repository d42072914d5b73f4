//! Buffer between the clock of the cell and that of the controller: set-points come once per tick, and are played once
//! per cycle of the controller.

use super::recipe::Joints;
use std::collections::VecDeque;

/// Maximum number of set-points that wait; the oldest are lost beyond it.
const CAPACITY: usize = 1024;
/// Maximum change of the playing speed, as a share: clocks differ by far less, so that it is not visible.
const MAX_CORRECTION: f64 = 0.05;
/// Maximum change of the correction, in 1/s: at 3 rad/s it adds less than 1 rad/s² to the acceleration.
const CORRECTION_RATE: f64 = 0.25;
/// Maximum step of an axis between two set-points at rest, in rad.
const REST_STEP: f64 = 1e-6;

/// Set-points of one epoch with their times, and the time that is being played.
pub(super) struct Player {
    points: VecDeque<(f64, Joints)>,
    /// Time (s, of the cell) up to which the set-points are played; `None` before the first one.
    clock: Option<f64>,
    /// The last set-point that was removed because it has been played.
    played: Option<(f64, Joints)>,
    /// Present correction of the playing speed, as a share.
    correction: f64,
    /// Time by which set-points are played late, in s, so that late ones do no harm.
    delay: f64,
}

impl Player {
    /// Creates an empty buffer that plays set-points `delay` s late.
    pub(super) fn new(delay: f64) -> Self {
        Self {
            points: VecDeque::with_capacity(CAPACITY),
            clock: None,
            played: None,
            correction: 0.0,
            delay,
        }
    }

    /// Removes all set-points, at the start of an epoch.
    pub(super) fn clear(&mut self) {
        self.points.clear();
        (self.clock, self.played, self.correction) = (None, None, 0.0);
    }

    /// Adds the set-point of the cell's time `time`, in s. Times ascend.
    pub(super) fn push(&mut self, time: f64, positions: Joints) {
        if self.points.len() == CAPACITY {
            self.points.pop_front();
        }
        self.points.push_back((time, positions));
    }

    /// True if no set-point has come since the start of the epoch.
    pub(super) fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// Returns the newest set-point; `None` without one.
    pub(super) fn newest(&self) -> Option<Joints> {
        self.points.back().map(|(_, positions)| *positions)
    }

    /// True if the last two set-points are the same, up to the end of a motion with limited jerk.
    pub(super) fn is_at_rest(&self) -> bool {
        let mut newest = self.points.iter().rev();
        match (newest.next(), newest.next().or(self.played.as_ref())) {
            (Some((_, one)), Some((_, other))) => {
                let steps = one
                    .iter()
                    .zip(other)
                    .map(|(one, other)| (one - other).abs());
                steps.fold(0.0, f64::max) < REST_STEP
            }
            _ => true,
        }
    }

    /// Plays the next `duration` s. Returns the positions at their end, between two set-points on a straight line; `None`
    /// if all set-points have been played.
    pub(super) fn advance(&mut self, duration: f64) -> Option<Joints> {
        let (newest, _) = *self.points.back()?;
        let now = match self.clock {
            // Before the oldest one at first, so that the buffer fills.
            None => newest - self.delay,
            Some(clock) if clock >= newest => return None,
            Some(clock) => {
                // The level of the buffer controls the speed, because the clocks differ.
                let excess = (newest - clock - self.delay) / self.delay;
                let wanted = (0.02 * excess).clamp(-MAX_CORRECTION, MAX_CORRECTION);
                let change = CORRECTION_RATE * duration;
                self.correction += (wanted - self.correction).clamp(-change, change);
                (clock + duration * (1.0 + self.correction)).min(newest)
            }
        };
        self.clock = Some(now);
        while self.points.get(1).is_some_and(|(time, _)| *time <= now) {
            self.played = self.points.pop_front();
        }
        let (from, start) = *self.points.front()?;
        let Some((to, end)) = self.points.get(1) else {
            return Some(start);
        };
        let share = ((now - from) / (to - from)).clamp(0.0, 1.0);
        Some(core::array::from_fn(|axis| {
            start[axis] + share * (end[axis] - start[axis])
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rtde::AXES;

    /// Plays a ramp of 1 rad/s with set-points every `tick` s; the controller's clock is fast by `drift`.
    fn play(tick: f64, drift: f64) -> Vec<f64> {
        let mut player = Player::new(2.0 * tick + 0.006);
        let (mut played, mut pushed) = (Vec::new(), 0.0);
        for cycle in 0..5000 {
            let now = f64::from(cycle) * 0.002 / (1.0 + drift);
            while pushed <= now {
                player.push(pushed, [pushed; AXES]);
                pushed += tick;
            }
            played.extend(player.advance(0.002).map(|joints| joints[0]));
        }
        played
    }

    #[test]
    fn a_ramp_stays_a_ramp_whatever_the_clocks() {
        for tick in [0.001, 0.002, 0.004, 0.005] {
            for drift in [0.0, 3e-4, -3e-4] {
                let played = play(tick, drift);
                assert!(played.len() > 4990, "{} of 5000", played.len());
                // The ramp begins with the first set-point, after the delay.
                let ramp = &played[20..];
                let steps = ramp.windows(2).map(|pair| pair[1] - pair[0]);
                let worst = steps.map(|step| (step - 0.002).abs()).fold(0.0, f64::max);
                assert!(worst < 2e-5, "{tick} {drift}: {worst}");
            }
        }
    }

    #[test]
    fn the_last_set_point_is_played_and_then_none() {
        let mut player = Player::new(0.01);
        assert!(player.is_empty() && player.advance(0.002).is_none());
        for tick in 0..10 {
            player.push(f64::from(tick) * 0.002, [f64::from(tick); AXES]);
        }
        let played: Vec<f64> =
            core::iter::from_fn(|| player.advance(0.002).map(|q| q[0])).collect();
        assert_eq!(played.last(), Some(&9.0));
        assert!(player.advance(0.002).is_none() && !player.is_at_rest());
        assert_eq!(player.newest(), Some([9.0; AXES]));
        player.clear();
        assert!(player.is_empty());
    }

    #[test]
    fn a_full_buffer_loses_the_oldest() {
        let mut player = Player::new(0.01);
        (0..2000).for_each(|tick| player.push(f64::from(tick), [0.0; AXES]));
        assert_eq!(player.points.len(), CAPACITY);
        assert_eq!(player.points.front().map(|(time, _)| *time), Some(976.0));
    }
}
