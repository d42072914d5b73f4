//! In place of TLS where it is left out (feature `tls`): there is no such connection.

use std::convert::Infallible;
use std::io;
use std::net::TcpStream;
use std::path::Path;

/// Who the server is: it cannot show that.
#[derive(Clone)]
pub(crate) struct Identity(Infallible);

impl Identity {
    /// # Errors
    /// Always.
    pub(crate) fn read(_: &Path, _: &Path) -> Result<Identity, String> {
        Err("this server was built without TLS".to_owned())
    }

    pub(crate) fn secure(&self, _: TcpStream) -> io::Result<TcpStream> {
        match self.0 {}
    }
}
