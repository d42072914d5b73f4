//! The guard at a switch: whether the first set-points of who takes over join those of who went before.

use crate::command::Command;
use rpi_image::image::Actuator;
use rpi_prims::FaultCode;

/// What happens if a set-point of a command that takes over does not join those before it within the limits of its device:
/// position, velocity and acceleration by backward differences.
///
/// The differences reach over the switch in the first two cycles; these are looked at.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum Continuity {
    /// The command that took over ends with a fault in that cycle. None of its set-points is handed over, and what moves is
    /// stopped by its device.
    #[default]
    Refuse,
    /// As refused, and everything else is stopped, too: for devices that must keep together.
    Stop,
    /// It is told and the set-point handed over; the device may still refuse it.
    Allow,
}

/// Cycles in which differences up to the second reach over the switch.
pub(crate) const JOINING: u64 = 2;

impl Command {
    /// What happens if it takes over and does not join; [`Continuity::Refuse`] unless said.
    pub fn guard(&mut self, continuity: Continuity) {
        self.continuity = continuity;
    }

    /// What happens if its first set-points do not join those before.
    #[must_use]
    pub fn continuity(&self) -> Continuity {
        self.continuity
    }

    /// Makes a set-point that does not join the fault of this cycle, unless that is allowed.
    pub(crate) fn watch_switch(&mut self) {
        let jump = self.machine.jump().map(Actuator::cell);
        if let Some(cell) = jump.filter(|_| self.continuity != Continuity::Allow) {
            self.machine.fail(FaultCode::Discontinuity, cell);
        }
    }
}
