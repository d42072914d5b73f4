//! Generators of large nets.

mod biquad;
mod mixed;
mod pid;

pub use biquad::biquad;
pub use mixed::mixed;
pub use pid::pid;
