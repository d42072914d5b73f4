//! Transport: connections, HTTP heads, websockets, authentication.

mod chat;
mod guard;
mod head;
mod listener;
mod outbox;
#[cfg(unix)]
mod socket;
mod strangers;
#[cfg_attr(not(feature = "tls"), path = "no_tls.rs")]
mod tls;

pub(crate) use chat::Front;
pub(crate) use guard::Guard;
pub(crate) use head::Head;
pub(crate) use listener::Reception;
pub(crate) use outbox::{Outbox, Post};
#[cfg(unix)]
pub(crate) use socket::bind;
pub(crate) use strangers::Strangers;
pub(crate) use tls::Identity;
