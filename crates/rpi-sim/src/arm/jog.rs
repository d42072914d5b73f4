//! Motions of the tool with a velocity: the device functions `move_tool_in_base` and `move_tool_in_tool`.
//!
//! While the direction of the twist stays the same, the tool moves on one path, whose speed follows the size of the twist. Another
//! direction is another path, which takes over in motion. A takeover needs a few cycles, so directions that change all the
//! time are followed in steps.

use crate::device::real_at;
use nalgebra::Vector3;
use rpi_kin::Pose;
use rpi_motion::path::twist::twist_speed;
use rpi_motion::path::{Piece, ToolPath, TwistFrame, TwistPath};
use rpi_motion::{Controls, Path};

/// Motion of the tool in one direction, whose speed the command sets in each cycle (jogging).
#[derive(Clone, Copy, Debug)]
pub(super) struct Jog {
    frame: TwistFrame,
    /// Linear (m/s) and angular velocity (rad/s) of the tool at a speed of 1 along the path; `None` while the arm holds
    /// still.
    direction: Option<Direction>,
    /// Simulated time at which the arm began to move in this direction, s.
    since: f64,
}

/// Linear and angular velocity (m/s, rad/s) at a speed of 1 along the path.
type Direction = [Vector3<f64>; 2];

/// Minimum time for which the arm moves in a direction before it takes another one, s.
const SHORTEST: f64 = 0.05;

/// Difference of two directions (m/s, rad/s, at a speed of 1 along the path) below which they are the same.
const SAME: f64 = 1e-6;

/// Speed along the path below which a requested velocity counts as zero, m/s.
const SLOWEST: f64 = 1e-9;

impl Jog {
    pub(super) fn new(frame: TwistFrame, target: &[u64], time: f64) -> Self {
        Self {
            frame,
            direction: direction_of(target).map(|(_, direction)| direction),
            since: time,
        }
    }

    /// Returns the path of the tool from the pose `start` in this direction; `None` if the arm shall hold still.
    pub(super) fn path(&self, start: &Pose) -> Option<Path> {
        let [linear, angular] = self.direction?;
        let path = TwistPath::new(start, &linear, &angular, self.frame)?;
        Some(Path::Tool(ToolPath::new(Piece::Twist(path))))
    }

    /// Returns true if `target` requests a path in another direction at the simulated time `time` (s). A new direction
    /// is taken only after a minimum time.
    pub(super) fn is_outdated(&self, target: &[u64], time: f64) -> bool {
        let Some((_, requested)) = direction_of(target) else {
            return false;
        };
        let is_same = |present: &Direction| {
            let mut both = present.iter().zip(&requested);
            both.all(|(one, other)| (one - other).norm_squared() < SAME * SAME)
        };
        !self.direction.as_ref().is_some_and(is_same) && time - self.since >= SHORTEST
    }

    /// Returns the controls for the motion along the path: the speed is the part of the requested velocity along the
    /// present direction, at most `fastest` (m/s).
    pub(super) fn controls(&self, target: &[u64], fastest: f64, controls: Controls) -> Controls {
        let speed = match (direction_of(target), &self.direction) {
            (Some((speed, requested)), Some(present)) => {
                let along: f64 = requested.iter().zip(present).map(|(a, b)| a.dot(b)).sum();
                let own: f64 = present.iter().map(Vector3::norm_squared).sum();
                speed * (along / own).max(0.0)
            }
            _ => 0.0,
        };
        Controls {
            speed_share: controls.speed_share * (speed / fastest).min(1.0),
            paused: controls.paused || speed < SLOWEST,
        }
    }
}

/// Returns speed along the path (m/s) and direction of a target, which is a linear and an angular velocity in slots.
/// `None` if the velocity is zero or not finite.
fn direction_of(target: &[u64]) -> Option<(f64, Direction)> {
    let [linear, angular] = [0, 3].map(|from| Vector3::from_fn(|k, _| real_at(target, from + k)));
    let speed = twist_speed(&linear, &angular);
    let is_usable = speed >= SLOWEST && speed.is_finite();
    is_usable.then(|| (speed, [linear / speed, angular / speed]))
}
