//! Signal handling: SIGINT (Ctrl-C), SIGTERM and SIGHUP (closed terminal) end the process in an orderly way; SIGQUIT
//! (Ctrl-\\) is an emergency stop, and SIGUSR1 resets it in a server.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use crate::exit::Exit;

/// Flags that the handlers of process signals set: interrupt, emergency stop, and reset of the emergency stop.
pub(crate) struct Interrupt {
    raised: Arc<AtomicBool>,
    signal: Arc<AtomicUsize>,
    emergency: Arc<AtomicBool>,
    reset: Arc<AtomicBool>,
}

impl Interrupt {
    /// Installs handlers that set flags for SIGINT, SIGTERM, SIGHUP (interrupt) and SIGQUIT (emergency stop). These
    /// signals no longer end the process.
    ///
    /// # Errors
    /// Returns an error if a handler cannot be installed.
    pub(crate) fn listen() -> io::Result<Interrupt> {
        let interrupt = Interrupt {
            raised: Arc::default(),
            signal: Arc::default(),
            emergency: Arc::default(),
            reset: Arc::default(),
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

    /// Returns the flag that SIGINT, SIGTERM and SIGHUP set.
    pub(crate) fn flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.raised)
    }

    /// Returns the number of the last SIGINT, SIGTERM or SIGHUP since the last call; `None` if there was none.
    pub(crate) fn take_signal(&self) -> Option<i32> {
        let raised = self.raised.swap(false, Ordering::Relaxed);
        let signal = i32::try_from(self.signal.load(Ordering::Relaxed)).ok();
        signal.filter(|_| raised)
    }

    /// Returns the flag that SIGQUIT (emergency stop) sets.
    pub(crate) fn emergency(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.emergency)
    }

    /// Installs a handler by which SIGUSR1 requests the reset of an emergency stop. Without the handler, SIGUSR1 ends
    /// the process.
    ///
    /// # Errors
    /// Returns an error if the handler cannot be installed.
    pub(crate) fn listen_for_reset(&self) -> io::Result<()> {
        #[cfg(unix)]
        flag::register(signal_hook::consts::SIGUSR1, Arc::clone(&self.reset))?;
        Ok(())
    }

    /// Returns true if an emergency stop was requested (SIGQUIT) since the last call.
    pub(crate) fn take_emergency(&self) -> bool {
        self.emergency.swap(false, Ordering::Relaxed)
    }

    /// Returns true if the reset of an emergency stop was requested (SIGUSR1) since the last call.
    pub(crate) fn take_reset(&self) -> bool {
        self.reset.swap(false, Ordering::Relaxed)
    }

    /// Returns the exit status after an interrupt by a signal (128 + signal number, as in shells); `None` if the
    /// process was not interrupted.
    pub(crate) fn exit(&self) -> Option<Exit> {
        let signal = u8::try_from(self.signal.load(Ordering::Relaxed)).ok()?;
        (signal > 0).then_some(Exit::Interrupted { signal })
    }
}

/// Returns true if the process was started with the signal ignored, as `nohup` does. The information is the field
/// `SigIgn` of `/proc/self/status` (proc(5)); without that file, the result is false.
#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let ignored = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    ignored.is_some_and(|mask| mask >> (signal - 1) & 1 == 1)
}
