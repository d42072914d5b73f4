//! Replacement of the module `tls` in a build without the feature `tls`.

use std::convert::Infallible;
use std::io;
use std::net::TcpStream;
use std::path::Path;

use crate::open_error::IdentityError;

/// Certificate and key of the server; cannot be created without TLS.
#[derive(Clone)]
pub(crate) struct TlsIdentity(Infallible);

impl TlsIdentity {
    /// Rejects the files, because the server cannot use them.
    ///
    /// # Errors
    /// Always.
    pub(crate) fn read(_: &Path, _: &Path) -> Result<TlsIdentity, IdentityError> {
        Err(IdentityError::TlsUnsupported)
    }

    /// Never called, because there is no identity.
    pub(crate) fn accept(&self, _: TcpStream) -> io::Result<TcpStream> {
        match self.0 {}
    }
}
