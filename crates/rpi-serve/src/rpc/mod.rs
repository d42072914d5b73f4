//! The native interface: JSON-RPC 2.0 over the websocket `/rpc`, or one message per line over a Unix socket.

mod answers;
mod front;
mod methods;
mod sink;
mod tasks;

pub(crate) use front::RpcFront;
