//! A simulated arm accepts and rejects set-points as a real controller does, and never stays in motion without control.

mod braking;
mod faults;
mod rig;
mod set_points;
