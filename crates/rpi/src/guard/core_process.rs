//! The control core as its guard sees it: start, reports of its cycles, end.

use std::ffi::OsString;
use std::fmt;
use std::io;
use std::os::fd::OwnedFd;
use std::os::unix::net::UnixDatagram;
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, kill_process};

use super::beat::{BEAT_BYTES, Beat};
use super::service_manager::ServiceManager;
use crate::interrupt::Interrupt;
use crate::own_program::own_program;

/// Interval at which the guard checks the core.
const CHECK_INTERVAL: Duration = Duration::from_millis(10);
/// Time from the end of the last cycle to the end of the process, in which the core completes its files.
const END_TIMEOUT: Duration = Duration::from_secs(60);
/// Time in which a stalled core must end by SIGABRT, which writes a core dump where the system is set up for it.
const ABORT_TIMEOUT: Duration = Duration::from_secs(1);
/// Minimum time of a stall in cycles, so that long cycles do not count as a stall.
const MIN_STALL_CYCLES: u64 = 4;
/// Exit status of a Rust program that ends by a panic.
const PANIC_STATUS: i32 = 101;

/// A running control core. Dropping it kills it.
pub(super) struct CoreProcess {
    child: Child,
    reports: UnixDatagram,
    beat: Beat,
    /// Time of the latest cycle that was reported.
    progress: Instant,
    /// Whether a signal has asked the core to end.
    pub(super) is_interrupted: bool,
}

/// How a control core has ended.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum CoreEnd {
    /// The core has ended in order, with this exit status.
    Exited(u8),
    /// The core has crashed.
    Crashed(ExitStatus),
    /// The core made no cycle for this time and was ended.
    Stalled(Duration),
}

impl fmt::Display for CoreEnd {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            CoreEnd::Exited(status) => write!(f, "exit status {status}"),
            CoreEnd::Stalled(time) => {
                write!(f, "stalled for {} ms and was ended", time.as_millis())
            }
            CoreEnd::Crashed(status) => match status.signal() {
                Some(signal) => match signal_hook::low_level::signal_name(signal) {
                    Some(name) => write!(f, "was ended by {name}"),
                    None => write!(f, "was ended by signal {signal}"),
                },
                None => write!(f, "crashed"),
            },
        }
    }
}

impl CoreProcess {
    /// Starts a control core with the options of this process. With `is_stopped`, an emergency stop is in force from
    /// the start.
    pub(super) fn start(is_stopped: bool) -> io::Result<CoreProcess> {
        let (reports, theirs) = UnixDatagram::pair()?;
        reports.set_nonblocking(true)?;
        let mut arguments = std::env::args_os();
        let name = arguments.next().unwrap_or_else(|| "rpi".into());
        // The name of the subcommand comes first.
        let subcommand: Vec<OsString> = arguments.by_ref().take(1).collect();
        let child = Command::new(own_program()?)
            .arg0(name)
            .args(subcommand)
            .arg("--guarded")
            .args(is_stopped.then_some("--emergency-stopped"))
            .args(arguments)
            // The guard itself notifies the service manager.
            .env_remove("NOTIFY_SOCKET")
            .env_remove("WATCHDOG_USEC")
            .env_remove("WATCHDOG_PID")
            .stdin(Stdio::from(OwnedFd::from(theirs)))
            // Signals of the terminal reach the guard, which passes them on once. Ctrl-Z does not suspend the core.
            .process_group(0)
            .spawn()?;
        Ok(CoreProcess {
            child,
            reports,
            beat: Beat::default(),
            progress: Instant::now(),
            is_interrupted: false,
        })
    }

    /// Returns the number of the process.
    pub(super) fn id(&self) -> u32 {
        self.child.id()
    }

    /// Returns the latest report.
    pub(super) fn beat(&self) -> Beat {
        self.beat
    }

    /// Waits until the core has ended. Passes signals on to it, and ends it if it makes no cycle for the time
    /// `stall_timeout`.
    pub(super) fn watch(
        &mut self,
        interrupt: &Interrupt,
        manager: &mut ServiceManager,
        stall_timeout: Duration,
    ) -> io::Result<CoreEnd> {
        loop {
            self.receive();
            manager.observe(self.beat);
            if let Some(status) = self.child.try_wait()? {
                self.receive();
                return Ok(core_end(status));
            }
            self.pass_signals_on(interrupt, manager);
            let stalled = self.progress.elapsed();
            if self
                .stall_limit(stall_timeout)
                .is_some_and(|limit| stalled >= limit)
            {
                self.abort()?;
                return Ok(CoreEnd::Stalled(stalled));
            }
            std::thread::sleep(CHECK_INTERVAL);
        }
    }

    /// Reads all reports that have arrived.
    fn receive(&mut self) {
        let mut bytes = [0; BEAT_BYTES];
        while let Ok(BEAT_BYTES) = self.reports.recv(&mut bytes) {
            let beat = Beat::decode(bytes);
            if beat.ticks != self.beat.ticks || beat.is_ending != self.beat.is_ending {
                self.progress = Instant::now();
            }
            self.beat = beat;
        }
    }

    /// Returns the time without progress after which the core is ended; `None` before its first cycle.
    fn stall_limit(&self, stall_timeout: Duration) -> Option<Duration> {
        let cycles = self.beat.period_ns.saturating_mul(MIN_STALL_CYCLES);
        match (self.beat.is_ending, self.beat.ticks) {
            (true, _) => Some(END_TIMEOUT.max(stall_timeout)),
            (false, 0) => None,
            (false, _) => Some(stall_timeout.max(Duration::from_nanos(cycles))),
        }
    }

    fn pass_signals_on(&mut self, interrupt: &Interrupt, manager: &mut ServiceManager) {
        if let Some(signal) = interrupt.take_signal() {
            self.is_interrupted = true;
            manager.stopping();
            self.send(Signal::from_named_raw(signal));
        }
        if interrupt.take_emergency() {
            self.send(Some(Signal::QUIT));
        }
        if interrupt.take_reset() {
            self.send(Some(Signal::USR1));
        }
    }

    fn send(&self, signal: Option<Signal>) {
        let process = i32::try_from(self.child.id()).ok().and_then(Pid::from_raw);
        if let Some((process, signal)) = process.zip(signal) {
            // It fails only if the process has ended, which the next check notices.
            let _ = kill_process(process, signal);
        }
    }

    /// Ends a core that does not answer.
    fn abort(&mut self) -> io::Result<()> {
        self.send(Some(Signal::ABORT));
        let begin = Instant::now();
        while begin.elapsed() < ABORT_TIMEOUT {
            if self.child.try_wait()?.is_some() {
                return Ok(());
            }
            std::thread::sleep(CHECK_INTERVAL);
        }
        self.child.kill()?;
        self.child.wait().map(drop)
    }
}

impl Drop for CoreProcess {
    fn drop(&mut self) {
        // Both fail only if the process has ended and was waited for.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn core_end(status: ExitStatus) -> CoreEnd {
    let crashed = i32::from(crate::exit::CRASHED);
    match status
        .code()
        .filter(|code| ![PANIC_STATUS, crashed].contains(code))
    {
        Some(code) => CoreEnd::Exited(u8::try_from(code).unwrap_or(u8::MAX)),
        None => CoreEnd::Crashed(status),
    }
}
