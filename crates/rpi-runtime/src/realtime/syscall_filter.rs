//! System call filter (seccomp) of the tick thread: the kernel allows only the system calls of the clock.
//!
//! The filter enforces that the thread never blocks in the kernel: fetching memory, waiting for a contended lock, file
//! access and output all need a system call, and the first forbidden one ends the process. Uncontended locks and
//! allocations that the allocator serves from free memory need no system call. The allocation trap of the tests detects
//! those allocations.

use std::collections::BTreeMap;
use std::time::Duration;

use seccompiler::{BpfProgram, SeccompAction, SeccompFilter};

use super::resources::ResourceGrant;

/// System calls that a thread with the filter may use: sleep, read the clock, return from a signal handler, exit.
const ALLOWED: [libc::c_long; 7] = [
    libc::SYS_clock_nanosleep,
    libc::SYS_nanosleep,
    libc::SYS_clock_gettime,
    libc::SYS_restart_syscall,
    libc::SYS_rt_sigreturn,
    libc::SYS_exit,
    libc::SYS_exit_group,
];

/// Description of the system call filter in the [`ResourceGrant`] about it.
const FILTER_NAME: &str = "no system call but the clock's";

/// Permanently forbids the calling thread all system calls except those of the clock. Returns whether the kernel has
/// installed the filter.
///
/// A forbidden system call ends the process with `SIGSYS`. The filter cannot be removed. The thread cannot even release
/// its memory, so it must sleep until the process ends.
#[must_use]
pub fn install_syscall_filter() -> ResourceGrant {
    let refused = build_filter().and_then(|program| {
        let put_up = seccompiler::apply_filter(&program);
        put_up.map_err(|why| why.to_string())
    });
    ResourceGrant {
        resource: FILTER_NAME.to_owned(),
        refusal: refused.err(),
    }
}

/// Returns true if the grant is about the system call filter and the filter is installed.
#[must_use]
pub fn is_syscall_filter_installed(grant: &ResourceGrant) -> bool {
    grant.resource == FILTER_NAME && grant.refusal.is_none()
}

/// Sleeps until the process ends. A thread with the system call filter cannot exit in another way.
pub fn sleep_forever() -> ! {
    loop {
        std::thread::sleep(Duration::from_secs(3600));
    }
}

fn build_filter() -> Result<BpfProgram, String> {
    let allowed: BTreeMap<i64, Vec<_>> = ALLOWED.iter().map(|call| (*call, Vec::new())).collect();
    let machine = std::env::consts::ARCH.try_into();
    let machine = machine.map_err(|why| format!("{why:?}"))?;
    let (other, known) = (SeccompAction::KillProcess, SeccompAction::Allow);
    let filter = SeccompFilter::new(allowed, other, known, machine);
    let filter = filter.map_err(|why| why.to_string())?;
    filter.try_into().map_err(|why| format!("{why:?}"))
}
