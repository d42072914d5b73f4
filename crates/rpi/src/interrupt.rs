//! Signal handling: SIGINT (Ctrl-C), SIGTERM and SIGHUP (closed terminal) end the process in an orderly way; SIGQUIT
//! (Ctrl-\\) is an emergency stop.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use crate::exit::Exit;

/// Flags that the handlers of the process signals set.
pub(crate) struct Interrupt {
    raised: Arc<AtomicBool>,
    signal: Arc<AtomicUsize>,
    emergency: Arc<AtomicBool>,
}

impl Interrupt {
    /// Installs the signal handlers. The signals no longer end the process.
    ///
    /// # Errors
    /// If a handler cannot be installed.
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
        interrupt.register(SIGINT)?;
        interrupt.register(SIGTERM)?;
        #[cfg(unix)]
        // `nohup` starts a program with SIGHUP ignored, so that it survives the end of the terminal.
        if !is_ignored(signal_hook::consts::SIGHUP) {
            interrupt.register(signal_hook::consts::SIGHUP)?;
        }
        Ok(interrupt)
    }

    fn register(&self, signal: i32) -> io::Result<()> {
        // The order matters: when `raised` is set, `signal` is already valid.
        let number = usize::try_from(signal).unwrap_or_default();
        flag::register_usize(signal, Arc::clone(&self.signal), number)?;
        flag::register(signal, Arc::clone(&self.raised))?;
        Ok(())
    }

    /// Returns the flag that is set by an interrupt.
    pub(crate) fn flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.raised)
    }

    /// Returns the flag that is set by an emergency stop.
    pub(crate) fn emergency(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.emergency)
    }

    /// Returns the exit status of an interrupted process (128 + signal, as in shells); `None` if it was not
    /// interrupted.
    pub(crate) fn exit(&self) -> Option<Exit> {
        let signal = u8::try_from(self.signal.load(Ordering::Relaxed)).ok()?;
        (signal > 0).then_some(Exit::Interrupted { signal })
    }
}

/// Returns whether the process was started with a signal ignored, as `nohup` does; from `SigIgn` in `/proc` (proc(5))
/// where that exists.
#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let ignored = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    ignored.is_some_and(|mask| mask >> (signal - 1) & 1 == 1)
}
