//! When a motion passes a place on its path: in the last period exactly, in the future as planned now.

use super::MotionCore;
use crate::passage::time_of_passage;

impl MotionCore {
    /// Returns the position along the path (path parameter: m, or rad on a joint line) `elapsed` seconds after the last
    /// set-point; negative down to minus one period. It is 0 while the arm still follows the previous motion.
    #[must_use]
    pub fn path_position(&self, elapsed: f64) -> f64 {
        match self.approach {
            Some(_) => 0.0,
            None => {
                let time = self.cycle as f64 * self.period + elapsed;
                self.course.held.state_at(time).s
            }
        }
    }

    /// Returns the time (s) from the last set-point until the motion reaches the position `place` along the path, as
    /// planned now: with the present override, and as fast as the part of the path allows that is known so far. `None`
    /// without a plan that leads there: before the motion along the path begins, and while it pauses.
    #[must_use]
    pub fn time_until(&self, place: f64) -> Option<f64> {
        let held = &self.course.held;
        let now = self.cycle as f64 * self.period - held.start_time;
        let plan = held.piece.filter(|_| self.approach.is_none())?;
        let leads_there = now < held.piece_time && plan.goal() >= place;
        let at = |time: f64| plan.state_at(time).position;
        leads_there.then(|| time_of_passage(at, (now, plan.duration()), place) - now)
    }
}
