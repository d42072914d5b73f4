//! Comparison of states of one axis.

use rpi_kin::state_to_rest::AxisState;

/// Returns the difference between two states.
pub(super) fn difference(one: &AxisState, other: &AxisState) -> AxisState {
    AxisState {
        position: one.position - other.position,
        velocity: one.velocity - other.velocity,
        acceleration: one.acceleration - other.acceleration,
    }
}

/// Returns true if position (rad), velocity (rad/s) and acceleration (rad/s²) of a difference are at most `most`.
pub(super) fn is_within(difference: &AxisState, most: [f64; 3]) -> bool {
    let AxisState {
        position,
        velocity,
        acceleration,
    } = difference;
    position.abs() <= most[0] && velocity.abs() <= most[1] && acceleration.abs() <= most[2]
}

/// Returns true if an axis is at rest.
pub(super) fn rests(state: &AxisState) -> bool {
    state.velocity == 0.0 && state.acceleration == 0.0
}
