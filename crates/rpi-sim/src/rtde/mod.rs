//! Driver of arms of Universal Robots by their real-time data exchange (RTDE): `kind = "ur-arm"`.
//!
//! The driver sends a URScript program to the controller, which follows joint set-points in registers. A thread of the
//! driver exchanges the registers and the state of the controller at the rate of the controller, 500 Hz or 125 Hz. Source
//! of the protocol: Universal Robots, "Real-Time Data Exchange (RTDE) Guide", and the URScript manual.
//!
//! The settings of the kind are always there. The driver itself is behind the feature `rtde`.

#[cfg(feature = "rtde")]
mod arm;
#[cfg(feature = "rtde")]
mod error;
#[cfg(feature = "rtde")]
mod exchange;
#[cfg(feature = "rtde")]
mod link;
#[cfg(feature = "rtde")]
mod pace;
#[cfg(feature = "rtde")]
mod package;
#[cfg(feature = "rtde")]
mod player;
#[cfg(feature = "rtde")]
mod program;
#[cfg(feature = "rtde")]
mod recipe;
#[cfg(feature = "rtde")]
mod session;
#[cfg(feature = "rtde")]
mod status;
#[cfg(feature = "rtde")]
mod upload;

#[cfg(feature = "rtde")]
pub(crate) use arm::UrController;

use core::ops::RangeInclusive;

/// Number of axes of all arms of Universal Robots.
pub(crate) const AXES: usize = 6;

/// Range of the time limit of the connection, in s. Below, jitter counts as a loss; above, an arm without a driver moves on.
pub(crate) const TIMEOUT: RangeInclusive<f64> = 0.02..=1.0;
/// Range of the time by which `servoj` looks ahead, in s. Source: URScript manual, `servoj`.
pub(crate) const LOOKAHEAD: RangeInclusive<f64> = 0.03..=0.2;
/// Range of the proportional gain of `servoj`. Source: URScript manual, `servoj`.
pub(crate) const GAIN: RangeInclusive<f64> = 100.0..=2000.0;

/// Settings of the connection to the controller of an arm of Universal Robots, `kind = "ur-arm"`.
#[derive(Clone, Debug, PartialEq)]
pub struct UrSpec {
    /// Name or IP address of the controller.
    pub host: String,
    /// TCP port of RTDE, 30004 on a real controller.
    pub rtde_port: u16,
    /// TCP port that accepts URScript programs, 30002 on a real controller.
    pub script_port: u16,
    /// Time without a state of the controller, or for the controller without a set-point, after which the connection
    /// counts as lost, in s, 0.02 to 1.
    pub timeout: f64,
    /// Time by which `servoj` looks ahead, in s, 0.03 to 0.2: longer is smoother, with more lag.
    pub lookahead: f64,
    /// Proportional gain of `servoj`, 100 to 2000.
    pub gain: f64,
}
