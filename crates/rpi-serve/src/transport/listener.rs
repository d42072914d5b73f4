//! Accepts connections, each on its own thread, as far as there are [places](super::places).

use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use http::{Method, StatusCode};

use super::auth::AuthPolicy;
use super::auth_throttle::{AuthThrottle, RejectReason};
use super::connection_counts::ConnectionCounts;
use super::framing::{self, CloseReason, ConnectionHandler, READ_TIMEOUT, Stream};
use super::handshake::{
    accept_websocket, finish, is_websocket_upgrade, prepare, rejection, starts_tls,
};
use super::http::{Head, RequestError};
use super::memory_pool::MemoryPool;
use super::metered_stream::MeteredStream;
use super::outbox::{Outbox, OutboxReceiver, outbox};
use super::places::{Admission, Place, Places};
use super::tls::TlsIdentity;
use crate::dio::DioConnection;
use crate::limits::Limits;
use crate::peer::Peer;
use crate::role::{Identity, Role};
use crate::rpc::RpcConnection;
use crate::state::SharedState;
use crate::web;

/// Data shared by all connections: the state, limits and policies with which connections are accepted and served.
#[derive(Clone)]
pub(crate) struct Acceptor {
    pub(crate) state: SharedState,
    pub(crate) limits: Limits,
    pub(crate) auth: AuthPolicy,
    /// Certificate and key for TLS; `None` if connections are not encrypted.
    pub(crate) identity: Option<TlsIdentity>,
    pub(crate) closing: Arc<AtomicBool>,
    /// Table of all open connections, which limits their number by kind.
    pub(crate) places: Places,
    pub(crate) throttle: AuthThrottle,
    /// Memory of the messages that are being received.
    pub(crate) incoming: MemoryPool,
    /// Memory of the messages that are queued for clients.
    pub(crate) outgoing: MemoryPool,
}

/// Time to wait between two checks for a new connection and for the end of the server.
const POLL_INTERVAL: Duration = Duration::from_millis(20);

/// Stack of a connection in bytes. With locked memory, all of it is resident from the start.
const STACK_BYTES: usize = 512 << 10;

impl Acceptor {
    /// Accepts TCP connections until the server closes.
    pub(crate) fn accept_all(&self, listener: &TcpListener) {
        while !self.closing.load(Ordering::Relaxed) {
            match listener.accept() {
                Ok((stream, from)) => self.accept(stream, Peer::from_ip(from.ip())),
                Err(_) => thread::sleep(POLL_INTERVAL),
            }
            self.places.expire();
        }
    }

    fn accept(&self, stream: TcpStream, peer: Peer) {
        let ready = prepare(&stream, self.limits.request_timeout);
        let other_end = ready.and_then(|()| stream.try_clone());
        let Ok(other_end) = other_end else {
            return;
        };
        let (place, evicted) = self.places.enter(peer, Box::new(other_end));
        if let Some(evicted) = evicted {
            self.log_rejection(evicted, RejectReason::TooManyConnections);
        }
        self.spawn(move |acceptor| match &acceptor.identity {
            None => acceptor.serve(Box::new(stream), peer, &place),
            Some(identity) => acceptor.serve_secure(identity, stream, peer, &place),
        });
    }

    /// Calls `serve` for a client on a new thread.
    fn spawn(&self, serve: impl FnOnce(&Acceptor) + Send + 'static) {
        let acceptor = self.clone();
        let _ = thread::Builder::new()
            .name("rpi-client".into())
            .stack_size(STACK_BYTES)
            .spawn(move || serve(&acceptor));
    }

    /// Serves a client at a TLS port. A client that does not speak TLS is answered with an error.
    fn serve_secure(&self, identity: &TlsIdentity, stream: TcpStream, peer: Peer, place: &Place) {
        match starts_tls(&stream, self.limits.request_timeout) {
            Ok(true) => {
                if let Ok(stream) = identity.accept(stream) {
                    self.serve(Box::new(stream), peer, place);
                }
            }
            Ok(false) => {
                let mut stream = self.metered(Box::new(stream), peer);
                // The request is read first: its answer is for a client that has sent one.
                if Head::read(&mut stream, self.limits.request_timeout).is_ok() {
                    let response = web::Response::error(StatusCode::BAD_REQUEST, TLS_REQUIRED);
                    self.finish(&mut stream, &response, false);
                }
            }
            Err(_) => {}
        }
    }

    /// Returns the stream with the memory of its incomplete messages limited.
    fn metered(&self, stream: Box<dyn Stream>, peer: Peer) -> MeteredStream {
        let memory = self.incoming.connection(peer, usize::MAX);
        MeteredStream::new(stream, memory, self.limits.idle_timeout)
    }

    fn serve(&self, stream: Box<dyn Stream>, peer: Peer, place: &Place) {
        let mut stream = self.metered(stream, peer);
        let head = match Head::read(&mut stream, self.limits.request_timeout) {
            Ok(head) => head,
            Err(RequestError::Connection(_)) => return,
            Err(RequestError::Rejected(status, reason)) => {
                let response = web::Response::error(status, reason);
                return self.finish(&mut stream, &response, false);
            }
        };
        let head_only = head.method == Method::HEAD;
        let response = match self.auth.check_page(&head) {
            Err(response) => response,
            Ok(()) => match self.auth.identify(&head, peer) {
                Ok(who) => return self.serve_client(stream, head, who, place),
                Err(why) => match self.rejection(peer, why, place) {
                    Some(response) => response,
                    None => return,
                },
            },
        };
        self.finish(&mut stream, &response, head_only);
    }

    fn finish(&self, stream: &mut MeteredStream, response: &web::Response, head_only: bool) {
        finish(stream, response, head_only, &self.limits);
    }

    /// Serves an authenticated client, which has sent the head of a request: opens a websocket or answers the request.
    fn serve_client(
        &self,
        mut stream: MeteredStream,
        head: Head,
        mut who: Identity,
        place: &Place,
    ) {
        let admission = place.admit();
        who.is_emergency_only = admission == Admission::EmergencyOnly;
        if who.is_emergency_only {
            self.log_rejection(who.peer, RejectReason::TooManyConnections);
        }
        let is_websocket = is_websocket_upgrade(&head);
        let response = match admission {
            Admission::Closed => return,
            Admission::EmergencyOnly if !is_websocket || head.path != "/rpc" => {
                web::Response::error(StatusCode::SERVICE_UNAVAILABLE, NO_PLACE)
            }
            _ if is_websocket => match self.websocket_key(&head) {
                Ok(key) => return self.serve_websocket(stream, head, &key, who),
                Err(response) => response,
            },
            _ => {
                place.limit(REQUEST_STEPS * self.limits.request_timeout);
                match self.answer(&mut stream, &head, &who) {
                    Some(response) => response,
                    None => return,
                }
            }
        };
        self.finish(&mut stream, &response, head.method == Method::HEAD);
    }

    /// Returns the response to a request without a valid token; `None` if it has none. After a wrong token the response
    /// is delayed, to slow down guessing.
    fn rejection(&self, peer: Peer, why: RejectReason, place: &Place) -> Option<web::Response> {
        self.log_rejection(peer, why);
        let delay = self.limits.wrong_token_delay;
        rejection(why, (&self.throttle, peer), delay, || place.extend(delay))
    }

    /// Logs a rejected connection or request.
    fn log_rejection(&self, peer: Peer, why: RejectReason) {
        if let Some(warning) = self.throttle.record(peer, why) {
            self.state.lock().log.warn(&warning);
        }
    }

    /// Returns the response to a request; `None` if the connection is broken.
    fn answer(
        &self,
        stream: &mut MeteredStream,
        head: &Head,
        who: &Identity,
    ) -> Option<web::Response> {
        let body = head.body(
            stream,
            self.limits.message_bytes,
            self.limits.request_timeout,
        );
        match body {
            Ok(body) => {
                let connections = ConnectionCounts::new(&self.places, &self.throttle);
                let settings = (&self.limits, &connections);
                let _turn = web::wait_for_page_turn(&self.state, &head.path);
                let response = web::respond((&self.state, who), settings, head, &body);
                let memory = self.outgoing.connection(who.peer, usize::MAX);
                Some(response.reserve(memory))
            }
            Err(RequestError::Connection(_)) => None,
            Err(RequestError::Rejected(status, reason)) => {
                Some(web::Response::error(status, reason))
            }
        }
    }

    /// Returns the key of a request for a websocket, or the response to a request that is not accepted.
    fn websocket_key(&self, head: &Head) -> Result<String, web::Response> {
        if !WEBSOCKET_PATHS.contains(&head.path.as_str()) {
            let none = "there is no websocket at this path";
            return Err(web::Response::error(StatusCode::NOT_FOUND, none));
        }
        let key = head.header("sec-websocket-key");
        key.map(str::to_owned).ok_or_else(|| {
            let lacks = "a websocket needs a key (RFC 6455, section 4.1)";
            web::Response::error(StatusCode::BAD_REQUEST, lacks)
        })
    }

    fn serve_websocket(&self, mut stream: MeteredStream, head: Head, key: &str, who: Identity) {
        let (out, outgoing) = self.outbox(who.peer);
        let peer = who.peer;
        let is_rpc = head.path == RPC_PATH;
        let mut front: Box<dyn ConnectionHandler> = match is_rpc {
            true => Box::new(RpcConnection::new(
                self.state.clone(),
                who,
                out,
                self.limits,
            )),
            false => Box::new(DioConnection::new(
                self.state.clone(),
                who,
                out,
                &self.limits,
            )),
        };
        if accept_websocket(&mut stream, key, None).is_ok() {
            // No pings for DirectIO: clients of the reference system are not known to answer them.
            let silence = Some(self.limits.idle_timeout).filter(|_| is_rpc);
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

    fn outbox(&self, peer: Peer) -> (Outbox, OutboxReceiver) {
        let memory = self.outgoing.connection(peer, self.limits.queued_bytes);
        outbox(&self.limits, memory)
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
}

/// Path of the websocket of DirectIO.
const DIRECTIO_PATH: &str = "/DirectIO";
/// Path of the websocket of JSON-RPC.
const RPC_PATH: &str = "/rpc";
/// Paths of all websockets.
const WEBSOCKET_PATHS: &[&str] = &[DIRECTIO_PATH, RPC_PATH];

/// Number of steps of a request with a time limit each: its body, its execution, its response, and its end.
const REQUEST_STEPS: u32 = 4;

/// Error answer to a client for which no connection is left, except one for an emergency stop.
const NO_PLACE: &str =
    "there is no place for another client; the websocket /rpc still accepts `emergency.stop`";

/// Error answer to an unencrypted request at a TLS port.
const TLS_REQUIRED: &str = "this port speaks TLS only: https:// or wss://";

#[cfg(unix)]
impl Acceptor {
    /// Accepts connections at a Unix socket until the server closes. The permissions of the socket file control who may
    /// connect; all clients of the socket have its role.
    pub(crate) fn accept_all_local(&self, listener: &std::os::unix::net::UnixListener, role: Role) {
        while !self.closing.load(Ordering::Relaxed) {
            match listener.accept() {
                Ok((stream, _)) => self.accept_local(stream, role),
                Err(_) => thread::sleep(POLL_INTERVAL),
            }
        }
    }

    fn accept_local(&self, stream: std::os::unix::net::UnixStream, role: Role) {
        let ready = stream
            .set_nonblocking(false)
            .and_then(|()| stream.set_read_timeout(Some(READ_TIMEOUT)))
            .and_then(|()| stream.set_write_timeout(Some(self.limits.request_timeout)));
        let Ok(other_end) = ready.and_then(|()| stream.try_clone()) else {
            return;
        };
        let (place, admission) = self.places.enter_socket(Box::new(other_end));
        let mut who = Identity::unnamed(Peer::Local, role);
        who.is_emergency_only = admission == Admission::EmergencyOnly;
        if who.is_emergency_only {
            self.log_rejection(Peer::Local, RejectReason::TooManyConnections);
        }
        self.spawn(move |acceptor| {
            // Moved into the thread, so that the connection has its place until the thread ends.
            let _place = place;
            acceptor.serve_lines(stream, who);
        });
    }

    fn serve_lines(&self, stream: std::os::unix::net::UnixStream, who: Identity) {
        let (out, outgoing) = self.outbox(Peer::Local);
        let mut front = RpcConnection::new(self.state.clone(), who, out, self.limits);
        let most = self.limits.message_bytes;
        let stream = self.metered(Box::new(stream), Peer::Local);
        let end = framing::lines(stream, most, &mut front, &outgoing, &self.closing);
        self.log_if_not_reading(end, Peer::Local);
    }
}
