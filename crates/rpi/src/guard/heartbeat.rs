//! Heartbeat of the control core: a thread that reports the number of cycles to the guard or to the service manager.
//!
//! The thread only reads a counter of the cycle. The cycle itself writes no messages, because it must not wait.

use std::io;
use std::os::fd::AsFd;
use std::os::unix::net::UnixDatagram;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

use super::HeartbeatSource;
use super::beat::Beat;
use super::service_manager::ServiceManager;

/// Interval of the reports.
const INTERVAL: Duration = Duration::from_millis(20);

/// Running heartbeat. Dropping it reports that the core ends.
pub(crate) struct Heartbeat {
    flags: Arc<Flags>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Default)]
struct Flags {
    is_stopped: AtomicBool,
    is_ending: AtomicBool,
}

impl Heartbeat {
    /// Starts the heartbeat of this process. `guarded` is true if its standard input is connected to a guard; otherwise
    /// the heartbeat reports to the service manager, if there is one.
    ///
    /// # Errors
    /// If a system call fails.
    pub(crate) fn start(source: HeartbeatSource, guarded: bool) -> io::Result<Heartbeat> {
        let mut receiver = match guarded {
            true => Receiver::Guard(connect()?),
            false => Receiver::Manager(ServiceManager::from_environment()),
        };
        let flags = Arc::<Flags>::default();
        flags.is_stopped.store(source.is_stopped, Ordering::Relaxed);
        let shared = Arc::clone(&flags);
        let thread = std::thread::Builder::new().name("rpi-heartbeat".into());
        let thread = thread.spawn(move || {
            loop {
                let beat = Beat {
                    ticks: (source.ticks)(),
                    period_ns: source.period_ns,
                    is_stopped: shared.is_stopped.load(Ordering::Relaxed),
                    is_ending: shared.is_ending.load(Ordering::Relaxed),
                };
                if !receiver.send(beat) && !source.interrupted.swap(true, Ordering::Relaxed) {
                    rpi_diag::println_stderr!("the guard has ended; stopping");
                }
                if beat.is_ending {
                    return;
                }
                std::thread::sleep(INTERVAL);
            }
        })?;
        Ok(Heartbeat {
            flags,
            thread: Some(thread),
        })
    }

    /// Sets whether an emergency stop is in force, which must hold after a restart.
    pub(crate) fn set_stopped(&self, is_stopped: bool) {
        self.flags.is_stopped.store(is_stopped, Ordering::Relaxed);
    }
}

impl Drop for Heartbeat {
    fn drop(&mut self) {
        self.flags.is_ending.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // The thread only fails by a panic, which it has printed.
            let _ = thread.join();
        }
    }
}

/// Receiver of the reports.
enum Receiver {
    Guard(UnixDatagram),
    Manager(ServiceManager),
}

impl Receiver {
    /// Sends a report. Returns false if the guard has ended.
    fn send(&mut self, beat: Beat) -> bool {
        match self {
            Receiver::Guard(socket) => match socket.send(&beat.encode()) {
                Ok(_) => true,
                // A guard that is suspended receives the next report.
                Err(error) => matches!(
                    error.kind(),
                    io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted
                ),
            },
            Receiver::Manager(manager) => {
                manager.observe(beat);
                true
            }
        }
    }
}

/// Returns the connection of this process to its guard.
fn connect() -> io::Result<UnixDatagram> {
    let socket = UnixDatagram::from(io::stdin().as_fd().try_clone_to_owned()?);
    socket.set_nonblocking(true)?;
    Ok(socket)
}
