//! The guard: a small process that runs the control core as a child. It notices the crash or the stall of the core,
//! completes the recording, reports the reason and restarts the core if this is requested.
//!
//! ```text
//! service manager <-- READY, WATCHDOG -- guard -- signals --> control core (own process) --> devices
//!                                          ^----- cycles -------'  (datagrams of a thread outside of the cycle)
//! ```
//! The guard has no connection to the devices. A device with a controller of its own has a watchdog, which brakes it
//! when set-points are missing: the controller is the only part that can still do so after the crash of a core.

mod args;
#[cfg(unix)]
mod beat;
#[cfg(unix)]
mod core_process;
#[cfg(unix)]
mod crash_recording;
#[cfg(unix)]
mod heartbeat;
#[cfg(unix)]
mod restart_limit;
#[cfg(unix)]
mod service_manager;
#[cfg(unix)]
mod supervisor;
#[cfg(not(unix))]
mod unsupported;

pub(crate) use args::GuardArgs;
#[cfg(unix)]
pub(crate) use heartbeat::Heartbeat;
#[cfg(unix)]
pub(crate) use supervisor::guard;
#[cfg(not(unix))]
pub(crate) use unsupported::{Heartbeat, guard};

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Source of the reports of a [`Heartbeat`].
#[cfg_attr(not(unix), allow(dead_code, reason = "only a guard reads it"))]
pub(crate) struct HeartbeatSource {
    /// Returns the number of cycles since the start; 0 if none are expected in real time.
    pub(crate) ticks: Box<dyn Fn() -> u64 + Send>,
    /// Length of a cycle in nanoseconds.
    pub(crate) period_ns: u64,
    /// Whether an emergency stop is in force at the start.
    pub(crate) is_stopped: bool,
    /// Flag that ends the core in order. It is set when the guard has ended.
    pub(crate) interrupted: Arc<AtomicBool>,
}
