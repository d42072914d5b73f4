//! Server of the page and the document over HTTP, for one user on this machine.

use std::io::{self, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use rpi_record::mcap::RunData;

use crate::PAGE;
use crate::document::{Precision, document};
use crate::request::{Resource, read_head, resource};

/// Maximum number of connections at a time. A browser uses up to six.
const MAX_CONNECTIONS: usize = 32;
/// Maximum time to read a request or to write a part of a response.
const TIMEOUT: Duration = Duration::from_secs(10);
/// The page may run its own script and style and read from this server, nothing else.
const POLICY: &str = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; \
    img-src data: blob:; connect-src 'self' data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// Server of one recording. It listens on the loopback interface only and answers GET requests for the page and the
/// document.
#[derive(Debug)]
pub struct ViewServer {
    listener: TcpListener,
    address: SocketAddr,
    document: Arc<[u8]>,
}

impl ViewServer {
    /// Creates a server of a recorded run on this port of the loopback interface; port 0 is any free port.
    ///
    /// # Errors
    /// Returns an error if the port is in use.
    pub fn bind(run: &RunData, port: u16) -> io::Result<ViewServer> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))?;
        Ok(ViewServer {
            address: listener.local_addr()?,
            listener,
            document: document(run, Precision::Exact).into(),
        })
    }

    /// Returns the address of the page for a browser.
    #[must_use]
    pub fn url(&self) -> String {
        format!("http://{}/", self.address)
    }

    /// Answers requests until the process ends.
    ///
    /// # Errors
    /// Returns an error if no connection can be accepted any more.
    pub fn serve(&self) -> io::Result<()> {
        let open = Arc::<AtomicUsize>::default();
        loop {
            let connection = match self.listener.accept() {
                Ok((connection, _)) => connection,
                // A client that was gone before it was accepted is no error of the server.
                Err(error) if is_of_client(&error) => continue,
                Err(error) => return Err(error),
            };
            if open.fetch_add(1, Ordering::Relaxed) >= MAX_CONNECTIONS {
                open.fetch_sub(1, Ordering::Relaxed);
                continue;
            }
            let (document, own) = (Arc::clone(&self.document), self.address);
            let count = Arc::clone(&open);
            let answer = move || {
                // The browser closes connections as it likes; an error cannot be reported.
                let _ = respond(connection, own, &document);
                count.fetch_sub(1, Ordering::Relaxed);
            };
            if std::thread::Builder::new().spawn(answer).is_err() {
                open.fetch_sub(1, Ordering::Relaxed);
            }
        }
    }
}

/// Returns true for an error of accepting a connection that the client caused.
fn is_of_client(error: &io::Error) -> bool {
    use io::ErrorKind::{ConnectionAborted, ConnectionReset, Interrupted};
    [ConnectionAborted, ConnectionReset, Interrupted].contains(&error.kind())
}

/// Answers one request and closes the connection.
fn respond(mut connection: TcpStream, own: SocketAddr, document: &[u8]) -> io::Result<()> {
    connection.set_read_timeout(Some(TIMEOUT))?;
    connection.set_write_timeout(Some(TIMEOUT))?;
    let head = read_head(&mut connection)?;
    let (status, kind, body) = match resource(&head, own) {
        Ok(Resource::Page) => ("200 OK", "text/html; charset=utf-8", PAGE.as_bytes()),
        Ok(Resource::Document) => ("200 OK", "application/octet-stream", document),
        Err(error) => (error.status(), "text/plain", error.status().as_bytes()),
    };
    let length = body.len();
    write!(
        connection,
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {length}\r\nCache-Control: no-store\r\n\
         Content-Security-Policy: {POLICY}\r\nX-Content-Type-Options: nosniff\r\n\
         Cross-Origin-Resource-Policy: same-origin\r\nConnection: close\r\n\r\n"
    )?;
    connection.write_all(body)?;
    connection.flush()
}
