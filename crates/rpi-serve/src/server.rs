//! Opening, running and closing the server.

use std::io;
use std::net::{SocketAddr, TcpListener};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use rpi_core::CycleObserver;
use rpi_device::NoDevices;
use rpi_record::mcap::{RecordingOptions, RunOutputs, record};
use rpi_runtime::control::{Options, open};
use rpi_runtime::realtime::{self, CycleMetrics, RealTime, ResourceGrant, TickTimer, TimeBase};
use rpi_runtime::run::RecordingStats;
use rpi_runtime::tick_log::LoggingBank;
use rpi_sim::Cell;

use crate::cycle::CycleThread;
use crate::open_error::{OpenError, ResetError, bind_error};
use crate::settings::{Settings, SocketSettings};
use crate::state::{SharedState, StopOrigin, bank};
use crate::transport::{Acceptor, AuthPolicy, AuthThrottle, MemoryPool, Places};

/// Interval at which the server state is updated from the events that the cycle thread reports.
const UPDATE_INTERVAL: Duration = Duration::from_millis(1);

/// Maximum time to wait on closing until all devices are at rest. The cycle ends after it in any case.
const REST_TIMEOUT: Duration = Duration::from_secs(5);

/// Name of the cycle thread.
const CYCLE_THREAD: &str = "rpi-cycle";

/// Capacity of the queue of requests to the cycle thread, in requests.
const REQUESTS: usize = 4096;

/// A running server. Dropping it aborts all commands and closes the server; the cycle continues until the devices are
/// at rest, for at most five seconds.
#[derive(Debug)]
pub struct Server {
    address: SocketAddr,
    /// Paths of the Unix sockets that the server created and must remove.
    sockets: Vec<PathBuf>,
    grants: Vec<ResourceGrant>,
    /// Set when open connections must end and no further connection is accepted.
    closing: Arc<AtomicBool>,
    /// Set when the cycle thread and the thread that updates the server state must end.
    over: Arc<AtomicBool>,
    threads: Vec<JoinHandle<()>>,
    state: Option<SharedState>,
    /// Counters of the cycle; `None` until the cycle starts.
    metrics: Option<Arc<CycleMetrics>>,
    /// Number of ticks that the recorder lost, because it could not keep up. Set after the last tick.
    lost: Arc<OnceLock<u64>>,
}

impl Server {
    /// Opens a server for the devices of a cell. `watch` is called for every command after each of its cycles, on the
    /// cycle thread; `()` observes nothing.
    ///
    /// # Errors
    /// If the address requires a token or TLS, a certificate cannot be used, or a system call fails.
    pub fn open(
        cell: &Cell,
        settings: &Settings,
        watch: impl CycleObserver + Send + 'static,
    ) -> Result<Server, OpenError> {
        Server::open_recorded(cell, settings, watch, None)
    }

    /// Opens a server for the devices of a cell and records everything that the core does until the server is
    /// [closed](Server::close). `watch` is called for every command after each of its cycles, on the cycle thread.
    ///
    /// # Errors
    /// If the address requires a token or TLS, a certificate cannot be used, a system call fails, or the recording
    /// cannot be written.
    pub fn open_recorded(
        cell: &Cell,
        settings: &Settings,
        watch: impl CycleObserver + Send + 'static,
        recording: Option<RecordingOptions>,
    ) -> Result<Server, OpenError> {
        let outputs = recording.map(RunOutputs::from);
        Server::open_with_outputs(cell, settings, watch, outputs)
    }

    /// Opens a server for the devices of a cell, and writes what the core does to these outputs until the server is
    /// [closed](Server::close). `watch` is called for every command after each of its cycles, on the cycle thread.
    ///
    /// # Errors
    /// If the address requires a token or TLS, a certificate cannot be used, a system call fails, or the recording
    /// cannot be written.
    pub fn open_with_outputs(
        cell: &Cell,
        settings: &Settings,
        watch: impl CycleObserver + Send + 'static,
        outputs: Option<RunOutputs>,
    ) -> Result<Server, OpenError> {
        settings.check_protection()?;
        let identity = settings.identity()?;
        let bound = TcpListener::bind(settings.listen);
        let listener = bound.map_err(|why| bind_error(settings.listen, &why))?;
        listener.set_nonblocking(true)?;
        let address = listener.local_addr()?;
        let mut server = Server {
            address,
            sockets: Vec::new(),
            grants: Vec::new(),
            closing: Arc::default(),
            over: Arc::default(),
            threads: Vec::new(),
            state: None,
            metrics: None,
            lost: Arc::default(),
        };
        let shared = server.start_cycle(cell, settings, Box::new(watch), outputs)?;
        server.state = Some(shared.clone());
        let acceptor = Acceptor {
            state: shared,
            limits: settings.limits,
            auth: AuthPolicy {
                tokens: settings.tokens.clone(),
                origins: Vec::new(),
            },
            identity,
            closing: Arc::clone(&server.closing),
            places: Places::new(settings.limits),
            throttle: AuthThrottle::default(),
            incoming: MemoryPool::new(settings.limits.memory.incoming),
            outgoing: MemoryPool::new(settings.limits.memory.outgoing),
        };
        for socket in &settings.sockets {
            server.listen_at(socket, acceptor.clone())?;
        }
        server.spawn("rpi-listen", move || acceptor.accept_all(&listener))?;
        Ok(server)
    }

    fn start_cycle(
        &mut self,
        cell: &Cell,
        settings: &Settings,
        watch: Box<dyn CycleObserver + Send>,
        outputs: Option<RunOutputs>,
    ) -> io::Result<SharedState> {
        let (limits, tick_ns) = (settings.limits, settings.tick_ns.max(1));
        let options = Options {
            tick_ns,
            commands: limits.commands,
            requests: REQUESTS,
            measure_commands: settings.pace == TimeBase::Real,
            budget: settings.budget(),
            ..Options::default()
        };
        let mut devices = bank(cell, limits.devices, tick_ns);
        let opened = devices.open(settings.pace == TimeBase::Real);
        opened.map_err(io::Error::other)?;
        let devices = LoggingBank::new(devices);
        // `NoDevices`: the loader resolves device names against its own copy of the devices, so that it never waits for
        // the cycle.
        let (mut control, mut executive) = open(devices, Box::new(NoDevices), options);
        let run_options = (tick_ns, settings.continuity.unwrap_or_default());
        let record =
            |wanted: RunOutputs| record(wanted, cell, run_options, (&mut control, &mut executive));
        let (recorder, collector) = outputs.map(record).transpose()?.unzip();
        let overrun = settings.real_time.map(|r| r.overrun).unwrap_or_default();
        let timer = TickTimer::start(settings.pace, tick_ns, overrun);
        let metrics = Arc::clone(timer.metrics());
        self.metrics = Some(Arc::clone(&metrics));
        let shared = SharedState::new(cell, (control, recorder), metrics, settings)?;
        if let Some(by) = &settings.stopped_by {
            // Before the first cycle and before the first client.
            let by = (by.as_str(), StopOrigin::Operator);
            shared.lock().emergency_stop(by, Box::new(|_| {}));
        }
        let cycle = CycleThread {
            executive,
            timer,
            watch,
            tick_wrapper: settings.tick_wrapper,
            stop: Arc::clone(&self.over),
            emergency_stop: shared.lock().emergency.stop_flag(),
            recorder: collector,
            lost_ticks: Arc::clone(&self.lost),
        };
        self.run(cycle, settings.real_time)?;
        let (over, updated) = (Arc::clone(&self.over), shared.clone());
        self.spawn("rpi-state", move || {
            while !over.load(Ordering::Relaxed) {
                updated.lock().update();
                thread::sleep(UPDATE_INTERVAL);
            }
        })?;
        Ok(shared)
    }

    /// Starts the cycle thread and waits until it has published which real-time settings the system granted.
    fn run(&mut self, cycle: CycleThread, real_time: Option<RealTime>) -> io::Result<()> {
        let granted = Arc::new(OnceLock::new());
        let publish = Arc::clone(&granted);
        self.spawn(CYCLE_THREAD, move || cycle.run(real_time, &publish))?;
        let ended = |t: &JoinHandle<()>| t.is_finished();
        while granted.get().is_none() && !self.threads.last().is_some_and(ended) {
            thread::sleep(UPDATE_INTERVAL);
        }
        self.grants = granted.get().cloned().unwrap_or_default();
        if self
            .grants
            .iter()
            .any(realtime::is_syscall_filter_installed)
        {
            // A fenced thread cannot exit (that takes a system call), so it must not be joined.
            self.threads.pop();
        }
        Ok(())
    }

    #[cfg(unix)]
    fn listen_at(&mut self, socket: &SocketSettings, acceptor: Acceptor) -> io::Result<()> {
        let listener = crate::transport::bind(&socket.path, socket.mode)?;
        self.sockets.push(socket.path.clone());
        let role = socket.role;
        self.spawn("rpi-listen", move || {
            acceptor.accept_all_local(&listener, role);
        })
    }

    #[cfg(not(unix))]
    fn listen_at(&mut self, _: &SocketSettings, _: Acceptor) -> io::Result<()> {
        Err(io::ErrorKind::Unsupported.into())
    }

    fn spawn(&mut self, name: &str, work: impl FnOnce() + Send + 'static) -> io::Result<()> {
        let thread = thread::Builder::new().name(name.into()).spawn(work)?;
        self.threads.push(thread);
        Ok(())
    }

    /// Returns, for each real-time setting that was requested for the cycle thread, whether the system granted it.
    #[must_use]
    pub fn grants(&self) -> &[ResourceGrant] {
        &self.grants
    }

    /// Aborts all commands in this tick, as requested by the operator at the terminal or by an input of the cell.
    /// Nothing can be started until [`Server::reset_emergency`] is called, or a client with the right to do so resets
    /// the stop. `by` is the name of the requester, or the reason.
    pub fn emergency_stop(&self, by: &str) {
        if let Some(shared) = &self.state {
            let by = (by, StopOrigin::Operator);
            shared.lock().emergency_stop(by, Box::new(|_| {}));
        }
    }

    /// Resets the emergency stop, as requested by the operator, so that commands can be started again.
    ///
    /// # Errors
    /// If a device still moves or earlier requests are pending.
    pub fn reset_emergency(&self) -> Result<(), ResetError> {
        let Some(shared) = &self.state else {
            return Ok(());
        };
        let reset = shared
            .lock()
            .reset_emergency("the operator", StopOrigin::Operator);
        reset.map_err(|why| ResetError {
            reason: why.to_string(),
        })
    }

    /// Returns the counters of the cycle, which grow while the server runs.
    #[must_use]
    pub fn cycle_metrics(&self) -> Arc<CycleMetrics> {
        self.metrics.clone().unwrap_or_default()
    }

    /// Returns whether an emergency stop is in force.
    #[must_use]
    pub fn is_emergency_stopped(&self) -> bool {
        let shared = self.state.as_ref();
        shared.is_some_and(|shared| shared.lock().emergency.by().is_some())
    }

    /// Removes and returns the warnings for the operator since the last call, such as a full disk that ended the
    /// recording, or requests with wrong tokens. The server continues in spite of them.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let shared = self.state.as_ref();
        shared.map_or_else(Vec::new, |shared| shared.lock().log.take_warnings())
    }

    /// Returns a handle of the server state, which all connections share.
    #[cfg(any(test, feature = "entry-points"))]
    pub(crate) fn shared(&self) -> Option<SharedState> {
        self.state.clone()
    }

    /// Returns the address and port at which the server listens.
    #[must_use]
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Closes the server: it stops accepting requests, aborts all commands and runs the cycle until all devices are at
    /// rest, for at most five seconds. Returns the statistics of the recording; `None` if the run was not recorded.
    ///
    /// # Errors
    /// If the recording cannot be written.
    pub fn close(mut self) -> io::Result<Option<RecordingStats>> {
        self.end()
    }

    fn end(&mut self) -> io::Result<Option<RecordingStats>> {
        // In this order: no new connections, then devices at rest, and only then the end of the cycle that brakes them.
        self.closing.store(true, Ordering::Relaxed);
        self.stop_and_wait();
        self.over.store(true, Ordering::Relaxed);
        let fenced = self
            .grants
            .iter()
            .any(realtime::is_syscall_filter_installed);
        self.wait();
        // A fenced thread cannot be joined; `lost` is set after its last tick.
        while fenced && self.lost.get().is_none() {
            thread::sleep(UPDATE_INTERVAL);
        }
        let lost = self.lost.get().copied().unwrap_or_default();
        let Some(shared) = self.state.take() else {
            return Ok(None);
        };
        let finished = shared.lock().finish_recording(lost);
        let log_file = shared.lock().log.take_file();
        drop(log_file);
        finished
    }

    /// Aborts all commands and waits until the devices are at rest, for at most [`REST_TIMEOUT`]. A moving arm must not
    /// lose its controller.
    fn stop_and_wait(&self) {
        let Some(shared) = &self.state else {
            return;
        };
        shared.lock().stop_all();
        let begin = Instant::now();
        while self.is_cycle_running()
            && begin.elapsed() < REST_TIMEOUT
            && !shared.lock().is_at_rest()
        {
            thread::sleep(UPDATE_INTERVAL);
        }
    }

    /// Returns whether the cycle thread is still running.
    fn is_cycle_running(&self) -> bool {
        let mut threads = self.threads.iter();
        let ended = |t: &JoinHandle<()>| t.thread().name() == Some(CYCLE_THREAD) && t.is_finished();
        !threads.any(ended)
    }

    /// Returns whether all threads of the server are running. Only a crash ends one before the server is closed.
    #[must_use]
    pub fn runs(&self) -> bool {
        !self.threads.iter().any(JoinHandle::is_finished)
    }

    fn wait(&mut self) {
        self.threads.drain(..).for_each(|thread| {
            let _ = thread.join();
        });
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        // Errors of the recording are lost here; `close` returns them.
        let _ = self.end();
        for path in &self.sockets {
            let _ = std::fs::remove_file(path);
        }
    }
}

#[cfg(test)]
mod tests;
