//! The native interface: JSON-RPC 2.0 over the websocket `/rpc`, or one message per line over a Unix socket.

mod answers;
mod commands;
mod devices;
mod front;
mod methods;
mod params;
mod rules;
mod sessions;
mod sink;
mod tasks;
mod watch;

pub(crate) use front::RpcFront;
pub use methods::methods;
