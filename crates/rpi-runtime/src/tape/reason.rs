//! Numbers of the reasons for which all commands are ended.

use rpi_core::Why;

/// Reasons of an abort. The index of a reason is its key on the tape, so the order must not change.
const REASONS: [Why; 5] = [
    Why::Request,
    Why::Overrun,
    Why::EmergencyStop,
    Why::ClientLost,
    Why::Discontinuity,
];

/// Returns the number of a reason.
#[must_use]
pub fn number_of(why: Why) -> u32 {
    let place = REASONS.iter().position(|known| *known == why);
    place.map_or(u32::MAX, |place| place as u32)
}

/// Returns the reason with this number.
#[must_use]
pub fn why_of(number: u32) -> Option<Why> {
    REASONS.get(number as usize).copied()
}
