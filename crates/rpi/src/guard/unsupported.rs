//! Systems without Unix signals and sockets have no guard.

use std::io;
use std::path::Path;

use super::{GuardArgs, HeartbeatSource};
use crate::exit::CommandResult;

/// Heartbeat without a receiver.
pub(crate) struct Heartbeat;

impl Heartbeat {
    /// Returns a heartbeat without effect, or an error if a guard is to receive it.
    pub(crate) fn start(_: HeartbeatSource, guarded: bool) -> io::Result<Heartbeat> {
        match guarded {
            true => Err(io::ErrorKind::Unsupported.into()),
            false => Ok(Heartbeat),
        }
    }

    /// Has no effect.
    pub(crate) fn set_stopped(&self, _: bool) {}
}

/// Returns an error: this system has no guard.
pub(crate) fn guard(_: &GuardArgs, _: Option<&Path>, _: bool) -> CommandResult {
    Err("--guard and --restart need a Unix system".into())
}
