//! Residual of the tool: what its pose has at a takeover and the path does not have, decaying within the bounds of the
//! tool.
//!
//! The displacement of the tool decays along three perpendicular directions, the turning alike, and so does the arm
//! angle of a redundant arm. The first direction is that of the velocity that the path does not have; it gets the
//! largest share of the bounds, since the displacement mostly lies along it.

use crate::path::line::TURNING_LENGTH;
use nalgebra::{Translation3, Vector3};
use rpi_kin::Pose;
use rpi_kin::rotation::from_rotation_vector;
use rpi_kin::state_to_rest::{AxisState, Bounds, StateToRestProfile};

/// Share of the requested acceleration and jerk of the tool that the residual uses along its own initial velocity.
const ALONG: f64 = 0.45;
/// Share of the requested acceleration and jerk of the tool that the residual uses across its own initial velocity.
/// Together with [`ALONG`] and the share for the motion along the path, it is at most 1.
const ACROSS: f64 = 0.2;

/// Bounds for the decay of the arm angle (position of the elbow): speed (rad/s), acceleration (rad/s²) and jerk
/// (rad/s³).
const ARM_ANGLE: Bounds = Bounds {
    speed: 1.0,
    acceleration: 2.0,
    jerk: 20.0,
};

/// Difference between the tool and the path: displacement (m), rotation vector (rad, base frame) and arm angle (rad).
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Difference {
    pub way: Vector3<f64>,
    pub turn: Vector3<f64>,
    pub arm_angle: f64,
}

/// Planned decay of a vector to 0, along three perpendicular directions.
#[derive(Clone, Copy, Debug, Default)]
struct Decay {
    directions: [Vector3<f64>; 3],
    profiles: [StateToRestProfile; 3],
}

/// Residual of the tool: the difference between tool and path after a takeover, which decays to 0 within the bounds of
/// the tool.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ToolResidual {
    way: Decay,
    turn: Decay,
    arm_angle: StateToRestProfile,
    start_time: f64,
    end: f64,
}

impl Decay {
    /// Plans the decay of a vector with this velocity and acceleration. `None` if a number is not finite.
    fn new(
        vector: Vector3<f64>,
        velocity: Vector3<f64>,
        acceleration: Vector3<f64>,
        bounds: Bounds,
    ) -> Option<Self> {
        let directions = directions(&[velocity, acceleration, vector]);
        let mut decay = Self {
            directions,
            ..Self::default()
        };
        for (k, direction) in directions.iter().enumerate() {
            let share = if k == 0 { ALONG } else { ACROSS };
            let start = AxisState {
                position: vector.dot(direction),
                velocity: velocity.dot(direction),
                acceleration: acceleration.dot(direction),
            };
            let bounds = Bounds {
                speed: 0.5 * bounds.speed,
                acceleration: share * bounds.acceleration,
                jerk: share * bounds.jerk,
            };
            decay.profiles[k] = StateToRestProfile::new(start, 0.0, bounds)?;
        }
        Some(decay)
    }

    /// Returns the vector `ahead` seconds after `elapsed` (s, since the start of the decay), if it continues with the
    /// acceleration that it has at `elapsed`.
    fn near(&self, elapsed: f64, ahead: f64) -> Vector3<f64> {
        let parts = self.directions.iter().zip(&self.profiles);
        parts
            .map(|(direction, profile)| direction * position_near(profile, elapsed, ahead))
            .sum()
    }

    fn velocity_at(&self, elapsed: f64) -> Vector3<f64> {
        let parts = self.directions.iter().zip(&self.profiles);
        parts
            .map(|(direction, profile)| direction * profile.state_at(elapsed).velocity)
            .sum()
    }

    fn duration(&self) -> f64 {
        self.profiles
            .iter()
            .map(StateToRestProfile::duration)
            .fold(0.0, f64::max)
    }
}

/// Returns the position of a profile `ahead` seconds after the time `elapsed` (s), if it continues with the
/// acceleration that it has at `elapsed`.
fn position_near(profile: &StateToRestProfile, elapsed: f64, ahead: f64) -> f64 {
    profile.state_at(elapsed).advanced(ahead, 0.0).position
}

/// Returns three perpendicular unit vectors. The first one has the direction of the first vector that is not 0, the
/// others that of the following vectors, as far as they are independent.
fn directions(vectors: &[Vector3<f64>; 3]) -> [Vector3<f64>; 3] {
    /// Length below which a vector counts as zero, because its direction is only rounding; in the unit of the vectors
    /// (m, m/s or m/s²).
    const SHORTEST: f64 = 1e-9;
    let mut found = [Vector3::zeros(); 3];
    let mut count = 0;
    let others = [Vector3::x(), Vector3::y(), Vector3::z()];
    for vector in vectors.iter().chain(&others) {
        let known = found[..count].iter();
        let rest = known.fold(*vector, |rest, one| rest - one * one.dot(&rest));
        let length = libm::sqrt(rest.norm_squared());
        if count < 3 && length > SHORTEST && length > 1e-3 * libm::sqrt(vector.norm_squared()) {
            found[count] = rest / length;
            count += 1;
        }
    }
    found
}

impl ToolResidual {
    /// Plans the decay from the time `start_time` of the motion (s) on. `before`, `now` and `after` are the differences
    /// between tool and path `step` seconds before `start_time`, then, and `step` seconds after it, if arm and path
    /// continue unchanged. `None` if a number is not finite.
    pub(crate) fn new(
        [before, now, after]: &[Difference; 3],
        step: f64,
        start_time: f64,
        requested: Bounds,
    ) -> Option<Self> {
        let first = |a: Vector3<f64>, c: Vector3<f64>| (c - a) / (2.0 * step);
        let second =
            |a: Vector3<f64>, b: Vector3<f64>, c: Vector3<f64>| (a - b * 2.0 + c) / (step * step);
        let way = Decay::new(
            now.way,
            first(before.way, after.way),
            second(before.way, now.way, after.way),
            requested,
        )?;
        let turning = Bounds {
            speed: requested.speed / TURNING_LENGTH,
            acceleration: requested.acceleration / TURNING_LENGTH,
            jerk: requested.jerk / TURNING_LENGTH,
        };
        let turn = Decay::new(
            now.turn,
            first(before.turn, after.turn),
            second(before.turn, now.turn, after.turn),
            turning,
        )?;
        let angle = AxisState {
            position: now.arm_angle,
            velocity: (after.arm_angle - before.arm_angle) / (2.0 * step),
            acceleration: (before.arm_angle - 2.0 * now.arm_angle + after.arm_angle)
                / (step * step),
        };
        let arm_angle = StateToRestProfile::new(angle, 0.0, ARM_ANGLE)?;
        let duration = way
            .duration()
            .max(turn.duration())
            .max(arm_angle.duration());
        Some(Self {
            way,
            turn,
            arm_angle,
            start_time,
            end: start_time + duration,
        })
    }

    /// Returns the time of the motion (s) from which the tool is on the path.
    pub(crate) fn end(&self) -> f64 {
        self.end
    }

    /// Returns the pose of the tool for the pose `path` of the path, `ahead` seconds after `time` (s), if the
    /// displacement continues with the acceleration that it has at `time`.
    pub(crate) fn displaced(&self, path: &Pose, time: f64, ahead: f64) -> Pose {
        let elapsed = time - self.start_time;
        let turn = from_rotation_vector(self.turn.near(elapsed, ahead));
        Pose::from_parts(
            Translation3::from(path.translation.vector + self.way.near(elapsed, ahead)),
            turn * path.rotation,
        )
    }

    /// Returns the difference of the arm angle from that of the path, rad; `time` and `ahead` as for
    /// [`ToolResidual::displaced`].
    pub(crate) fn arm_angle_at(&self, time: f64, ahead: f64) -> f64 {
        position_near(&self.arm_angle, time - self.start_time, ahead)
    }

    /// Returns the maximum speed of the displacement, m/s, at `count` times during the decay.
    pub(crate) fn greatest_speed(&self, count: u32) -> f64 {
        let width = (self.end - self.start_time) / f64::from(count);
        let speeds = (0..count).map(|k| self.way.velocity_at(width * f64::from(k)).norm_squared());
        libm::sqrt(speeds.fold(0.0, f64::max))
    }
}
