//! Numbers of the reasons for which all commands are ended.

use rpi_core::AbortReason;

/// Reasons for aborting all commands. The index of a reason is its number in the tick log, so the order must not
/// change.
const REASONS: [AbortReason; 6] = [
    AbortReason::Request,
    AbortReason::Overrun,
    AbortReason::EmergencyStop,
    AbortReason::ClientLost,
    AbortReason::Discontinuity,
    AbortReason::CancelTimeout,
];

/// Returns the number that stands for an abort reason in the tick log.
#[must_use]
pub fn reason_number(why: AbortReason) -> u32 {
    let place = REASONS.iter().position(|known| *known == why);
    place.map_or(u32::MAX, |place| place as u32)
}

/// Returns the abort reason with this number in the tick log; `None` if the number is unknown.
#[must_use]
pub fn reason_from_number(number: u32) -> Option<AbortReason> {
    REASONS.get(number as usize).copied()
}
