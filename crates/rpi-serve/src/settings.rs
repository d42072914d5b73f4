//! Configuration of the server.

use std::net::{IpAddr, SocketAddr};
use std::path::PathBuf;
use std::time::Duration;

use rpi_core::Continuity;
use rpi_runtime::control::Budget;
use rpi_runtime::realtime::{RealTime, TimeBase};

use crate::limits::{Limits, OnLoss};
use crate::open_error::OpenError;
use crate::transport::TlsIdentity;

/// Configuration of a server.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Listening address. An address beyond loopback requires a token and TLS.
    pub listen: SocketAddr,
    /// Path of an additional Unix socket: JSON-RPC, one message per line.
    pub socket: Option<PathBuf>,
    /// Token that clients must present.
    pub token: Option<String>,
    /// Certificate and key files for encrypted connections.
    pub tls: Option<TlsFiles>,
    /// Allows listening beyond loopback without token or TLS.
    pub insecure: bool,
    /// Length of a tick in nanoseconds. Command periods are whole multiples of it.
    pub tick_ns: u64,
    /// Time source of the ticks: real or simulated time.
    pub pace: TimeBase,
    /// Wrapper around each tick; it must call its argument once. Tests use it to trap allocations.
    pub tick_wrapper: fn(&mut dyn FnMut()),
    /// Real-time settings requested for the cycle thread and the policy for ticks that end after the next one is due.
    /// `None` runs an ordinary thread.
    pub real_time: Option<RealTime>,
    /// Policy for a takeover with a jump. With `None`, such a command is refused if it comes from a program and allowed
    /// if it comes from a net of the reference system, which was written for control cores without this check.
    pub continuity: Option<Continuity>,
    /// Policy for the commands of a session whose client has disconnected, unless the client specifies one.
    pub on_loss: OnLoss,
    /// Time in which a cancelled command must end; afterwards it is aborted, and its devices brake on their own. A session
    /// or a request may set another one.
    pub grace: Duration,
    /// Maximum share of a tick for all commands together, from 0 to 1, by the compiler's bounds. Commands beyond it are
    /// rejected; the rest of the tick is for requests and devices. `None` disables the check.
    pub cycle_share: Option<f64>,
    /// Time of an elementary operation in nanoseconds; `rpic machine` measures the worst case.
    pub ns_per_operation: f64,
    /// Resource limits of clients.
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
            pace: TimeBase::Real,
            tick_wrapper: |tick| tick(),
            real_time: None,
            continuity: None,
            on_loss: OnLoss::default(),
            grace: Duration::from_secs(5),
            cycle_share: Some(Budget::SHARE),
            ns_per_operation: Budget::NS_PER_OPERATION,
            limits: Limits::default(),
        }
    }
}

/// PEM files that identify the server.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct TlsFiles {
    /// Certificate chain: the server's certificate, then the intermediate ones up to an authority that clients trust.
    pub certificates: PathBuf,
    /// Private key of the certificate.
    pub key: PathBuf,
}

impl Settings {
    /// Returns an error if the address is beyond loopback and the token or TLS is missing.
    pub(crate) fn check_protection(&self) -> Result<(), OpenError> {
        let (no_token, no_tls) = (self.token.is_none(), self.tls.is_none());
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

    /// Returns the budget of commands per tick, if it is limited.
    pub(crate) fn budget(&self) -> Option<Budget> {
        let share = self.cycle_share?;
        Some(Budget::from_share(
            self.tick_ns.max(1),
            share,
            self.ns_per_operation,
        ))
    }

    /// Reads the certificate and key, if they are configured.
    pub(crate) fn identity(&self) -> Result<Option<TlsIdentity>, OpenError> {
        let read = |files: &TlsFiles| TlsIdentity::read(&files.certificates, &files.key);
        let identity = self.tls.as_ref().map(read).transpose();
        identity.map_err(OpenError::Identity)
    }
}
