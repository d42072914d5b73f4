//! TLS for connections from other machines (RFC 8446, RFC 5246), by rustls.

use std::io::{self, Read, Write};
use std::net::{Shutdown, TcpStream};
use std::path::Path;
use std::sync::Arc;

use rustls::crypto::ring::default_provider;
use rustls::pki_types::pem::{self, PemObject};
use rustls::pki_types::{CertificateDer, PrivateKeyDer};
use rustls::{ServerConfig, ServerConnection, StreamOwned};

use super::framing::Stream;
use crate::client_token::ensure_private_file;
use crate::open_error::IdentityError;

/// Certificate chain and private key of the server, as a configuration for TLS connections.
#[derive(Clone)]
pub(crate) struct TlsIdentity(Arc<ServerConfig>);

impl TlsIdentity {
    /// Reads the certificate chain, the server's own certificate first, and the private key, both in PEM (RFC 7468).
    /// The file with the key must be accessible to its owner only.
    ///
    /// # Errors
    /// If a file cannot be read or used.
    pub(crate) fn read(certificates: &Path, key: &Path) -> Result<TlsIdentity, IdentityError> {
        let of = |path: &Path, reason: &dyn std::fmt::Display| IdentityError::File {
            path: path.to_owned(),
            reason: reason.to_string(),
        };
        let chain = CertificateDer::pem_file_iter(certificates).and_then(Iterator::collect);
        let chain: Vec<_> = chain.map_err(|why| of(certificates, &why))?;
        if chain.is_empty() {
            return Err(of(certificates, &"the file has no certificate"));
        }
        ensure_private_file(key).map_err(|why| of(key, &why))?;
        let secret = PrivateKeyDer::from_pem_file(key).map_err(|why| match why {
            pem::Error::NoItemsFound => of(key, &"the file has no private key"),
            why => of(key, &why),
        })?;
        let config = ServerConfig::builder_with_provider(Arc::new(default_provider()))
            .with_safe_default_protocol_versions()
            .and_then(|config| config.with_no_client_auth().with_single_cert(chain, secret));
        config
            .map(|config| TlsIdentity(Arc::new(config)))
            .map_err(|why| of(key, &why))
    }

    /// Starts TLS on a connection. The handshake takes place with the first read.
    ///
    /// # Errors
    /// If the TLS connection cannot be created.
    pub(crate) fn accept(&self, stream: TcpStream) -> io::Result<TlsStream> {
        let connection = ServerConnection::new(Arc::clone(&self.0)).map_err(io::Error::other)?;
        Ok(TlsStream(StreamOwned::new(connection, stream)))
    }
}

/// Server side of a TLS connection.
pub(crate) struct TlsStream(StreamOwned<ServerConnection, TcpStream>);

impl Read for TlsStream {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.0.read(buffer)
    }
}

impl Write for TlsStream {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

impl Stream for TlsStream {
    fn end_writing(&mut self) {
        self.0.conn.send_close_notify();
        // The connection may be broken already.
        let _ = self.0.flush();
        let _ = self.0.sock.shutdown(Shutdown::Write);
    }
}

impl Drop for TlsStream {
    /// Sends the TLS message `close_notify`, so that the client can distinguish the end of an answer from a truncated
    /// one.
    fn drop(&mut self) {
        self.0.conn.send_close_notify();
        let _ = self.0.flush();
    }
}
