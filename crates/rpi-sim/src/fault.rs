//! Simulated faults of devices.

use nalgebra::Vector6;

/// A fault with its interval of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScheduledFault {
    /// Start time, in s of the cell's time.
    pub from: f64,
    /// End time, in s of the cell's time; infinity for a permanent fault.
    pub until: f64,
    /// Kind of the fault.
    pub kind: FaultKind,
}

/// Kind of a fault.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FaultKind {
    /// One axis (from 0) fails: it rejects set-points and the arm brakes.
    JointFailure(usize),
    /// The emergency stop is pressed: the arm brakes and rejects all set-points.
    EmergencyStop,
    /// The device delivers no samples: its sensors are absent.
    LostSamples,
    /// Set-points do not reach the device.
    LostSetPoints,
    /// Samples are delayed by this many seconds.
    Latency(f64),
    /// Additional noise of measured joint positions: standard deviation in rad.
    Noise(f64),
    /// A contact at the tool: force (N), then torque (N m), in base coordinates.
    Contact(Vector6<f64>),
}

impl ScheduledFault {
    /// True if the fault is active at `time`, in s.
    #[must_use]
    pub fn is_active(&self, time: f64) -> bool {
        time >= self.from && time < self.until
    }
}
