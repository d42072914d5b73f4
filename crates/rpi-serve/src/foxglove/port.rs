//! The port at which Foxglove connects.

use std::io;
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread::{self, JoinHandle};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use http::{Method, StatusCode};
use rpi_record::mcap::LiveViewers;

use super::connection::{LiveConnection, LiveRequests};
use super::hub::LiveHub;
use super::protocol::{self, SUBPROTOCOL};
use crate::client_token::ClientToken;
use crate::limits::Limits;
use crate::open_error::{OpenError, bind_error};
use crate::peer::Peer;
use crate::settings::{Settings, TlsFiles};
use crate::transport::{
    AuthPolicy, AuthThrottle, Head, MemoryPool, MeteredStream, Stream, TlsIdentity,
    accept_websocket, finish, framing, is_websocket_upgrade, prepare, rejection, starts_tls,
};
use crate::web::Response;

/// Maximum number of clients, and of connections that are not clients yet.
const MAX_CLIENTS: usize = 16;
/// Maximum size of a message of a client in bytes: a subscription to each of a thousand channels.
const MAX_MESSAGE: usize = 64 << 10;
/// Time to wait between two checks for a new connection and for the end of the port.
const POLL_INTERVAL: Duration = Duration::from_millis(20);
/// Stack of a connection in bytes.
const STACK_BYTES: usize = 512 << 10;

/// Answer to a client for which there is no place.
const NO_PLACE: &str = "there is no place for another viewer";
/// Answer to a request that does not come from Foxglove.
const OTHER_PROTOCOL: &str =
    "this port is for Foxglove: a websocket with the subprotocol `foxglove.websocket.v1`";

/// Settings of a port for Foxglove. The rules for hosts, origins and tokens are those of the server.
#[derive(Clone, Debug)]
pub struct FoxgloveSettings {
    /// Address and port at which it listens; port 0 for any free one.
    pub listen: SocketAddr,
    /// Accepted tokens. If the list is empty, every client is accepted, which is allowed on loopback only.
    pub tokens: Vec<ClientToken>,
    /// Files of the certificate and its key; `None` if connections are not encrypted.
    pub tls: Option<TlsFiles>,
    /// Whether other machines may connect without a token or TLS.
    pub insecure: bool,
    /// Origins whose pages may connect, such as `https://app.foxglove.dev`.
    pub origins: Vec<String>,
}

/// Open port for Foxglove. Dropping it closes the port and disconnects the clients.
pub struct FoxglovePort {
    address: SocketAddr,
    hub: LiveHub,
    closing: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl FoxglovePort {
    /// Opens the port.
    ///
    /// # Errors
    /// If the address requires a token or TLS, a certificate cannot be used, or a system call fails.
    pub fn open(settings: &FoxgloveSettings) -> Result<FoxglovePort, OpenError> {
        let protection = Settings {
            listen: settings.listen,
            tokens: settings.tokens.clone(),
            tls: settings.tls.clone(),
            insecure: settings.insecure,
            ..Settings::default()
        };
        protection.check_protection()?;
        let bound = TcpListener::bind(settings.listen);
        let listener = bound.map_err(|why| bind_error(settings.listen, &why))?;
        listener.set_nonblocking(true)?;
        let address = listener.local_addr()?;
        let (hub, closing) = (LiveHub::default(), Arc::<AtomicBool>::default());
        let acceptor = LiveAcceptor {
            hub: hub.clone(),
            auth: AuthPolicy {
                tokens: settings.tokens.clone(),
                origins: settings.origins.clone(),
            },
            identity: protection.identity()?,
            limits: protection.limits,
            throttle: AuthThrottle::default(),
            memory: MemoryPool::new(protection.limits.memory.incoming),
            session: session(),
            open: Arc::default(),
            closing: Arc::clone(&closing),
        };
        let thread = thread::Builder::new().name("rpi-foxglove".into());
        let thread = thread.spawn(move || acceptor.accept_all(&listener))?;
        Ok(FoxglovePort {
            address,
            hub,
            closing,
            thread: Some(thread),
        })
    }

    /// Returns the address and port at which it listens.
    #[must_use]
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Returns the receiver of the messages of a run.
    #[must_use]
    pub fn viewers(&self) -> Box<dyn LiveViewers> {
        Box::new(self.hub.clone())
    }
}

impl Drop for FoxglovePort {
    fn drop(&mut self) {
        self.closing.store(true, Ordering::Relaxed);
        // It has not failed: nothing in it panics.
        let _ = self.thread.take().map(JoinHandle::join);
    }
}

/// Returns a text that is different for each start of the server, so that clients know it again after a lost connection.
fn session() -> String {
    let now = SystemTime::now().duration_since(UNIX_EPOCH);
    let now = now.map_or(0, |since| since.as_millis());
    format!("{now}-{}", std::process::id())
}

/// What the connections share.
#[derive(Clone)]
struct LiveAcceptor {
    hub: LiveHub,
    auth: AuthPolicy,
    identity: Option<TlsIdentity>,
    limits: Limits,
    throttle: AuthThrottle,
    /// Memory of the messages that are being received.
    memory: MemoryPool,
    session: String,
    /// Number of open connections.
    open: Arc<AtomicUsize>,
    closing: Arc<AtomicBool>,
}

/// Place of an open connection, which dropping it frees.
struct OpenPlace(Arc<AtomicUsize>);

impl Drop for OpenPlace {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}

impl LiveAcceptor {
    fn accept_all(&self, listener: &TcpListener) {
        while !self.closing.load(Ordering::Relaxed) {
            match listener.accept() {
                Ok((stream, from)) => self.accept(stream, Peer::from_ip(from.ip())),
                Err(_) => thread::sleep(POLL_INTERVAL),
            }
        }
    }

    /// Serves a connection on a thread of its own. Beyond the limit, it is closed without an answer.
    fn accept(&self, stream: TcpStream, peer: Peer) {
        let place = OpenPlace(Arc::clone(&self.open));
        if self.open.fetch_add(1, Ordering::Relaxed) >= 2 * MAX_CLIENTS
            || prepare(&stream, self.limits.request_timeout).is_err()
        {
            return;
        }
        let acceptor = self.clone();
        let thread = thread::Builder::new()
            .name("rpi-viewer".into())
            .stack_size(STACK_BYTES);
        // Without a thread, the connection is closed.
        let _ = thread.spawn(move || {
            let _place = place;
            acceptor.serve(stream, peer);
        });
    }

    fn serve(&self, stream: TcpStream, peer: Peer) {
        let stream: io::Result<Box<dyn Stream>> = match &self.identity {
            None => Ok(Box::new(stream)),
            Some(identity) => match starts_tls(&stream, self.limits.request_timeout) {
                Ok(true) => identity
                    .accept(stream)
                    .map(|s| Box::new(s) as Box<dyn Stream>),
                _ => Err(io::ErrorKind::InvalidData.into()),
            },
        };
        let Ok(stream) = stream else {
            return;
        };
        let memory = self.memory.connection(peer, usize::MAX);
        let mut stream = MeteredStream::new(stream, memory, self.limits.idle_timeout);
        let Ok(head) = Head::read(&mut stream, self.limits.request_timeout) else {
            return;
        };
        let head_only = head.method == Method::HEAD;
        match self.client(&head, peer) {
            Ok((client, key)) => self.serve_client(stream, head, &client, &key),
            Err(Some(response)) => finish(&mut stream, &response, head_only, &self.limits),
            Err(None) => {}
        }
    }

    /// Returns the client that a request adds, with its key for the handshake, or the response to a request that is rejected.
    fn client(
        &self,
        head: &Head,
        peer: Peer,
    ) -> Result<(LiveConnection, String), Option<Response>> {
        let error = |status, why: &str| Err(Some(Response::error(status, why)));
        self.auth.check_page(head).map_err(Some)?;
        let delay = self.limits.wrong_token_delay;
        let who = self.auth.identify(head, peer);
        who.map_err(|why| {
            // There is no log here; the throttle counts rejections by peer.
            let _ = self.throttle.record(peer, why);
            rejection(why, (&self.throttle, peer), delay, || {})
        })?;
        let offered = head.header("sec-websocket-protocol").unwrap_or_default();
        let is_offered = offered.split(',').any(|name| name.trim() == SUBPROTOCOL);
        let key = head.header("sec-websocket-key");
        let (true, true, Some(key)) = (is_websocket_upgrade(head), is_offered, key) else {
            return error(StatusCode::UPGRADE_REQUIRED, OTHER_PROTOCOL);
        };
        let greeting = protocol::server_info(&self.session);
        match self.hub.add_client(greeting, MAX_CLIENTS) {
            Some(id) => {
                let hub = self.hub.clone();
                Ok((LiveConnection { hub, id }, key.to_owned()))
            }
            None => error(StatusCode::SERVICE_UNAVAILABLE, NO_PLACE),
        }
    }

    fn serve_client(
        &self,
        mut stream: MeteredStream,
        head: Head,
        client: &LiveConnection,
        key: &str,
    ) {
        if accept_websocket(&mut stream, key, Some(SUBPROTOCOL)).is_ok() {
            framing::websocket(
                stream,
                head.remaining,
                (MAX_MESSAGE, Some(self.limits.idle_timeout)),
                &mut LiveRequests(client),
                client,
                &self.closing,
            );
        }
    }
}
