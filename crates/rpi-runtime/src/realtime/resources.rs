//! Priority, locked memory and CPU affinity of the tick thread.

use std::fmt;
use std::io;

use rustix::mm::{MlockAllFlags, mlockall};
use rustix::process::{Resource, geteuid, getrlimit};
use rustix::thread::{CpuSet, sched_getaffinity, sched_setaffinity};
use thread_priority::{
    Error, NormalThreadSchedulePolicy, RealtimeThreadSchedulePolicy, ThreadPriority,
    ThreadPriorityValue, ThreadSchedulePolicy, set_thread_priority_and_policy, thread_native_id,
};

/// Priority and CPU core to request from the operating system for a thread.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct SchedulingOptions {
    /// Priority of the thread under the Linux scheduling policy `SCHED_FIFO`, from 1 (lowest) to 99.
    pub priority: u8,
    /// Index of the CPU core of the thread. `None` selects the last allowed core if there are several, because
    /// interrupts are usually served by the first.
    pub core: Option<usize>,
}

impl Default for SchedulingOptions {
    /// Returns the default options. The priority is 80: above the usual priority of interrupt threads (50), below that
    /// of the kernel (99).
    fn default() -> Self {
        SchedulingOptions {
            priority: 80,
            core: None,
        }
    }
}

/// Answer of the operating system to the request for one real-time resource.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct ResourceGrant {
    /// Description of the requested resource, such as `priority 80 of SCHED_FIFO`.
    pub resource: String,
    /// Reason for which the resource was not granted, with a hint for the user; `None` if the resource was granted.
    pub refusal: Option<String>,
}

impl fmt::Display for ResourceGrant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.refusal {
            None => write!(f, "{}: yes", self.resource),
            Some(why) => write!(f, "{}: NO, {why}", self.resource),
        }
    }
}

/// Requests a locked memory, the priority and the CPU core for the calling thread, and returns the answers. Memory is
/// locked for the whole process, so that no page fault occurs in a tick.
#[must_use]
pub fn request_resources(wanted: SchedulingOptions) -> Vec<ResourceGrant> {
    let mut grants = vec![lock_memory(), set_priority(wanted.priority)];
    grants.extend(pin_to_core(wanted.core));
    grants
}

/// Gives the calling thread the lowest priority of ordinary threads (`SCHED_OTHER`, nice 19), whatever it has now: a new
/// process inherits the real-time scheduling of the thread that starts it, and then competes with the cycle.
///
/// # Errors
/// If the operating system refuses the change.
pub fn use_lowest_priority() -> io::Result<()> {
    let policy = ThreadSchedulePolicy::Normal(NormalThreadSchedulePolicy::Other);
    let set = set_thread_priority_and_policy(thread_native_id(), ThreadPriority::Min, policy);
    set.map_err(|why| match why {
        Error::OS(code) => io::Error::from_raw_os_error(code),
        other => io::Error::other(format!("{other:?}")),
    })
}

fn lock_memory() -> ResourceGrant {
    // With a memlock limit, `MLOCKALL_FUTURE` would make later allocations above the limit fail, so only current memory
    // is locked.
    let unlimited = getrlimit(Resource::Memlock).current.is_none() || geteuid().is_root();
    let (what, resource) = match unlimited {
        true => (
            MlockAllFlags::CURRENT | MlockAllFlags::FUTURE,
            "memory locked",
        ),
        false => (
            MlockAllFlags::CURRENT,
            "memory locked, except memory allocated later",
        ),
    };
    let locked = mlockall(what);
    ResourceGrant {
        resource: resource.to_owned(),
        refusal: locked.err().map(|why| {
            format!("{why}; raise `memlock` in /etc/security/limits.conf or give CAP_IPC_LOCK")
        }),
    }
}

fn set_priority(priority: u8) -> ResourceGrant {
    let resource = format!("priority {priority} of SCHED_FIFO");
    let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    let result = ThreadPriorityValue::try_from(priority)
        .map_err(|why| why.to_string())
        .and_then(|value| {
            let priority = ThreadPriority::Crossplatform(value);
            set_thread_priority_and_policy(thread_native_id(), priority, policy)
                .map_err(|why| format!("{why:?}"))
        });
    ResourceGrant {
        resource,
        refusal: result.err().map(|why| {
            format!("{why}; raise `rtprio` in /etc/security/limits.conf or give CAP_SYS_NICE")
        }),
    }
}

/// Pins the calling thread to the core with this index, by default to the last allowed one. Returns `None` if there is
/// only one core and none is requested.
fn pin_to_core(wanted: Option<usize>) -> Option<ResourceGrant> {
    let allowed = sched_getaffinity(None);
    let allowed = allowed.as_ref().ok();
    let cores =
        |set: &CpuSet| -> Vec<usize> { (0..CpuSet::MAX_CPU).filter(|k| set.is_set(*k)).collect() };
    let cores = allowed.map(cores).unwrap_or_default();
    let core = wanted.or_else(|| cores.last().copied().filter(|_| cores.len() > 1))?;
    let mut set = CpuSet::new();
    let refused = match cores.contains(&core) {
        true => {
            set.set(core);
            sched_setaffinity(None, &set)
                .err()
                .map(|why| why.to_string())
        }
        false => Some(format!("this process is restricted to the cores {cores:?}")),
    };
    Some(ResourceGrant {
        resource: format!("core {core}"),
        refusal: refused,
    })
}
