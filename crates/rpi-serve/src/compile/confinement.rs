//! Limits that a worker process applies to itself before it reads a text: memory, processor time, descriptors,
//! priority, and its end with the server.

use std::io;

use rpi_runtime::realtime::use_lowest_priority;
use rustix::process::{Pid, Resource, Rlimit, getppid, setrlimit};

use super::frame::FrameLimits;

/// Number of descriptors of a worker: its three standard streams. So it opens no file and no socket.
const DESCRIPTORS: u64 = 3;

/// Applies the limits to this process.
///
/// # Errors
/// If the system refuses a limit, or the server has ended.
pub(super) fn apply(limits: FrameLimits) -> io::Result<()> {
    end_with(limits.server)?;
    // A compilation uses the time that the server leaves.
    use_lowest_priority()?;
    prefer_for_out_of_memory();
    limit(Resource::As, limits.memory_bytes)?;
    limit(Resource::Cpu, limits.cpu_seconds)?;
    // No core dump: it would contain the text, and writing it takes long.
    limit(Resource::Core, 0)?;
    limit(Resource::Nofile, DESCRIPTORS)?;
    // The stream of errors is not needed, and neither is a file of any size.
    limit(Resource::Fsize, 0)
}

fn limit(resource: Resource, most: u64) -> io::Result<()> {
    let most = rustix::process::getrlimit(resource)
        .maximum
        .map_or(most, |hard| hard.min(most));
    let limit = Rlimit {
        current: Some(most),
        maximum: Some(most),
    };
    setrlimit(resource, limit).map_err(io::Error::from)
}

/// Lets the kernel kill this process when the thread of the server that waits for it ends.
#[cfg(target_os = "linux")]
fn end_with(server: u32) -> io::Result<()> {
    use rustix::process::{Signal, set_parent_process_death_signal};
    set_parent_process_death_signal(Some(Signal::KILL))?;
    ensure_parent(server)
}

/// Elsewhere, a worker ends when it has compiled its text, or at the limit of its processor time.
#[cfg(not(target_os = "linux"))]
fn end_with(server: u32) -> io::Result<()> {
    ensure_parent(server)
}

/// Returns an error if the server ended before the signal of its end was requested.
fn ensure_parent(server: u32) -> io::Result<()> {
    let parent = getppid().map(Pid::as_raw_nonzero);
    match parent.is_some_and(|parent| u32::try_from(parent.get()) == Ok(server)) {
        true => Ok(()),
        false => Err(io::Error::other("the server has ended")),
    }
}

/// Lets the kernel choose this process first when the machine has no memory left.
fn prefer_for_out_of_memory() {
    // Only Linux has this file. Elsewhere, and where it is not writable, the kernel chooses by size.
    let _ = std::fs::write("/proc/self/oom_score_adj", "1000");
}
