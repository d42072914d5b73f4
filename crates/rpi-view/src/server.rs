//! Server of the page, the document and its parts over HTTP, for one user on this machine.

use std::fmt;
use std::io::{self, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, PoisonError, RwLock};
use std::time::Duration;

use crate::PAGE;
use crate::request::{RequestError, Resource, read_head, resource};

/// Maximum number of connections at a time. A browser uses up to six.
const MAX_CONNECTIONS: usize = 32;
/// Maximum time to read a request or to write a part of a response.
const TIMEOUT: Duration = Duration::from_secs(10);
/// The page may run its own script and style and read from this server, nothing else.
const POLICY: &str = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; \
    img-src data: blob:; connect-src 'self' data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// Server of one run: a recording, or a run that goes on. It listens on the loopback interface only and answers GET requests for the page
/// and for what the page shows.
#[derive(Debug)]
pub struct ViewServer {
    listener: TcpListener,
    address: SocketAddr,
    source: SharedSource,
}

/// What a page can request about a run.
pub trait ViewSource: Send + Sync {
    /// Returns the document of the run.
    fn document(&self) -> Arc<[u8]>;

    /// Returns the document of the values from a tick on, without what does not change; `None` if the run has ended, so that the page
    /// must load the whole document again.
    fn since(&self, tick: u64) -> Option<Vec<u8>>;

    /// Returns the values of all flows in a tick as JSON.
    ///
    /// # Errors
    /// Returns a text for the reader of the page if the values are not known.
    fn cycle(&self, tick: u64) -> Result<String, String>;

    /// Returns a document with the values of one flow, named by its command and the path to it.
    ///
    /// # Errors
    /// Returns a text for the reader of the page if the values are not known.
    fn flow(&self, name: &str) -> Result<Vec<u8>, String>;

    /// Returns the causes of the value of a flow in a tick as JSON.
    ///
    /// # Errors
    /// Returns a text for the reader of the page if the values are not known.
    fn why(&self, tick: u64, name: &str) -> Result<String, String>;
}

/// What a server shows. It can be replaced while the server runs: at its end, a run is replaced by its recording.
#[derive(Clone)]
pub struct SharedSource(Arc<RwLock<Arc<dyn ViewSource>>>);

impl SharedSource {
    /// Replaces what is shown.
    pub fn set(&self, source: Arc<dyn ViewSource>) {
        *self.0.write().unwrap_or_else(PoisonError::into_inner) = source;
    }

    fn get(&self) -> Arc<dyn ViewSource> {
        Arc::clone(&self.0.read().unwrap_or_else(PoisonError::into_inner))
    }
}

impl fmt::Debug for SharedSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("SharedSource")
    }
}

impl ViewServer {
    /// Creates a server on this port of the loopback interface; port 0 is any free port.
    ///
    /// # Errors
    /// Returns an error if the port is in use.
    pub fn bind(source: Arc<dyn ViewSource>, port: u16) -> io::Result<ViewServer> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))?;
        Ok(ViewServer {
            address: listener.local_addr()?,
            listener,
            source: SharedSource(Arc::new(RwLock::new(source))),
        })
    }

    /// Returns a handle to what is shown.
    #[must_use]
    pub fn source(&self) -> SharedSource {
        self.source.clone()
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
            let (source, own) = (self.source.get(), self.address);
            let count = Arc::clone(&open);
            let answer = move || {
                // The browser closes connections as it likes; an error cannot be reported.
                let _ = respond(connection, own, &*source);
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

/// Response to a request.
struct Response {
    status: &'static str,
    kind: &'static str,
    body: Body,
}

/// Body of a response. That of a document is shared, because it may be large.
enum Body {
    Page,
    Shared(Arc<[u8]>),
    Own(Vec<u8>),
}

impl Body {
    fn bytes(&self) -> &[u8] {
        match self {
            Body::Page => PAGE.as_bytes(),
            Body::Shared(bytes) => bytes,
            Body::Own(bytes) => bytes,
        }
    }
}

const PLAIN: &str = "text/plain; charset=utf-8";
const JSON: &str = "application/json";
const DOCUMENT: &str = "application/octet-stream";

impl Response {
    fn ok(kind: &'static str, body: Body) -> Response {
        Response {
            status: "200 OK",
            kind,
            body,
        }
    }

    fn error(status: &'static str, text: impl Into<Vec<u8>>) -> Response {
        Response {
            status,
            ..Response::ok(PLAIN, Body::Own(text.into()))
        }
    }

    /// Returns a part of a run, or the reason why it is not known.
    fn part(kind: &'static str, part: Result<impl Into<Vec<u8>>, String>) -> Response {
        part.map_or_else(
            |why| Response::error("422 Unprocessable Content", why),
            |body| Response::ok(kind, Body::Own(body.into())),
        )
    }

    fn new(requested: Result<Resource, RequestError>, source: &dyn ViewSource) -> Response {
        match requested {
            Ok(Resource::Page) => Response::ok("text/html; charset=utf-8", Body::Page),
            Ok(Resource::Document) => Response::ok(DOCUMENT, Body::Shared(source.document())),
            Ok(Resource::Since(tick)) => source.since(tick).map_or_else(
                // Nothing more comes.
                || Response::ok(DOCUMENT, Body::Own(Vec::new())),
                |document| Response::ok(DOCUMENT, Body::Own(document)),
            ),
            Ok(Resource::Cycle(tick)) => Response::part(JSON, source.cycle(tick)),
            Ok(Resource::Flow(name)) => Response::part(DOCUMENT, source.flow(&name)),
            Ok(Resource::Why(tick, name)) => Response::part(JSON, source.why(tick, &name)),
            Err(error) => Response::error(error.status(), error.status()),
        }
    }
}

/// Answers one request and closes the connection.
fn respond(mut connection: TcpStream, own: SocketAddr, source: &dyn ViewSource) -> io::Result<()> {
    connection.set_read_timeout(Some(TIMEOUT))?;
    connection.set_write_timeout(Some(TIMEOUT))?;
    let head = read_head(&mut connection)?;
    let Response { status, kind, body } = Response::new(resource(&head, own), source);
    let length = body.bytes().len();
    write!(
        connection,
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {length}\r\nCache-Control: no-store\r\n\
         Content-Security-Policy: {POLICY}\r\nX-Content-Type-Options: nosniff\r\n\
         Cross-Origin-Resource-Policy: same-origin\r\nConnection: close\r\n\r\n"
    )?;
    connection.write_all(body.bytes())?;
    connection.flush()
}
