//! Network server for the control core. Clients load, start, schedule and watch commands while others run.
//!
//! ```text
//! clients --- transport (HTTP, websocket, lines) --- dio | rpc | web --- state ==rpi_runtime::control== cycle
//! ```
//! - `cycle` runs the core and the devices on one thread that never blocks on another thread.
//! - `state` holds the server state: sessions, commands, rules, devices and subscriptions. Loading has its own threads.
//! - `compile` compiles the texts of clients, in this process or in worker processes with limits.
//! - `foxglove` sends live messages to the viewer Foxglove, at a port of its own.
//! - `dio` implements the DirectIO protocol of the reference system, `rpc` JSON-RPC 2.0, `web` the HTTP pages of both.
//! - `transport` does transport and authentication.
//!
//! This crate must not know what a primitive computes or how a net is compiled; it uses `rpi-driver` and `rpi-core` for
//! both.

mod client_token;
mod compile;
mod condition;
mod cycle;
mod dio;
#[cfg(feature = "entry-points")]
pub mod entry_points;
mod fair_share;
mod foxglove;
mod limits;
mod message_size;
mod open_error;
mod peer;
mod role;
mod rpc;
mod server;
mod settings;
mod state;
mod task_bundle;
mod transport;
mod web;

pub use client_token::{ClientToken, SecretFileError, read_tokens};
#[cfg(unix)]
pub use compile::run_compile_worker;
pub use compile::{CompilerSettings, WorkerSettings};
pub use foxglove::{FoxglovePort, FoxgloveSettings};
pub use limits::{Limits, MemoryLimits, OnLoss, PlaceLimits};
pub use open_error::{IdentityError, OpenError, ResetError};
pub use role::Role;
pub use rpc::methods;
pub use rpi_runtime::realtime::TimeBase;
pub use server::Server;
pub use settings::{Settings, SocketSettings, TlsFiles};
pub use task_bundle::{TaskBundle, TaskBundleError};
