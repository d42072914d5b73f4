//! Signals by which somebody ends this process in order: SIGINT (Ctrl-C) and SIGTERM; and SIGQUIT (Ctrl-\\), an emergency stop.

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
        for (signal, number) in [(SIGINT, 2), (SIGTERM, 15)] {
            // In this order: whoever sees that it was raised can say by what.
            flag::register_usize(signal, Arc::clone(&interrupt.signal), number)?;
            flag::register(signal, Arc::clone(&interrupt.raised))?;
        }
        Ok(interrupt)
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
