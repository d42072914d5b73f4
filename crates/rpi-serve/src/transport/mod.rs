//! Transport: connections, HTTP heads, websockets, authentication.

mod auth;
mod auth_throttle;
mod connection_counts;
mod framing;
mod http_head;
mod listener;
mod outbox;
mod places;
#[cfg_attr(not(feature = "tls"), path = "no_tls.rs")]
mod tls;
#[cfg(unix)]
mod unix_socket;

pub(crate) use auth::AuthPolicy;
pub(crate) use auth_throttle::AuthThrottle;
pub(crate) use connection_counts::ConnectionCounts;
pub(crate) use framing::ConnectionHandler;
pub(crate) use http_head::Head;
pub(crate) use listener::Acceptor;
pub(crate) use outbox::{Outbox, SubscriptionSender};
#[cfg(test)]
pub(crate) use outbox::{OutboxReceiver, outbox};
pub(crate) use places::Places;
pub(crate) use tls::TlsIdentity;
#[cfg(unix)]
pub(crate) use unix_socket::bind;
