//! TLS connection to a server with a trusted certificate.

use std::net::TcpStream;
use std::path::Path;
use std::sync::Arc;

use rustls::crypto::ring::default_provider;
use rustls::pki_types::pem::PemObject;
use rustls::pki_types::{CertificateDer, ServerName};
use rustls::{ClientConfig, ClientConnection, RootCertStore, StreamOwned};

use crate::connection::Stream;
use crate::error::Error;

/// Starts TLS on a TCP stream to the server at `address` (`host:port`). The certificate of the server must be in the
/// PEM file `authorities`, or be signed by one in it.
pub(crate) fn connect(
    stream: TcpStream,
    address: &str,
    authorities: &Path,
) -> Result<Box<dyn Stream>, Error> {
    let host = address.rsplit_once(':').map_or(address, |(host, _)| host);
    let host = host.trim_start_matches('[').trim_end_matches(']');
    let name = ServerName::try_from(host.to_owned()).map_err(Error::connection)?;
    let mut trusted = RootCertStore::empty();
    let of_file = |why| Error::connection(format!("{}: {why}", authorities.display()));
    for certificate in CertificateDer::pem_file_iter(authorities).map_err(of_file)? {
        let added = trusted.add(certificate.map_err(of_file)?);
        added.map_err(Error::connection)?;
    }
    let config = ClientConfig::builder_with_provider(Arc::new(default_provider()))
        .with_safe_default_protocol_versions()
        .map_err(Error::connection)?
        .with_root_certificates(trusted)
        .with_no_client_auth();
    let connection = ClientConnection::new(Arc::new(config), name).map_err(Error::connection)?;
    Ok(Box::new(StreamOwned::new(connection, stream)))
}
