//! Signals by which somebody ends this process in order: SIGINT (Ctrl-C), SIGTERM, and SIGHUP, as its terminal is gone; and SIGQUIT
//! (Ctrl-\\), an emergency stop.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use crate::exit::Exit;

/// Hears the signals from when it was made.
pub(crate) struct Interrupt {
    raised: Arc<AtomicBool>,
    signal: Arc<AtomicUsize>,
    emergency: Arc<AtomicBool>,
}

impl Interrupt {
    /// Hears the signals from now on: they do not end the process any more.
    ///
    /// # Errors
    /// If the system does not let it.
    pub(crate) fn listen() -> io::Result<Interrupt> {
        let interrupt = Interrupt {
            raised: Arc::default(),
            signal: Arc::default(),
            emergency: Arc::default(),
        };
        #[cfg(unix)]
        flag::register(
            signal_hook::consts::SIGQUIT,
            Arc::clone(&interrupt.emergency),
        )?;
        interrupt.end_by(SIGINT)?;
        interrupt.end_by(SIGTERM)?;
        #[cfg(unix)]
        if !is_ignored(signal_hook::consts::SIGHUP) {
            interrupt.end_by(signal_hook::consts::SIGHUP)?;
        }
        Ok(interrupt)
    }

    fn end_by(&self, signal: i32) -> io::Result<()> {
        // In this order: whoever sees that it was raised can say by what.
        let number = usize::try_from(signal).unwrap_or_default();
        flag::register_usize(signal, Arc::clone(&self.signal), number)?;
        flag::register(signal, Arc::clone(&self.raised))?;
        Ok(())
    }

    /// Becomes true when somebody interrupts.
    pub(crate) fn flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.raised)
    }

    /// Becomes true when somebody wants an emergency stop.
    pub(crate) fn emergency(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.emergency)
    }

    /// How a process ends that was interrupted, by the custom of shells; nothing if it was not.
    pub(crate) fn exit(&self) -> Option<Exit> {
        let signal = u8::try_from(self.signal.load(Ordering::Relaxed)).ok()?;
        (signal > 0).then_some(Exit::Interrupted { signal })
    }
}

/// Whether whoever started this process has made it ignore a signal, as `nohup` does; told by the system where it tells that
/// (proc(5), `SigIgn`).
#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let ignored = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    ignored.is_some_and(|mask| mask >> (signal - 1) & 1 == 1)
}
