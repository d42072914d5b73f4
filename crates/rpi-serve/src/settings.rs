//! Configuration of the server.

use std::net::{IpAddr, SocketAddr};
use std::path::PathBuf;
use std::time::Duration;

use rpi_core::Continuity;
use rpi_runtime::control::Budget;
use rpi_runtime::realtime::{RealTime, TimeBase};

use crate::client_token::ClientToken;
use crate::compile::CompilerSettings;
use crate::limits::{Limits, OnLoss};
use crate::open_error::OpenError;
use crate::role::Role;
use crate::transport::TlsIdentity;

/// Configuration of a server.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Listening address. An address beyond loopback requires a token and TLS.
    pub listen: SocketAddr,
    /// Additional Unix sockets at which the server accepts JSON-RPC, one message per line.
    pub sockets: Vec<SocketSettings>,
    /// Accepted tokens. A client over the network must present one of them. If the list is empty, every client is
    /// accepted.
    pub tokens: Vec<ClientToken>,
    /// Certificate and key files for TLS; `None` for unencrypted connections.
    pub tls: Option<TlsFiles>,
    /// Whether the server may listen beyond loopback without a token or TLS.
    pub insecure: bool,
    /// Length of a tick in nanoseconds. Periods of commands are whole multiples of the tick.
    pub tick_ns: u64,
    /// Relation of the ticks to time: real time, or simulated or accelerated time.
    pub pace: TimeBase,
    /// Function called for each tick with the tick as its argument, which the function must call once. Tests use the
    /// function to trap allocations.
    pub tick_wrapper: fn(&mut dyn FnMut()),
    /// Real-time settings requested for the cycle thread, and the policies for overruns (ticks that end after the next
    /// one is due). `None` runs an ordinary thread.
    pub real_time: Option<RealTime>,
    /// Policy for a takeover with a discontinuity of the set-points. With `None`, such a command is rejected if it was
    /// compiled from a program, and accepted if it was compiled from a net of the reference system (the control core of
    /// the Robotics API), because such nets are written for control cores without this check.
    pub continuity: Option<Continuity>,
    /// Policy for the commands of a session whose client has disconnected. A session may set another policy.
    pub on_loss: OnLoss,
    /// Time within which a cancelled command must end. Afterwards the command is aborted, and its devices brake on
    /// their own. A session or a request may set another time.
    pub grace: Duration,
    /// Maximum share of a tick for the cycles of all commands together, from 0 to 1. The time of each cycle is the
    /// compiler's upper bound. Commands beyond the share are rejected; the rest of the tick is for requests and
    /// devices. `None` disables the check.
    pub cycle_share: Option<f64>,
    /// Worst-case time of an elementary operation, such as an addition of reals, in nanoseconds. `rpic machine`
    /// measures it. The server uses it to reject commands that would not fit into a tick.
    pub ns_per_operation: f64,
    /// Name of the requester of an emergency stop that is in force from the start, as after a crash; `None` for no
    /// stop. Only the operator may reset it.
    pub stopped_by: Option<String>,
    /// File to which each line of the log is appended as a JSON object, if any.
    pub log_file: Option<PathBuf>,
    /// Process in which the texts of clients are compiled.
    pub compiler: CompilerSettings,
    /// Limits on the resources that clients may use.
    pub limits: Limits,
}

impl Default for Settings {
    fn default() -> Settings {
        Settings {
            listen: SocketAddr::new(IpAddr::from([127, 0, 0, 1]), 8080),
            sockets: Vec::new(),
            tokens: Vec::new(),
            tls: None,
            insecure: false,
            tick_ns: 1_000_000,
            pace: TimeBase::Real,
            tick_wrapper: |tick| tick(),
            real_time: None,
            continuity: None,
            on_loss: OnLoss::default(),
            grace: Duration::from_secs(5),
            cycle_share: Some(Budget::SHARE),
            ns_per_operation: Budget::NS_PER_OPERATION,
            stopped_by: None,
            log_file: None,
            compiler: CompilerSettings::default(),
            limits: Limits::default(),
        }
    }
}

/// Unix socket whose clients have a fixed role. The permissions of the socket file decide who may connect.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct SocketSettings {
    /// Path of the socket file.
    pub path: PathBuf,
    /// Role of the clients that connect at this socket.
    pub role: Role,
    /// Permissions of the socket file (the lowest nine bits); `None` for those that the process gives to new files.
    pub mode: Option<u32>,
}

impl SocketSettings {
    /// Creates a socket for programmers, with the permissions that the process gives to new files.
    #[must_use]
    pub fn new(path: PathBuf) -> SocketSettings {
        SocketSettings {
            path,
            role: Role::default(),
            mode: None,
        }
    }
}

/// Paths of the PEM files with the TLS certificate and the private key of the server.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct TlsFiles {
    /// Path of the certificate chain: the server's certificate, then the intermediate ones up to an authority that
    /// clients trust.
    pub certificates: PathBuf,
    /// Path of the private key that belongs to the server's certificate.
    pub key: PathBuf,
}

impl Settings {
    /// Returns an error if the server would listen beyond loopback without a token or without TLS, unless this is
    /// allowed explicitly.
    pub(crate) fn check_protection(&self) -> Result<(), OpenError> {
        let (no_token, no_tls) = (self.tokens.is_empty(), self.tls.is_none());
        let local = self.listen.ip().is_loopback();
        match local || self.insecure || !(no_token || no_tls) {
            true => Ok(()),
            false => Err(OpenError::Unprotected {
                address: self.listen,
                no_token,
                no_tls,
            }),
        }
    }

    /// Returns the budget of time per tick for all commands together; `None` if it is not limited.
    pub(crate) fn budget(&self) -> Option<Budget> {
        let share = self.cycle_share?;
        Some(Budget::from_share(
            self.tick_ns.max(1),
            share,
            self.ns_per_operation,
        ))
    }

    /// Reads the certificate and key files. Returns `None` if none are configured.
    pub(crate) fn identity(&self) -> Result<Option<TlsIdentity>, OpenError> {
        let read = |files: &TlsFiles| TlsIdentity::read(&files.certificates, &files.key);
        let identity = self.tls.as_ref().map(read).transpose();
        identity.map_err(OpenError::Identity)
    }
}
