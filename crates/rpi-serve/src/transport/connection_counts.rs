//! Numbers of connections, for monitoring.

use super::auth_throttle::AuthThrottle;
use super::places::Places;

/// Numbers of open and of rejected connections.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct ConnectionCounts {
    /// Number of open connections with the name of each kind of place.
    pub(crate) open: [(&'static str, usize); 4],
    /// Number of rejected connections and requests since the start of the server with the name of each reason.
    pub(crate) rejected: [(&'static str, u64); 3],
}

impl ConnectionCounts {
    /// Counts the connections of this moment.
    pub(crate) fn new(places: &Places, throttle: &AuthThrottle) -> ConnectionCounts {
        ConnectionCounts {
            open: places.counts(),
            rejected: throttle.totals(),
        }
    }
}
