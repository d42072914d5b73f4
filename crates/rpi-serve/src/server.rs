//! The server as a whole: opened, running, closed.

use std::fmt;
use std::io;
use std::net::{IpAddr, SocketAddr, TcpListener};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use rpi_core::{Continuity, Watch};
use rpi_device::NoDevices;
use rpi_host::control::{Budget, Options, open};
use rpi_host::realtime::{self, Beat, Grant, Pace, RealTime};
use rpi_host::recording::{Taped, Wanted, Written, record};
use rpi_sim::Cell;

use crate::cycle::Cycle;
use crate::desk::{Office, bank};
use crate::limits::{Limits, OnLoss};
use crate::wire::{Guard, Identity, Reception, Strangers};

/// How often the desk looks what the cycle tells.
const KEEP: Duration = Duration::from_millis(1);

/// How long devices get to come to rest before the cycle that moves them ends.
const REST: Duration = Duration::from_secs(5);

/// The thread of the cycle.
const CYCLE: &str = "rpi-cycle";

/// Requests to the cycle that can be under way at once.
const REQUESTS: usize = 4096;

/// What a server is to be like.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Where it listens. Beyond loopback it wants a token and TLS.
    pub listen: SocketAddr,
    /// A Unix socket at which it listens too: JSON-RPC in lines.
    pub socket: Option<PathBuf>,
    /// What clients must show.
    pub token: Option<String>,
    /// Who the server is, where connections are to be encrypted.
    pub tls: Option<TlsFiles>,
    /// Listen beyond loopback without token or TLS all the same.
    pub insecure: bool,
    /// Length of a tick, nanoseconds; periods are whole multiples of it.
    pub tick_ns: u64,
    /// What the ticks follow.
    pub pace: Pace,
    /// How a tick is run: it must run it once. A test puts a trap for allocations around it.
    pub around_tick: fn(&mut dyn FnMut()),
    /// What is asked of the system for the thread that ticks, and what happens if a tick ends when the next one is due already;
    /// nothing for a thread as any other.
    pub real_time: Option<RealTime>,
    /// What happens if a command takes over with a jump. Unless said, programs are refused then, and nets of the reference
    /// system are allowed to: they are written for control cores that do not look.
    pub continuity: Option<Continuity>,
    /// What becomes of a session's commands when its client is gone, where the client does not say.
    pub on_loss: OnLoss,
    /// How much of a tick commands may take together at most, from 0 to 1, by the bounds that the compiler has for them: those beyond
    /// are refused. The rest is for requests and devices. Without it nobody sees to that.
    pub share: Option<f64>,
    /// Time of an elementary operation, nanoseconds: `rpic machine` measures the worst.
    pub ns_per_operation: f64,
    /// How much clients may ask for.
    pub limits: Limits,
}

impl Default for Settings {
    fn default() -> Settings {
        Settings {
            listen: SocketAddr::new(IpAddr::from([127, 0, 0, 1]), 8080),
            socket: None,
            token: None,
            tls: None,
            insecure: false,
            tick_ns: 1_000_000,
            pace: Pace::Real,
            around_tick: |tick| tick(),
            real_time: None,
            continuity: None,
            on_loss: OnLoss::default(),
            share: Some(Budget::SHARE),
            ns_per_operation: Budget::NS_PER_OPERATION,
            limits: Limits::default(),
        }
    }
}

/// Files in PEM by which a server shows who it is.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct TlsFiles {
    /// Its certificate, and those between it and an authority that clients trust.
    pub certificates: PathBuf,
    /// Its private key.
    pub key: PathBuf,
}

/// Why a server does not open.
#[derive(Debug)]
pub enum CannotOpen {
    /// It would be open to others beyond this machine.
    Unguarded {
        /// Where it was to listen.
        at: SocketAddr,
        /// Everybody could come in.
        no_token: bool,
        /// Everybody on the way could read and change what is said.
        no_tls: bool,
    },
    /// A file by which it shows who it is cannot be used.
    Identity(String),
    /// The system does not give what it needs.
    System(io::Error),
}

impl fmt::Display for CannotOpen {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            CannotOpen::Unguarded {
                at,
                no_token,
                no_tls,
            } => {
                let lacking = match (no_token, no_tls) {
                    (true, true) => "a token and TLS",
                    (true, false) => "a token",
                    _ => "TLS",
                };
                let code = rpi_diag::Code::RPI9201;
                write!(
                    f,
                    "{code}: {at} can be reached from other machines: {lacking} needed"
                )
            }
            CannotOpen::Identity(why) => f.write_str(why),
            CannotOpen::System(why) => why.fmt(f),
        }
    }
}

impl std::error::Error for CannotOpen {}

impl Settings {
    /// Beyond loopback a server wants a token, and TLS.
    fn guarded(&self) -> Result<(), CannotOpen> {
        let (no_token, no_tls) = (self.token.is_none(), self.tls.is_none());
        let local = self.listen.ip().is_loopback();
        match local || self.insecure || !(no_token || no_tls) {
            true => Ok(()),
            false => Err(CannotOpen::Unguarded {
                at: self.listen,
                no_token,
                no_tls,
            }),
        }
    }

    /// What commands may take of a tick.
    fn budget(&self) -> Option<Budget> {
        let share = self.share?;
        Some(Budget::of(
            self.tick_ns.max(1),
            share,
            self.ns_per_operation,
        ))
    }

    fn identity(&self) -> Result<Option<Identity>, CannotOpen> {
        let read = |files: &TlsFiles| Identity::read(&files.certificates, &files.key);
        let identity = self.tls.as_ref().map(read).transpose();
        identity.map_err(CannotOpen::Identity)
    }
}

impl From<io::Error> for CannotOpen {
    fn from(why: io::Error) -> CannotOpen {
        CannotOpen::System(why)
    }
}

/// Why it cannot listen at an address, with what helps.
fn not_there(at: SocketAddr, why: &io::Error) -> io::Error {
    let helps = match why.kind() {
        io::ErrorKind::AddrInUse => {
            "; another program listens there: end it, or choose another port"
        }
        io::ErrorKind::AddrNotAvailable => "; this machine has no such address",
        _ => "",
    };
    io::Error::new(why.kind(), format!("{at}: {why}{helps}"))
}

/// A running server. Dropping it closes it: everything is stopped, and ticks go on until devices stand still.
#[derive(Debug)]
pub struct Server {
    address: SocketAddr,
    /// The socket that it has made, to be removed.
    socket: Option<PathBuf>,
    grants: Vec<Grant>,
    /// Clients are no longer heard.
    closing: Arc<AtomicBool>,
    /// The cycle and the desk end.
    over: Arc<AtomicBool>,
    threads: Vec<JoinHandle<()>>,
    office: Option<Office>,
    /// How many ticks its recording has lost, once there will be no more.
    lost: Arc<OnceLock<u64>>,
}

impl Server {
    /// Opens a server for the devices of a cell. `watch` looks at every command after each of its cycles, on the cycle's
    /// thread: `()` for nobody.
    ///
    /// # Errors
    /// If it may not listen where it should, or the system does not let it.
    pub fn open(
        cell: &Cell,
        settings: &Settings,
        watch: impl Watch + Send + 'static,
    ) -> Result<Server, CannotOpen> {
        Server::open_recorded(cell, settings, watch, None)
    }

    /// As [`Server::open`]; everything that its core does is recorded, until it is [closed](Server::close).
    ///
    /// # Errors
    /// As there, and those of the recording's file.
    pub fn open_recorded(
        cell: &Cell,
        settings: &Settings,
        watch: impl Watch + Send + 'static,
        recording: Option<Wanted>,
    ) -> Result<Server, CannotOpen> {
        settings.guarded()?;
        let identity = settings.identity()?;
        let bound = TcpListener::bind(settings.listen);
        let listener = bound.map_err(|why| not_there(settings.listen, &why))?;
        listener.set_nonblocking(true)?;
        let address = listener.local_addr()?;
        let mut server = Server {
            address,
            socket: None,
            grants: Vec::new(),
            closing: Arc::default(),
            over: Arc::default(),
            threads: Vec::new(),
            office: None,
            lost: Arc::default(),
        };
        let office = server.start_cycle(cell, settings, Box::new(watch), recording)?;
        server.office = Some(office.clone());
        let reception = Reception {
            office,
            limits: settings.limits,
            guard: Guard {
                token: settings.token.clone(),
            },
            identity,
            closing: Arc::clone(&server.closing),
            connections: Arc::default(),
            strangers: Strangers::default(),
        };
        if let Some(path) = &settings.socket {
            server.listen_at(path, reception.clone())?;
        }
        server.spawn("rpi-listen", move || reception.take_all(&listener))?;
        Ok(server)
    }

    fn start_cycle(
        &mut self,
        cell: &Cell,
        settings: &Settings,
        watch: Box<dyn Watch + Send>,
        recording: Option<Wanted>,
    ) -> io::Result<Office> {
        let (limits, tick_ns) = (settings.limits, settings.tick_ns.max(1));
        let options = Options {
            tick_ns,
            commands: limits.commands,
            requests: REQUESTS,
            timed: settings.pace == Pace::Real,
            budget: settings.budget(),
            ..Options::default()
        };
        let devices = Taped::new(bank(cell, limits.devices, tick_ns));
        // Names are resolved by the loader, against a twin of the devices.
        let (mut control, mut executive) = open(devices, Box::new(NoDevices), options);
        let guard = (tick_ns, settings.continuity.unwrap_or_default());
        let record = |wanted| record(wanted, cell, guard, (&mut control, &mut executive));
        let (recorder, camera) = recording.map(record).transpose()?.unzip();
        let office = Office::open(cell, (control, recorder), settings)?;
        let overrun = settings.real_time.map(|r| r.overrun).unwrap_or_default();
        let cycle = Cycle {
            executive,
            beat: Beat::start(settings.pace, tick_ns, overrun),
            watch,
            around_tick: settings.around_tick,
            over: Arc::clone(&self.over),
            alarm: office.desk().alarm(),
            camera,
            lost: Arc::clone(&self.lost),
        };
        self.run(cycle, settings.real_time)?;
        let (over, keeper) = (Arc::clone(&self.over), office.clone());
        self.spawn("rpi-desk", move || {
            while !over.load(Ordering::Relaxed) {
                keeper.desk().keep();
                thread::sleep(KEEP);
            }
        })?;
        Ok(office)
    }

    /// Has the cycle run on its thread, and waits until that has heard what the system grants.
    fn run(&mut self, cycle: Cycle, real_time: Option<RealTime>) -> io::Result<()> {
        let granted = Arc::new(OnceLock::new());
        let tell = Arc::clone(&granted);
        self.spawn(CYCLE, move || cycle.run(real_time, &tell))?;
        let ended = |t: &JoinHandle<()>| t.is_finished();
        while granted.get().is_none() && !self.threads.last().is_some_and(ended) {
            thread::sleep(KEEP);
        }
        self.grants = granted.get().cloned().unwrap_or_default();
        if self.grants.iter().any(realtime::is_fence_up) {
            // It cannot end behind its fence: nobody waits for it.
            self.threads.pop();
        }
        Ok(())
    }

    #[cfg(unix)]
    fn listen_at(&mut self, path: &Path, reception: Reception) -> io::Result<()> {
        let listener = crate::wire::bind(path)?;
        self.socket = Some(path.to_owned());
        listener.set_nonblocking(true)?;
        self.spawn("rpi-listen", move || reception.take_all_local(&listener))
    }

    #[cfg(not(unix))]
    fn listen_at(&mut self, _: &Path, _: Reception) -> io::Result<()> {
        Err(io::ErrorKind::Unsupported.into())
    }

    fn spawn(&mut self, name: &str, work: impl FnOnce() + Send + 'static) -> io::Result<()> {
        let thread = thread::Builder::new().name(name.into()).spawn(work)?;
        self.threads.push(thread);
        Ok(())
    }

    /// What the system has said to what was asked of it for the thread that ticks.
    #[must_use]
    pub fn grants(&self) -> &[Grant] {
        &self.grants
    }

    /// An emergency stop: in this tick everything is stopped, and nothing can be started until it is reset. `by` says who wants
    /// it, or why.
    pub fn emergency_stop(&self, by: &str) {
        if let Some(office) = &self.office {
            office.desk().emergency_stop(by, Box::new(|_| {}));
        }
    }

    /// What somebody should know who looks after it, since they were last asked for: that a recording has come to its end as the disk
    /// is full, that wrong tokens are shown. What runs is not disturbed by it.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let office = self.office.as_ref();
        office.map_or_else(Vec::new, |office| office.desk().warnings())
    }

    /// Where it listens.
    #[must_use]
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Closes it: clients are no longer heard, everything is stopped, and ticks go on until all devices stand still, for at most
    /// five seconds. What was recorded, if it was.
    ///
    /// # Errors
    /// Those of the recording.
    pub fn close(mut self) -> io::Result<Option<Written>> {
        self.end()
    }

    fn end(&mut self) -> io::Result<Option<Written>> {
        self.closing.store(true, Ordering::Relaxed);
        self.come_to_rest();
        self.over.store(true, Ordering::Relaxed);
        let fenced = self.grants.iter().any(realtime::is_fence_up);
        self.wait();
        while fenced && self.lost.get().is_none() {
            thread::sleep(KEEP);
        }
        let lost = self.lost.get().copied().unwrap_or_default();
        let office = self.office.take();
        office.map_or(Ok(None), |office| office.desk().finish_recording(lost))
    }

    /// Stops everything, and waits until the devices stand still: nobody lets go of an arm that moves.
    fn come_to_rest(&self) {
        let Some(office) = &self.office else {
            return;
        };
        office.desk().stop_everything();
        let begin = Instant::now();
        while self.ticks() && begin.elapsed() < REST && !office.desk().has_come_to_rest() {
            thread::sleep(KEEP);
        }
    }

    /// Whether the cycle is still there to move devices.
    fn ticks(&self) -> bool {
        let mut threads = self.threads.iter();
        let ended = |t: &JoinHandle<()>| t.thread().name() == Some(CYCLE) && t.is_finished();
        !threads.any(ended)
    }

    /// Whether it still serves: only a fault ends it from inside.
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
        // Whoever wants to know what became of a recording closes it.
        let _ = self.end();
        if let Some(path) = &self.socket {
            let _ = std::fs::remove_file(path);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::desk::{Language, Load, Sink, Update};
    use crate::peer::Peer;

    /// Swings an axis of the arm for ever.
    const SWING: &str = "{t=Core::Clock(Increment='1.0'),c=Core::DoubleCos(inValue=t.outValue),\
        n=Core::DoubleMultiply(inFirst=c.outValue,Second='-0.1'),\
        p=Core::DoubleAdd(inFirst=n.outValue,Second='0.1'),\
        a=RobotArm::JointPosition(inPosition=p.outValue,Robot='arm',Axis='0')}";

    /// Has the server run a command, and waits until the arm moves.
    fn swing(office: &Office) {
        let client = office.desk().client(Peer::Here);
        let session = office.desk().open_session("test", None, (client, true));
        let session = session.unwrap();
        let load = Load {
            session: &session,
            title: "swing",
            language: Language::Rpinet,
            text: SWING,
            command: None,
            period_ns: 0,
            on_overrun: None,
        };
        let starter = office.clone();
        let started = move |name: Result<String, _>| {
            // The desk is taken while it answers.
            let name = name.unwrap();
            thread::spawn(move || starter.desk().start(&name, Box::new(|_| {})));
        };
        office.desk().load(&load, Box::new(started));
        let begin = Instant::now();
        while !office.desk().devices().any(|info| info.moving) {
            assert!(
                begin.elapsed() < Duration::from_secs(30),
                "it does not move"
            );
            thread::sleep(KEEP);
        }
    }

    /// Hears what it is told first, and nothing after.
    struct Deaf;

    impl Sink for Deaf {
        fn tell(&mut self, _: &Update<'_>) -> bool {
            true
        }

        fn is_heard(&self) -> bool {
            false
        }
    }

    /// Otherwise each connection that once watched what never happens would be remembered for ever.
    #[test]
    fn whoever_is_gone_is_forgotten() {
        let cell = Cell::parse("cell.toml", "").unwrap();
        let settings = Settings {
            listen: SocketAddr::new(IpAddr::from([127, 0, 0, 1]), 0),
            ..Settings::default()
        };
        let server = Server::open(&cell, &settings, ()).unwrap();
        let office = server.office.clone().unwrap();
        let mut desk = office.desk();
        let client = desk.client(Peer::Here);
        let session = desk.open_session("test", None, (client, true)).unwrap();
        desk.watch_emergency(Box::new(Deaf));
        desk.watch_devices(Box::new(Deaf));
        desk.watch_session(&session, Box::new(Deaf)).unwrap();
        assert_eq!(desk.watching(), 3);
        desk.lose_client(client, &[]);
        assert_eq!(desk.watching(), 0);
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
        let office = server.office.clone().unwrap();
        swing(&office);
        server.close().unwrap();
        assert!(!office.desk().devices().any(|info| info.moving));
    }
}
