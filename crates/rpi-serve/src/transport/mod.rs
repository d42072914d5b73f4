//! Transport: connections, HTTP heads, websockets, authentication.

mod auth;
mod auth_throttle;
mod framing;
mod http_head;
mod listener;
mod outbox;
#[cfg_attr(not(feature = "tls"), path = "no_tls.rs")]
mod tls;
#[cfg(unix)]
mod unix_socket;

pub(crate) use auth::AuthPolicy;
pub(crate) use auth_throttle::AuthThrottle;
pub(crate) use framing::ConnectionHandler;
pub(crate) use http_head::Head;
pub(crate) use listener::Acceptor;
pub(crate) use outbox::{Outbox, SubscriptionSender};
pub(crate) use tls::TlsIdentity;
#[cfg(unix)]
pub(crate) use unix_socket::bind;
