//! Priority, memory and a core for the thread that ticks.

use std::fmt;

use rustix::mm::{MlockAllFlags, mlockall};
use rustix::process::{Resource, geteuid, getrlimit};
use rustix::thread::{CpuSet, sched_getaffinity, sched_setaffinity};
use thread_priority::{
    RealtimeThreadSchedulePolicy, ThreadPriority, ThreadPriorityValue, ThreadSchedulePolicy,
    set_thread_priority_and_policy, thread_native_id,
};

/// What is wanted of the system.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Wanted {
    /// Priority among the threads of the policy `SCHED_FIFO`, 1 to 99.
    pub priority: u8,
    /// The core to run on; else the last one that is allowed, if there are several: interrupts tend to be served by the
    /// first.
    pub core: Option<usize>,
}

impl Default for Wanted {
    /// Above what usual threads of interrupts have (50), below what the kernel needs for itself (99).
    fn default() -> Self {
        Wanted {
            priority: 80,
            core: None,
        }
    }
}

/// What the system has said to a wish.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Grant {
    /// The wish.
    pub wish: String,
    /// Why it was not granted, and what helps.
    pub refused: Option<String>,
}

impl fmt::Display for Grant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.refused {
            None => write!(f, "{}: yes", self.wish),
            Some(why) => write!(f, "{}: NO, {why}", self.wish),
        }
    }
}

/// Asks for the calling thread. Memory is locked for the whole process, so that all of it is there before the first tick.
#[must_use]
pub fn ask(wanted: Wanted) -> Vec<Grant> {
    let mut grants = vec![memory(), priority(wanted.priority)];
    grants.extend(core(wanted.core));
    grants
}

fn memory() -> Grant {
    // With a limit, an allocation beyond it would fail later: then only what is there now is locked.
    let unlimited = getrlimit(Resource::Memlock).current.is_none() || geteuid().is_root();
    let (what, wish) = match unlimited {
        true => (
            MlockAllFlags::CURRENT | MlockAllFlags::FUTURE,
            "memory locked",
        ),
        false => (
            MlockAllFlags::CURRENT,
            "memory locked, but for what is loaded later",
        ),
    };
    let locked = mlockall(what);
    Grant {
        wish: wish.to_owned(),
        refused: locked.err().map(|why| {
            format!("{why}; raise `memlock` in /etc/security/limits.conf or give CAP_IPC_LOCK")
        }),
    }
}

fn priority(priority: u8) -> Grant {
    let wish = format!("priority {priority} of SCHED_FIFO");
    let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    let asked = ThreadPriorityValue::try_from(priority)
        .map_err(|why| why.to_string())
        .and_then(|value| {
            let priority = ThreadPriority::Crossplatform(value);
            set_thread_priority_and_policy(thread_native_id(), priority, policy)
                .map_err(|why| format!("{why:?}"))
        });
    Grant {
        wish,
        refused: asked.err().map(|why| {
            format!("{why}; raise `rtprio` in /etc/security/limits.conf or give CAP_SYS_NICE")
        }),
    }
}

/// A core of its own; nothing is said where there is but one.
fn core(wanted: Option<usize>) -> Option<Grant> {
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
        false => Some(format!("this process may use the cores {cores:?}")),
    };
    Some(Grant {
        wish: format!("core {core}"),
        refused,
    })
}
