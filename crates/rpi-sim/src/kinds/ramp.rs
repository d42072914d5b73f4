//! A drive that follows velocity set-points with limited acceleration.

/// Drive with a velocity set-point and limited acceleration. Lengths are in m or rad.
#[derive(Clone, Debug)]
pub(super) struct Ramp {
    /// Duration of a tick, in s.
    tick: f64,
    /// Maximum acceleration, in m/s² or rad/s².
    acceleration: f64,
    /// Velocity set-point, in m/s or rad/s.
    pub(super) target: f64,
    /// Present velocity, in m/s or rad/s.
    pub(super) velocity: f64,
    /// Signed distance travelled since the start of the cell, in m or rad.
    pub(super) position: f64,
}

impl Ramp {
    pub(super) fn new(acceleration: f64, tick: f64) -> Self {
        Self {
            tick,
            acceleration,
            target: 0.0,
            velocity: 0.0,
            position: 0.0,
        }
    }

    /// Simulates one tick: changes the velocity towards the set-point and moves the drive.
    pub(super) fn step(&mut self) {
        let most = self.acceleration * self.tick;
        self.velocity = self
            .target
            .clamp(self.velocity - most, self.velocity + most);
        self.position += self.velocity * self.tick;
    }

    pub(super) fn is_moving(&self) -> bool {
        self.velocity != 0.0 || self.target != 0.0
    }
}
