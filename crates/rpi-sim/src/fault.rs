//! Simulated faults of devices.

use nalgebra::Vector6;

/// Simulated fault of a device, with the time in which it is active.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScheduledFault {
    /// Start of the fault, in s of simulated time.
    pub from: f64,
    /// End of the fault, in s of simulated time; infinity for a permanent fault.
    pub until: f64,
    /// Kind of the fault, such as a failed joint or lost samples.
    pub kind: FaultKind,
}

/// Kind of a simulated fault.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FaultKind {
    /// The axis with this index, counted from 0, fails: it rejects set-points and the arm brakes.
    JointFailure(usize),
    /// The emergency stop is pressed: the arm brakes and rejects all set-points.
    EmergencyStop,
    /// The device delivers no samples: its sensors are absent.
    LostSamples,
    /// Set-points that the control core sends do not reach the device.
    LostSetPoints,
    /// Samples of the sensors are delayed by this many additional seconds.
    Latency(f64),
    /// Measured joint positions have additional noise with this standard deviation, in rad.
    Noise(f64),
    /// The tool touches something: force (N), then torque (N m) at the tool, in the base frame.
    Contact(Vector6<f64>),
}

impl ScheduledFault {
    /// True if the fault is active at the simulated time `time`, in s.
    #[must_use]
    pub fn is_active(&self, time: f64) -> bool {
        time >= self.from && time < self.until
    }
}
