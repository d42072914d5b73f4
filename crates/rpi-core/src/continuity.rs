//! Continuity check at a takeover: compares the first set-points of the successor with the last ones of its
//! predecessor.

use crate::command::Command;
use rpi_image::image::ActuatorPort;
use rpi_prims::FaultCode;

/// Reaction to a discontinuous takeover. A takeover is continuous if position, velocity and acceleration, computed by
/// backward differences, stay within the limits of the device.
///
/// Only the first two cycles are checked, because their differences reach back over the takeover.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum Continuity {
    /// The successor ends with a fault. None of its set-points is sent, and its moving devices are stopped.
    #[default]
    Reject,
    /// If the first set-points after a takeover jump, the successor is rejected ([`Continuity::Reject`]) and all
    /// other commands are aborted too. For devices that must move in step.
    AbortAll,
    /// The discontinuity is reported and the set-point is sent. The device may still reject it.
    Allow,
}

/// Number of cycles after a takeover in which the first and second differences of set-points reach back to set-points
/// of the predecessor.
pub(crate) const CHECKED_CYCLES: u64 = 2;

impl Command {
    /// Sets the reaction to a discontinuous takeover by this command. The default is [`Continuity::Reject`].
    pub fn set_continuity(&mut self, continuity: Continuity) {
        self.continuity = continuity;
    }

    /// Returns the reaction to a discontinuous takeover by this command.
    #[must_use]
    pub fn continuity(&self) -> Continuity {
        self.continuity
    }

    /// Raises a fault if a set-point of this cycle is discontinuous, unless the command has [`Continuity::Allow`].
    pub(crate) fn check_continuity(&mut self) {
        let jump = self.instance.discontinuity().map(ActuatorPort::origin_slot);
        if let Some(cell) = jump.filter(|_| self.continuity != Continuity::Allow) {
            self.instance.fail(FaultCode::Discontinuity, cell);
        }
    }
}
