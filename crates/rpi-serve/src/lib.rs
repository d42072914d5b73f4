//! The control core as a server: commands are loaded, started, scheduled and watched from outside while others run.
//!
//! ```text
//! clients --- wire (HTTP, websocket, lines) --- dio | rpc | web --- desk ==rpi_host::control== cycle
//! ```
//! - `cycle` ticks the core and the devices, on one thread that nobody else ever holds up.
//! - `desk` keeps the books beside it: sessions, commands, rules, devices, who is told what. Loading has a thread of its own.
//! - `dio` speaks the DirectIO protocol of the reference system, `rpc` JSON-RPC 2.0, `web` the pages of both.
//! - `wire` moves bytes and decides who may come in.
//!
//! This crate must not know what a primitive computes or how a net is compiled; it asks `rpi-driver` and `rpi-core`.

mod condition;
mod cycle;
mod desk;
mod dio;
mod fair;
mod limits;
mod peer;
mod rpc;
mod script;
mod server;
mod web;
mod wire;

pub use limits::{Limits, OnLoss};
pub use rpi_host::realtime::Pace;
pub use script::Script;
pub use server::{CannotOpen, Server, Settings, TlsFiles};
