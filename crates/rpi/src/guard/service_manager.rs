//! Notifications to the service manager that has started this process (sd_notify(3), without its library).

use std::env;
use std::io;
use std::os::unix::net::UnixDatagram;
use std::time::{Duration, Instant};

use super::beat::Beat;

/// Connection to the service manager; without one, all notifications are dropped.
#[derive(Debug, Default)]
pub(super) struct ServiceManager {
    socket: Option<UnixDatagram>,
    /// Interval of the notifications that the watchdog of the service manager requires.
    watchdog: Option<Duration>,
    /// Time of the last notification of the watchdog.
    fed: Option<Instant>,
    /// Number of cycles at the last notification of the watchdog.
    ticks: u64,
    is_ready: bool,
    is_stopping: bool,
}

impl ServiceManager {
    /// Connects to the service manager that the variables `NOTIFY_SOCKET`, `WATCHDOG_USEC` and `WATCHDOG_PID` name.
    pub(super) fn from_environment() -> ServiceManager {
        let socket = env::var_os("NOTIFY_SOCKET");
        let socket = socket.and_then(|name| connect(name.as_encoded_bytes()).ok());
        let own = std::process::id().to_string();
        let is_own = env::var("WATCHDOG_PID").map_or(true, |process| process == own);
        let timeout = env::var("WATCHDOG_USEC").ok();
        let timeout = timeout
            .and_then(|text| text.parse().ok())
            .map(Duration::from_micros);
        ServiceManager {
            socket,
            // The manual of the watchdog recommends half of the timeout at most.
            watchdog: timeout.filter(|_| is_own).map(|timeout| timeout / 3),
            ..ServiceManager::default()
        }
    }

    /// Reports the state of the control core: that it is ready after its first cycle, that its cycles go on, and that
    /// it ends. Without further cycles, the watchdog of the service manager expires.
    pub(super) fn observe(&mut self, beat: Beat) {
        if beat.ticks > 0 && !self.is_ready {
            self.is_ready = true;
            self.send("READY=1\nSTATUS=running");
        }
        if beat.is_ending {
            self.stopping();
        }
        let Some(interval) = self.watchdog.filter(|_| self.is_ready) else {
            return;
        };
        let is_due = self.fed.is_none_or(|fed| fed.elapsed() >= interval);
        if is_due && (beat.ticks != self.ticks || beat.is_ending) {
            (self.fed, self.ticks) = (Some(Instant::now()), beat.ticks);
            self.send("WATCHDOG=1");
        }
    }

    /// Reports that the control core ends in order.
    pub(super) fn stopping(&mut self) {
        if !self.is_stopping {
            self.is_stopping = true;
            self.send("STOPPING=1");
        }
    }

    /// Reports the state of the service in words.
    pub(super) fn status(&self, text: &str) {
        self.send(&format!("STATUS={text}"));
    }

    fn send(&self, text: &str) {
        if let Some(socket) = &self.socket {
            // A service manager that does not answer must not disturb the core.
            let _ = socket.send(text.as_bytes());
        }
    }
}

/// Connects to a socket: a path, or a name in the abstract name space of Linux after `@`.
fn connect(name: &[u8]) -> io::Result<UnixDatagram> {
    let socket = UnixDatagram::unbound()?;
    socket.set_nonblocking(true)?;
    match name.split_first() {
        #[cfg(target_os = "linux")]
        Some((b'@', name)) => {
            use std::os::linux::net::SocketAddrExt;
            let address = std::os::unix::net::SocketAddr::from_abstract_name(name)?;
            socket.connect_addr(&address)?;
        }
        _ => {
            use std::os::unix::ffi::OsStrExt;
            socket.connect(std::ffi::OsStr::from_bytes(name))?;
        }
    }
    Ok(socket)
}
