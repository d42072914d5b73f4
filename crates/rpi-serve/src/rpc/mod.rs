//! The native interface: JSON-RPC 2.0 over the websocket `/rpc`, or one message per line over a Unix socket.

mod commands;
mod connection;
mod devices;
#[cfg(test)]
mod lost_watchers;
mod methods;
mod motion;
mod params;
mod reply_target;
mod rules;
mod sessions;
mod subscriber;
mod tasks;
mod watch;

pub(crate) use connection::RpcConnection;
pub use methods::methods;
