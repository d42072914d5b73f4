//! Errors of opening and operating the server.

use std::fmt;
use std::io;
use std::net::SocketAddr;
use std::path::PathBuf;

/// Error: the server's certificate or key cannot be used.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum IdentityError {
    /// A file with a certificate or key cannot be read or used.
    File {
        /// Path of the file with the certificate or key.
        path: PathBuf,
        /// Description of the error.
        reason: String,
    },
    /// The server was built without support for TLS.
    TlsUnsupported,
}

impl fmt::Display for IdentityError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            IdentityError::File { path, reason } => write!(f, "{}: {reason}", path.display()),
            IdentityError::TlsUnsupported => f.write_str(
                "this server was built without TLS; build it with `cargo build --release --features rpi/tls`",
            ),
        }
    }
}

impl std::error::Error for IdentityError {}

/// Error: a server cannot be opened.
#[derive(Debug)]
pub enum OpenError {
    /// The server would be reachable from other machines without protection.
    Unprotected {
        /// Configured address at which the server would listen.
        address: SocketAddr,
        /// Whether no token is configured, so that every client would be accepted.
        no_token: bool,
        /// Whether TLS is not configured, so that the traffic could be read and changed on its way.
        no_tls: bool,
    },
    /// The server's TLS certificate or private key cannot be used.
    Identity(IdentityError),
    /// A system call failed, such as binding the listening address.
    Io(io::Error),
}

impl fmt::Display for OpenError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            OpenError::Unprotected {
                address: at,
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
                    "{code}: {at} can be reached from other machines; it requires {lacking}"
                )
            }
            OpenError::Identity(error) => write!(f, "{error}"),
            OpenError::Io(why) => why.fmt(f),
        }
    }
}

impl std::error::Error for OpenError {}

impl From<io::Error> for OpenError {
    fn from(why: io::Error) -> OpenError {
        OpenError::Io(why)
    }
}

/// Error: the emergency stop cannot be reset.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct ResetError {
    /// Reason why the emergency stop cannot be reset, for the operator.
    pub reason: String,
}

impl fmt::Display for ResetError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.reason)
    }
}

impl std::error::Error for ResetError {}

/// Returns the error of binding the listening address `at`, with the address and a hint added to its text.
pub(crate) fn bind_error(at: SocketAddr, why: &io::Error) -> io::Error {
    let helps = match why.kind() {
        io::ErrorKind::AddrInUse => {
            "; another program listens there: end it, or choose another port"
        }
        io::ErrorKind::AddrNotAvailable => "; this machine has no such address",
        _ => "",
    };
    io::Error::new(why.kind(), format!("{at}: {why}{helps}"))
}
