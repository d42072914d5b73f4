//! Accepts connections, each on its own thread, up to a limit.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use tungstenite::handshake::derive_accept_key;

use super::auth::AuthPolicy;
use super::auth_throttle::{AuthThrottle, RejectReason};
use super::framing::{self, CloseReason, ConnectionHandler, READ_TIMEOUT, Stream};
use super::http_head::{Head, is_timeout};
use super::outbox::{Outbox, outbox};
use super::tls::TlsIdentity;
use crate::dio::DioConnection;
use crate::fair_share::Usage;
use crate::limits::Limits;
use crate::peer::Peer;
use crate::rpc::RpcConnection;
use crate::state::SharedState;
use crate::web;

/// Data shared by all connections, with which new ones are accepted.
#[derive(Clone)]
pub(crate) struct Acceptor {
    pub(crate) state: SharedState,
    pub(crate) limits: Limits,
    pub(crate) auth: AuthPolicy,
    /// Certificate and key for TLS; `None` for plain connections.
    pub(crate) identity: Option<TlsIdentity>,
    pub(crate) closing: Arc<AtomicBool>,
    /// Number of connections of each peer.
    pub(crate) connections: Arc<Mutex<BTreeMap<Peer, usize>>>,
    pub(crate) throttle: AuthThrottle,
}

/// Interval at which the acceptor checks for new connections and for the end of the server.
const POLL_INTERVAL: Duration = Duration::from_millis(20);

impl Acceptor {
    /// Accepts TCP connections until the server closes.
    pub(crate) fn accept_all(&self, listener: &TcpListener) {
        while !self.closing.load(Ordering::Relaxed) {
            match listener.accept() {
                Ok((stream, from)) => self.accept(stream, Peer::from_ip(from.ip())),
                Err(_) => thread::sleep(POLL_INTERVAL),
            }
        }
    }

    fn accept(&self, stream: TcpStream, peer: Peer) {
        let ready = stream
            // Some systems let an accepted socket inherit the non-blocking mode of the listener. Messages are small,
            // and without `set_nodelay` each would wait for the acknowledgement of the one before.
            .set_nonblocking(false)
            .and_then(|()| stream.set_nodelay(true))
            .and_then(|()| stream.set_read_timeout(Some(READ_TIMEOUT)))
            .and_then(|()| stream.set_write_timeout(Some(self.limits.request_timeout)));
        if ready.is_ok() {
            self.spawn_connection(peer, move |acceptor| match &acceptor.identity {
                None => acceptor.serve(Box::new(stream), peer),
                Some(identity) => acceptor.serve_secure(identity, stream, peer),
            });
        }
    }

    /// Serves a client on its own thread, unless the limit of connections is reached.
    pub(crate) fn spawn_connection(
        &self,
        peer: Peer,
        serve: impl FnOnce(&Acceptor) + Send + 'static,
    ) {
        let Some(place) = ConnectionSlot::acquire(&self.connections, peer, self.limits.connections)
        else {
            return self.log_rejection(peer, RejectReason::TooManyConnections);
        };
        let acceptor = self.clone();
        let _ = thread::Builder::new()
            .name("rpi-client".into())
            .spawn(move || {
                // Moved into the thread, so that the connection is counted until the thread ends.
                let _place = place;
                serve(&acceptor);
            });
    }

    /// Serves a client that speaks TLS; answers any other one with an error.
    fn serve_secure(&self, identity: &TlsIdentity, mut stream: TcpStream, peer: Peer) {
        match starts_tls(&stream, self.limits.request_timeout) {
            Ok(true) => {
                if let Ok(stream) = identity.accept(stream) {
                    self.serve(Box::new(stream), peer);
                }
            }
            Ok(false) => {
                // Closing a socket with unread data resets the connection, and the client would lose the answer. So the
                // request is read first.
                let _ = Head::read(&mut stream, self.limits.request_timeout);
                let _ = web::Response::error(400, TLS_REQUIRED).send(&mut stream);
            }
            Err(_) => {}
        }
    }

    fn serve(&self, mut stream: Box<dyn Stream>, peer: Peer) {
        let head = match Head::read(&mut stream, self.limits.request_timeout) {
            Ok(head) => head,
            Err(why) if why.kind() == io::ErrorKind::InvalidData => {
                let _ = web::Response::error(400, &why.to_string()).send(&mut stream);
                return;
            }
            Err(_) => return,
        };
        let _ = if !self.auth.is_same_origin(&head) {
            web::Response::error(
                403,
                "requests from pages of another origin are not allowed here",
            )
            .send(&mut stream)
        } else if let Some(why) = self.auth.check_token(&head) {
            self.reject(&mut stream, peer, why)
        } else if is_websocket_upgrade(&head) {
            return self.serve_websocket(stream, head, peer);
        } else {
            self.answer(&mut stream, &head, peer)
        };
    }

    /// Answers a request without a valid token. After a wrong token the answer is delayed, to slow down guessing.
    fn reject(&self, stream: &mut dyn Stream, peer: Peer, why: RejectReason) -> io::Result<()> {
        self.log_rejection(peer, why);
        if why == RejectReason::NoToken {
            let needed = "a token is needed: `Authorization: Bearer TOKEN`, or `?token=TOKEN`";
            return web::Response::error(401, needed).send(stream);
        }
        // A delayed answer occupies a thread. Beyond the limit of a peer, the connection is closed without an answer.
        let Some(_wait) = self.throttle.reserve_delay(peer) else {
            return Ok(());
        };
        thread::sleep(self.limits.wrong_token_delay);
        web::Response::error(401, "the token is wrong").send(stream)
    }

    /// Logs a rejected connection or request.
    fn log_rejection(&self, peer: Peer, why: RejectReason) {
        if let Some(warning) = self.throttle.record(peer, why) {
            self.state.lock().log.warn(&warning);
        }
    }

    fn answer(&self, stream: &mut dyn Stream, head: &Head, peer: Peer) -> io::Result<()> {
        let body = head.body(
            stream,
            self.limits.message_bytes,
            self.limits.request_timeout,
        );
        let response = match body {
            Ok(body) => web::respond((&self.state, peer), &self.limits, head, &body),
            Err(_) => web::Response::error(413, "the body is too long or too slow"),
        };
        response.send(stream)
    }

    fn serve_websocket(&self, mut stream: Box<dyn Stream>, head: Head, peer: Peer) {
        let (out, outgoing) = outbox(&self.limits);
        let Some(mut front) = self.handler_for(&head.path, peer, out) else {
            let _ =
                web::Response::error(404, "there is no websocket at this path").send(&mut stream);
            return;
        };
        let Some(key) = head.header("sec-websocket-key") else {
            let lacks = "a websocket needs a key (RFC 6455, section 4.1)";
            let _ = web::Response::error(400, lacks).send(&mut stream);
            return;
        };
        let accept = derive_accept_key(key.as_bytes());
        let agreed = write!(
            stream,
            "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
             Sec-WebSocket-Accept: {accept}\r\n\r\n"
        );
        if agreed.and_then(|()| stream.flush()).is_ok() {
            // No pings for DirectIO: clients of the reference system are not known to answer them.
            let silence = Some(self.limits.idle_timeout).filter(|_| head.path == "/rpc");
            let end = framing::websocket(
                stream,
                head.remaining,
                (self.limits.message_bytes, silence),
                &mut *front,
                &outgoing,
                &self.closing,
            );
            self.log_if_not_reading(end, peer);
        }
    }

    /// Logs that a client was disconnected because it does not read its messages.
    fn log_if_not_reading(&self, end: CloseReason, peer: Peer) {
        if end == CloseReason::NotReading {
            let mut state = self.state.lock();
            state.log.write(format_args!(
                "a client from {peer} is disconnected: it does not read its messages"
            ));
        }
    }

    fn handler_for(
        &self,
        path: &str,
        peer: Peer,
        out: Outbox,
    ) -> Option<Box<dyn ConnectionHandler>> {
        let shared = self.state.clone();
        match path {
            "/DirectIO" => Some(Box::new(DioConnection::new(shared, peer, out))),
            "/rpc" => Some(Box::new(RpcConnection::new(shared, peer, out, self.limits))),
            _ => None,
        }
    }
}

/// Answer to a plain request at a TLS port.
const TLS_REQUIRED: &str = "this port speaks TLS only: https:// or wss://";

/// First byte of a TLS connection: the content type of a handshake record (RFC 8446, section 5.1).
const HANDSHAKE: u8 = 22;

/// Returns whether the client starts a TLS handshake. No byte is taken from the stream.
fn starts_tls(stream: &TcpStream, timeout: Duration) -> io::Result<bool> {
    let begin = Instant::now();
    let mut first = [0];
    loop {
        match stream.peek(&mut first) {
            Ok(0) => return Err(io::ErrorKind::UnexpectedEof.into()),
            Ok(_) => return Ok(first[0] == HANDSHAKE),
            Err(e) if is_timeout(&e) && begin.elapsed() < timeout => {}
            Err(e) => return Err(e),
        }
    }
}

fn is_websocket_upgrade(head: &Head) -> bool {
    let upgrade = head.header("upgrade");
    upgrade.is_some_and(|value| value.eq_ignore_ascii_case("websocket"))
}

/// Place of a connection in the count of its peer. Dropping it decrements the count.
struct ConnectionSlot(Arc<Mutex<BTreeMap<Peer, usize>>>, Peer);

impl ConnectionSlot {
    /// Counts a connection of `peer`. Returns `None` if the limit or the share of the peer is reached.
    fn acquire(
        connections: &Arc<Mutex<BTreeMap<Peer, usize>>>,
        peer: Peer,
        limit: usize,
    ) -> Option<ConnectionSlot> {
        let mut counts = connections.lock().unwrap_or_else(PoisonError::into_inner);
        let own = counts.get(&peer).copied().unwrap_or(0);
        let taken = Usage::for_peer(counts.values().sum(), own);
        taken.admit(1, limit).ok()?;
        counts.insert(peer, own + 1);
        Some(ConnectionSlot(Arc::clone(connections), peer))
    }
}

impl Drop for ConnectionSlot {
    fn drop(&mut self) {
        let mut counts = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(own) = counts.get_mut(&self.1) {
            *own -= 1;
        }
        // Otherwise the map would grow with every address that ever connected.
        counts.retain(|_, own| *own > 0);
    }
}

#[cfg(unix)]
impl Acceptor {
    /// Accepts connections at a Unix socket until the server closes. The permissions of the socket file control access.
    pub(crate) fn accept_all_local(&self, listener: &std::os::unix::net::UnixListener) {
        while !self.closing.load(Ordering::Relaxed) {
            match listener.accept() {
                Ok((stream, _)) => self.accept_local(stream),
                Err(_) => thread::sleep(POLL_INTERVAL),
            }
        }
    }

    fn accept_local(&self, stream: std::os::unix::net::UnixStream) {
        let ready = stream
            .set_nonblocking(false)
            .and_then(|()| stream.set_read_timeout(Some(READ_TIMEOUT)))
            .and_then(|()| stream.set_write_timeout(Some(self.limits.request_timeout)));
        if ready.is_ok() {
            self.spawn_connection(Peer::Local, move |acceptor| {
                let (out, outgoing) = outbox(&acceptor.limits);
                let mut front =
                    RpcConnection::new(acceptor.state.clone(), Peer::Local, out, acceptor.limits);
                let most = acceptor.limits.message_bytes;
                let end = framing::lines(
                    Box::new(stream),
                    most,
                    &mut front,
                    &outgoing,
                    &acceptor.closing,
                );
                acceptor.log_if_not_reading(end, Peer::Local);
            });
        }
    }
}
