//! Transport: connections, HTTP heads, websockets, authentication.

mod auth;
mod auth_throttle;
mod connection_counts;
mod frame_position;
pub(crate) mod framing;
mod handshake;
mod http;
mod listener;
mod memory_pool;
mod metered_stream;
mod open_connection;
mod outbox;
mod places;
#[cfg_attr(not(feature = "tls"), path = "no_tls.rs")]
mod tls;
#[cfg(unix)]
mod unix_socket;

pub(crate) use self::http::Head;
#[cfg(feature = "entry-points")]
pub(crate) use self::http::RequestError;
pub(crate) use auth::AuthPolicy;
pub(crate) use auth_throttle::AuthThrottle;
pub(crate) use connection_counts::ConnectionCounts;
pub(crate) use framing::{ConnectionHandler, Outgoing, OutgoingMessage, Stream};
pub(crate) use handshake::{
    accept_websocket, finish, is_websocket_upgrade, prepare, rejection, starts_tls,
};
pub(crate) use listener::Acceptor;
pub(crate) use memory_pool::{ConnectionMemory, MemoryPool};
pub(crate) use metered_stream::MeteredStream;
pub(crate) use outbox::{Outbox, QueueSpace, SubscriptionSender};
#[cfg(any(test, feature = "entry-points"))]
pub(crate) use outbox::{OutboxReceiver, outbox};
pub(crate) use places::Places;
pub(crate) use tls::TlsIdentity;
#[cfg(unix)]
pub(crate) use unix_socket::bind;
