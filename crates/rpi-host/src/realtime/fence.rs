//! A fence around the thread that ticks: the kernel forbids it every system call but those of the clock.
//!
//! So that nothing on that thread asks the system for anything is not only looked for, but held: memory that must be fetched, a lock for
//! which somebody waits, a file, a text that is printed all end in a system call, and the first one ends the process. A lock that
//! is free and memory that the allocator has at hand take none: for these there is the allocation trap of the tests.

use std::collections::BTreeMap;
use std::time::Duration;

use seccompiler::{BpfProgram, SeccompAction, SeccompFilter};

use super::grant::Grant;

/// What is left: to sleep, to read the clock where it takes a system call, to return from a signal, to end.
const ALLOWED: [libc::c_long; 7] = [
    libc::SYS_clock_nanosleep,
    libc::SYS_nanosleep,
    libc::SYS_clock_gettime,
    libc::SYS_restart_syscall,
    libc::SYS_rt_sigreturn,
    libc::SYS_exit,
    libc::SYS_exit_group,
];

/// What is asked for.
const WISH: &str = "no system call but the clock's";

/// Forbids the calling thread all system calls but those of the clock, for good: another one ends the process with `SIGSYS`.
/// A thread cannot leave such a fence, not even to give back what it has: it must sleep until the process ends.
#[must_use]
pub fn fence() -> Grant {
    let refused = program().and_then(|program| {
        let put_up = seccompiler::apply_filter(&program);
        put_up.map_err(|why| why.to_string())
    });
    Grant {
        wish: WISH.to_owned(),
        refused: refused.err(),
    }
}

/// Whether this is the grant of a fence, and it is up.
#[must_use]
pub fn is_fence_up(grant: &Grant) -> bool {
    grant.wish == WISH && grant.refused.is_none()
}

/// Sleeps until the process ends: a thread behind a fence can do nothing else in the end.
pub fn rest() -> ! {
    loop {
        std::thread::sleep(Duration::from_secs(3600));
    }
}

fn program() -> Result<BpfProgram, String> {
    let allowed: BTreeMap<i64, Vec<_>> = ALLOWED.iter().map(|call| (*call, Vec::new())).collect();
    let machine = std::env::consts::ARCH.try_into();
    let machine = machine.map_err(|why| format!("{why:?}"))?;
    let (other, known) = (SeccompAction::KillProcess, SeccompAction::Allow);
    let filter = SeccompFilter::new(allowed, other, known, machine);
    let filter = filter.map_err(|why| why.to_string())?;
    filter.try_into().map_err(|why| format!("{why:?}"))
}
