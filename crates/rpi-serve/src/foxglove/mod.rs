//! Live messages of a run for the viewer Foxglove, by its websocket protocol (subprotocol `foxglove.websocket.v1`,
//! <https://github.com/foxglove/ws-protocol/blob/main/docs/spec.md>).
//!
//! ```text
//! thread of the recorder --- LiveHub::message --- queue per client --- thread per client --- websocket
//! ```
//! Clients only receive: they subscribe to topics and cannot change the run. A client that does not keep up loses messages; the
//! recorder never waits for a client, and the cycle never waits for the recorder.

mod client_queue;
mod connection;
mod hub;
mod port;
mod protocol;

pub use port::{FoxglovePort, FoxgloveSettings};
