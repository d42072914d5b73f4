//! Simulated faults of devices.

use nalgebra::Vector6;

/// Fault to be simulated, with the time in which it is active.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScheduledFault {
    /// Start time, in s of the cell's time.
    pub from: f64,
    /// End time, in s of the cell's time; infinity for a permanent fault.
    pub until: f64,
    /// What fails, such as a joint or the transmission of samples.
    pub kind: FaultKind,
}

/// Kind of a simulated fault.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FaultKind {
    /// One axis (from 0) fails: it rejects set-points and the arm brakes.
    JointFailure(usize),
    /// The emergency stop is pressed: the arm brakes and rejects all set-points.
    EmergencyStop,
    /// The device delivers no samples: its sensors are absent.
    LostSamples,
    /// Set-points do not reach the device: they are lost.
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
