//! Driver of an arm whose controller speaks a small protocol over UDP: `kind = "udp-arm"`.
//!
//! The controller sends its state in every cycle of its own clock, and the driver answers with its newest set-points. The
//! driver is also the example of the chapter on drivers.

mod arm;
mod link;
pub mod protocol;

pub(crate) use arm::UdpController;

use std::net::SocketAddr;

/// Settings of the connection to the controller of an arm, `kind = "udp-arm"`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UdpSpec {
    /// Address and UDP port of the controller.
    pub address: SocketAddr,
    /// Time without a state of the controller after which the connection counts as lost, in s.
    pub timeout: f64,
}
