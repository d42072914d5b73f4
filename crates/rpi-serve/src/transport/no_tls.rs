//! Replacement of the module `tls` in a build without the feature `tls`.

use std::convert::Infallible;
use std::io;
use std::net::TcpStream;
use std::path::Path;

use crate::open_error::IdentityError;

/// Certificate and key of the server in a build with TLS. This type has no value, because this build has no TLS.
#[derive(Clone)]
pub(crate) struct TlsIdentity(Infallible);

impl TlsIdentity {
    /// Returns an error, because a build without TLS cannot use certificate and key.
    ///
    /// # Errors
    /// Always.
    pub(crate) fn read(_: &Path, _: &Path) -> Result<TlsIdentity, IdentityError> {
        Err(IdentityError::TlsUnsupported)
    }

    /// Never called, because [`TlsIdentity`] has no value in a build without TLS.
    pub(crate) fn accept(&self, _: TcpStream) -> io::Result<TcpStream> {
        match self.0 {}
    }
}
