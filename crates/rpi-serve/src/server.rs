//! Opening, running and closing the server.

use std::io;
use std::net::{SocketAddr, TcpListener};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use rpi_core::CycleObserver;
use rpi_device::NoDevices;
use rpi_record::mcap::{RecordingOptions, record};
use rpi_runtime::control::{Options, open};
use rpi_runtime::realtime::{self, RealTime, ResourceGrant, TickTimer, TimeBase};
use rpi_runtime::run::RecordingStats;
use rpi_runtime::tick_log::LoggingBank;
use rpi_sim::Cell;

use crate::cycle::CycleThread;
use crate::open_error::{OpenError, bind_error};
use crate::settings::Settings;
use crate::state::{SharedState, bank};
use crate::transport::{Acceptor, AuthPolicy, AuthThrottle};

/// Interval at which the server state is updated from the cycle's reports.
const UPDATE_INTERVAL: Duration = Duration::from_millis(1);

/// Time limit for devices to come to rest before the cycle ends.
const REST_TIMEOUT: Duration = Duration::from_secs(5);

/// Name of the cycle thread.
const CYCLE_THREAD: &str = "rpi-cycle";

/// Capacity of the request queue to the cycle.
const REQUESTS: usize = 4096;

/// A running server. Dropping it stops everything and closes it; the cycle runs until the devices are at rest.
#[derive(Debug)]
pub struct Server {
    address: SocketAddr,
    /// Path of the Unix socket that the server created and must remove.
    socket: Option<PathBuf>,
    grants: Vec<ResourceGrant>,
    /// Set when connections must end and no further one is accepted.
    closing: Arc<AtomicBool>,
    /// Set when the threads of the cycle and the server state must end.
    over: Arc<AtomicBool>,
    threads: Vec<JoinHandle<()>>,
    state: Option<SharedState>,
    /// Number of ticks missing from the recording. Set after the last tick.
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

    /// As [`Server::open`], and records everything that the core does until the server is [closed](Server::close).
    ///
    /// # Errors
    /// Those of [`Server::open`], and those of writing the recording.
    pub fn open_recorded(
        cell: &Cell,
        settings: &Settings,
        watch: impl CycleObserver + Send + 'static,
        recording: Option<RecordingOptions>,
    ) -> Result<Server, OpenError> {
        settings.check_protection()?;
        let identity = settings.identity()?;
        let bound = TcpListener::bind(settings.listen);
        let listener = bound.map_err(|why| bind_error(settings.listen, &why))?;
        listener.set_nonblocking(true)?;
        let address = listener.local_addr()?;
        let mut server = Server {
            address,
            socket: None,
            grants: Vec::new(),
            closing: Arc::default(),
            over: Arc::default(),
            threads: Vec::new(),
            state: None,
            lost: Arc::default(),
        };
        let shared = server.start_cycle(cell, settings, Box::new(watch), recording)?;
        server.state = Some(shared.clone());
        let acceptor = Acceptor {
            state: shared,
            limits: settings.limits,
            auth: AuthPolicy {
                token: settings.token.clone(),
            },
            identity,
            closing: Arc::clone(&server.closing),
            connections: Arc::default(),
            throttle: AuthThrottle::default(),
        };
        if let Some(path) = &settings.socket {
            server.listen_at(path, acceptor.clone())?;
        }
        server.spawn("rpi-listen", move || acceptor.accept_all(&listener))?;
        Ok(server)
    }

    fn start_cycle(
        &mut self,
        cell: &Cell,
        settings: &Settings,
        watch: Box<dyn CycleObserver + Send>,
        recording: Option<RecordingOptions>,
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
        let devices = LoggingBank::new(bank(cell, limits.devices, tick_ns));
        // `NoDevices`: the loader resolves device names against its own copy of the devices, so that it never waits for
        // the cycle.
        let (mut control, mut executive) = open(devices, Box::new(NoDevices), options);
        let run_options = (tick_ns, settings.continuity.unwrap_or_default());
        let record = |wanted| record(wanted, cell, run_options, (&mut control, &mut executive));
        let (recorder, collector) = recording.map(record).transpose()?.unzip();
        let shared = SharedState::new(cell, (control, recorder), settings)?;
        let overrun = settings.real_time.map(|r| r.overrun).unwrap_or_default();
        let cycle = CycleThread {
            executive,
            timer: TickTimer::start(settings.pace, tick_ns, overrun),
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

    /// Starts the cycle thread and waits until it has published the system's grants.
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
    fn listen_at(&mut self, path: &Path, acceptor: Acceptor) -> io::Result<()> {
        let listener = crate::transport::bind(path)?;
        self.socket = Some(path.to_owned());
        listener.set_nonblocking(true)?;
        self.spawn("rpi-listen", move || acceptor.accept_all_local(&listener))
    }

    #[cfg(not(unix))]
    fn listen_at(&mut self, _: &Path, _: Acceptor) -> io::Result<()> {
        Err(io::ErrorKind::Unsupported.into())
    }

    fn spawn(&mut self, name: &str, work: impl FnOnce() + Send + 'static) -> io::Result<()> {
        let thread = thread::Builder::new().name(name.into()).spawn(work)?;
        self.threads.push(thread);
        Ok(())
    }

    /// Returns the system's answers to the real-time settings requested for the cycle thread.
    #[must_use]
    pub fn grants(&self) -> &[ResourceGrant] {
        &self.grants
    }

    /// Stops everything in this tick. Nothing can be started until the emergency stop is reset. `by` names who
    /// requested it, or the reason.
    pub fn emergency_stop(&self, by: &str) {
        if let Some(shared) = &self.state {
            shared.lock().emergency_stop(by, Box::new(|_| {}));
        }
    }

    /// Takes the warnings for the operator since the last call, such as a full disk that ended the recording or wrong
    /// tokens. The run continues.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let shared = self.state.as_ref();
        shared.map_or_else(Vec::new, |shared| shared.lock().log.take_warnings())
    }

    /// Returns the listening address.
    #[must_use]
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Closes the server: it stops accepting requests, stops everything and runs the cycle until all devices are at
    /// rest, for at most five seconds. Returns the statistics of the recording, if there is one.
    ///
    /// # Errors
    /// Those of writing the recording.
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
        let shared = self.state.take();
        shared.map_or(Ok(None), |shared| shared.lock().finish_recording(lost))
    }

    /// Stops everything and waits until the devices are at rest. A moving arm must not lose its controller.
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
        if let Some(path) = &self.socket {
            let _ = std::fs::remove_file(path);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::net::IpAddr;

    use super::*;
    use crate::peer::Peer;
    use crate::state::{Language, LoadRequest, SessionPolicy, Subscriber, Update};

    /// A net that moves an axis of the arm back and forth for ever.
    const SWING: &str = "{t=Core::Clock(Increment='1.0'),c=Core::DoubleCos(inValue=t.outValue),\
        n=Core::DoubleMultiply(inFirst=c.outValue,Second='-0.1'),\
        p=Core::DoubleAdd(inFirst=n.outValue,Second='0.1'),\
        a=RobotArm::JointPosition(inPosition=p.outValue,Robot='arm',Axis='0')}";

    /// Starts a command on the server and waits until the arm moves.
    fn swing(shared: &SharedState) {
        let client = shared.lock().objects.client(Peer::Local);
        let session = shared
            .lock()
            .open_session("test", SessionPolicy::default(), (client, true));
        let session = session.unwrap();
        let load = LoadRequest {
            session: &session,
            title: "swing",
            language: Language::Rpinet,
            text: SWING,
            command: None,
            period_ns: 0,
            on_overrun: None,
        };
        let starter = shared.clone();
        let started = move |name: Result<String, _>| {
            // The reply is called with the state locked, so `start` needs another thread.
            let name = name.unwrap();
            thread::spawn(move || starter.lock().start(&name, Box::new(|_| {})));
        };
        shared.lock().load(&load, Box::new(started));
        let begin = Instant::now();
        while !shared.lock().devices.all().any(|info| info.moving) {
            assert!(
                begin.elapsed() < Duration::from_secs(30),
                "it does not move"
            );
            thread::sleep(UPDATE_INTERVAL);
        }
    }

    /// A subscriber that accepts the first update and is gone afterwards.
    struct Disconnected;

    impl Subscriber for Disconnected {
        fn notify(&mut self, _: &Update<'_>) -> bool {
            true
        }

        fn is_connected(&self) -> bool {
            false
        }
    }

    /// Subscriptions of a disconnected client are removed even if no update ever fails to reach it.
    #[test]
    fn whoever_is_gone_is_forgotten() {
        let cell = Cell::parse("cell.toml", "").unwrap();
        let settings = Settings {
            listen: SocketAddr::new(IpAddr::from([127, 0, 0, 1]), 0),
            ..Settings::default()
        };
        let server = Server::open(&cell, &settings, ()).unwrap();
        let shared = server.state.clone().unwrap();
        let mut state = shared.lock();
        let client = state.objects.client(Peer::Local);
        let session = state
            .open_session("test", SessionPolicy::default(), (client, true))
            .unwrap();
        state.emergency.watch(Box::new(Disconnected));
        state.devices.watch(Box::new(Disconnected));
        state
            .objects
            .sessions
            .watch(&session, Box::new(Disconnected))
            .unwrap();
        assert_eq!(state.subscriber_count(), 3);
        state.on_client_lost(client, &[]);
        assert_eq!(state.subscriber_count(), 0);
    }

    #[test]
    fn nobody_lets_go_of_an_arm_that_moves() {
        let text = "[devices.arm]\nkind = \"arm\"\nmodel = \"kuka-lwr4+\"\n\
            enforce = [\"position\", \"velocity\"]\n";
        let cell = Cell::parse("cell.toml", text).unwrap();
        let settings = Settings {
            listen: SocketAddr::new(IpAddr::from([127, 0, 0, 1]), 0),
            ..Settings::default()
        };
        let server = Server::open(&cell, &settings, ()).unwrap();
        let shared = server.state.clone().unwrap();
        swing(&shared);
        server.close().unwrap();
        assert!(!shared.lock().devices.all().any(|info| info.moving));
    }
}
