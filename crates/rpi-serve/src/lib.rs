//! Network server for the control core. Clients load, start, schedule and watch commands while others run.
//!
//! ```text
//! clients --- transport (HTTP, websocket, lines) --- dio | rpc | web --- state ==rpi_runtime::control== cycle
//! ```
//! - `cycle` runs the core and the devices on one thread that never blocks on another thread.
//! - `state` holds the server state: sessions, commands, rules, devices and subscriptions. Loading has its own thread.
//! - `dio` implements the DirectIO protocol of the reference system, `rpc` JSON-RPC 2.0, `web` the HTTP pages of both.
//! - `transport` does transport and authentication.
//!
//! This crate must not know what a primitive computes or how a net is compiled; it uses `rpi-driver` and `rpi-core` for
//! both.

mod condition;
mod cycle;
mod dio;
mod fair_share;
mod limits;
mod open_error;
mod peer;
mod rpc;
mod server;
mod settings;
mod state;
mod task_bundle;
mod transport;
mod web;

pub use limits::{Limits, OnLoss};
pub use open_error::{IdentityError, OpenError};
pub use rpc::methods;
pub use rpi_runtime::realtime::TimeBase;
pub use server::Server;
pub use settings::{Settings, TlsFiles};
pub use task_bundle::{TaskBundle, TaskBundleError};
