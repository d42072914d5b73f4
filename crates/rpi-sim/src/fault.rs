//! What can go wrong with a simulated device, and when.

use nalgebra::Vector6;

/// Something that goes wrong for a while.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fault {
    /// When it begins, in s of the cell's time.
    pub from: f64,
    /// When it is over, in s; infinity if never.
    pub until: f64,
    /// What it is.
    pub trouble: Trouble,
}

/// What goes wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Trouble {
    /// One axis (from 0) fails: it refuses set-points and the arm brakes.
    JointFailure(usize),
    /// The arm brakes and refuses everything.
    EmergencyStop,
    /// The device sends no samples: its sensors are absent.
    LostSamples,
    /// Set-points do not reach the device.
    LostSetPoints,
    /// Samples are older by this many seconds.
    Latency(f64),
    /// Measured joint positions are off by this standard deviation more, in rad.
    Noise(f64),
    /// Something pushes at the tool: force (N), then torque (N m), in base coordinates.
    Contact(Vector6<f64>),
}

impl Fault {
    /// Whether it is on at a time, in s.
    #[must_use]
    pub fn is_on(&self, time: f64) -> bool {
        time >= self.from && time < self.until
    }
}
