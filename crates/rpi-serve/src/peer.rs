//! Network origin of clients.

use std::fmt;
use std::net::{IpAddr, Ipv6Addr};

/// Network origin of a client. Limited resources are shared between peers, so that one machine cannot take all of them.
/// All connections from the server's own machine count as one peer.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) enum Peer {
    /// The server's own machine: a loopback address or a Unix socket.
    Local,
    /// Address of another machine. An IPv6 address is reduced to its /64 network, in which one machine may use any
    /// number of addresses (RFC 4291).
    Remote(IpAddr),
}

impl Peer {
    pub(crate) fn from_ip(address: IpAddr) -> Peer {
        match address.to_canonical() {
            address if address.is_loopback() => Peer::Local,
            IpAddr::V6(six) => {
                let network = six.to_bits() >> 64 << 64;
                Peer::Remote(Ipv6Addr::from_bits(network).into())
            }
            four => Peer::Remote(four),
        }
    }
}

impl fmt::Display for Peer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Peer::Local => f.write_str("this machine"),
            Peer::Remote(IpAddr::V6(network)) => write!(f, "{network}/64"),
            Peer::Remote(address) => address.fmt(f),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_of_one_machine_are_one_peer() {
        let peer = |text: &str| Peer::from_ip(text.parse().unwrap());
        for here in ["127.0.0.1", "127.3.2.1", "::1", "::ffff:127.0.0.1"] {
            assert_eq!(peer(here), Peer::Local, "{here}");
        }
        assert_eq!(peer("::ffff:10.0.0.7"), peer("10.0.0.7"));
        assert_ne!(peer("10.0.0.7"), peer("10.0.0.8"));
        assert_eq!(peer("2001:db8::1"), peer("2001:db8::ffff:2"));
        assert_eq!(peer("2001:db8:0:1::1").to_string(), "2001:db8:0:1::/64");
    }
}
