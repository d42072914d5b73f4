//! Accepts connections, each on its own thread, up to a limit.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use tungstenite::handshake::derive_accept_key;

use super::chat::{self, End, Front, Stream, TURN};
use super::guard::Guard;
use super::head::{Head, is_pause};
use super::outbox::{Outbox, outbox};
use super::strangers::{Strangers, Why};
use super::tls::Identity;
use crate::dio::DioFront;
use crate::fair::Taken;
use crate::limits::Limits;
use crate::peer::Peer;
use crate::rpc::RpcFront;
use crate::state::Office;
use crate::web;

/// State shared by all connections.
#[derive(Clone)]
pub(crate) struct Reception {
    pub(crate) office: Office,
    pub(crate) limits: Limits,
    pub(crate) guard: Guard,
    /// Certificate and key for TLS; `None` for plain connections.
    pub(crate) identity: Option<Identity>,
    pub(crate) closing: Arc<AtomicBool>,
    /// Number of connections of each peer.
    pub(crate) connections: Arc<Mutex<BTreeMap<Peer, usize>>>,
    pub(crate) strangers: Strangers,
}

/// Interval at which the acceptor checks for new connections and for the end of the server.
const PAUSE: Duration = Duration::from_millis(20);

impl Reception {
    /// Accepts TCP connections until the server closes.
    pub(crate) fn take_all(&self, listener: &TcpListener) {
        while !self.closing.load(Ordering::Relaxed) {
            match listener.accept() {
                Ok((stream, from)) => self.take(stream, Peer::of(from.ip())),
                Err(_) => thread::sleep(PAUSE),
            }
        }
    }

    fn take(&self, stream: TcpStream, peer: Peer) {
        let ready = stream
            .set_nonblocking(false)
            .and_then(|()| stream.set_nodelay(true))
            .and_then(|()| stream.set_read_timeout(Some(TURN)))
            .and_then(|()| stream.set_write_timeout(Some(self.limits.patience)));
        if ready.is_ok() {
            self.admit(peer, move |reception| match &reception.identity {
                None => reception.serve(Box::new(stream), peer),
                Some(identity) => reception.serve_secure(identity, stream, peer),
            });
        }
    }

    /// Serves a client on its own thread, unless the limit of connections is reached.
    pub(crate) fn admit(&self, peer: Peer, serve: impl FnOnce(&Reception) + Send + 'static) {
        let Some(place) = Place::take(&self.connections, peer, self.limits.connections) else {
            return self.note(peer, Why::Crowd);
        };
        let reception = self.clone();
        let _ = thread::Builder::new()
            .name("rpi-client".into())
            .spawn(move || {
                // Moved into the thread, so that the connection is counted until the thread ends.
                let _place = place;
                serve(&reception);
            });
    }

    /// Serves a client that speaks TLS; answers any other one with an error.
    fn serve_secure(&self, identity: &Identity, mut stream: TcpStream, peer: Peer) {
        match begins_tls(&stream, self.limits.patience) {
            Ok(true) => {
                if let Ok(stream) = identity.secure(stream) {
                    self.serve(Box::new(stream), peer);
                }
            }
            Ok(false) => {
                // Closing a socket with unread data resets the connection, and the client would lose the answer. So the
                // request is read first.
                let _ = Head::read(&mut stream, self.limits.patience);
                let _ = web::Response::refused(400, PLAIN).send(&mut stream);
            }
            Err(_) => {}
        }
    }

    fn serve(&self, mut stream: Box<dyn Stream>, peer: Peer) {
        let head = match Head::read(&mut stream, self.limits.patience) {
            Ok(head) => head,
            Err(why) if why.kind() == io::ErrorKind::InvalidData => {
                let _ = web::Response::refused(400, &why.to_string()).send(&mut stream);
                return;
            }
            Err(_) => return,
        };
        let _ = if !self.guard.is_no_stranger(&head) {
            web::Response::refused(
                403,
                "requests from pages of another origin are not allowed here",
            )
            .send(&mut stream)
        } else if let Some(why) = self.guard.lacks(&head) {
            self.turn_away(&mut stream, peer, why)
        } else if asks_for_websocket(&head) {
            return self.converse(stream, head, peer);
        } else {
            self.answer(&mut stream, &head, peer)
        };
    }

    /// Answers a request without a valid token. After a wrong token the answer is delayed, to slow down guessing.
    fn turn_away(&self, stream: &mut dyn Stream, peer: Peer, why: Why) -> io::Result<()> {
        self.note(peer, why);
        if why == Why::NoToken {
            let needed = "a token is needed: `Authorization: Bearer TOKEN`, or `?token=TOKEN`";
            return web::Response::refused(401, needed).send(stream);
        }
        let Some(_wait) = self.strangers.wait(peer) else {
            return Ok(());
        };
        thread::sleep(self.limits.penance);
        web::Response::refused(401, "the token is wrong").send(stream)
    }

    /// Logs a rejected connection or request.
    fn note(&self, peer: Peer, why: Why) {
        if let Some(told) = self.strangers.note(peer, why) {
            self.office.desk().log.warn(&told);
        }
    }

    fn answer(&self, stream: &mut dyn Stream, head: &Head, peer: Peer) -> io::Result<()> {
        let body = head.body(stream, self.limits.message, self.limits.patience);
        let response = match body {
            Ok(body) => web::respond((&self.office, peer), &self.limits, head, &body),
            Err(_) => web::Response::refused(413, "the body is too long or too slow"),
        };
        response.send(stream)
    }

    fn converse(&self, mut stream: Box<dyn Stream>, head: Head, peer: Peer) {
        let (out, outgoing) = outbox(self.limits.outbox, self.limits.watches);
        let Some(mut front) = self.front(&head.path, peer, out) else {
            let _ =
                web::Response::refused(404, "there is no websocket at this path").send(&mut stream);
            return;
        };
        let Some(key) = head.header("sec-websocket-key") else {
            let lacks = "a websocket needs a key (RFC 6455, section 4.1)";
            let _ = web::Response::refused(400, lacks).send(&mut stream);
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
            let silence = Some(self.limits.silence).filter(|_| head.path == "/rpc");
            let end = chat::websocket(
                stream,
                head.rest,
                (self.limits.message, silence),
                &mut *front,
                &outgoing,
                &self.closing,
            );
            self.note_if_deaf(end, peer);
        }
    }

    /// Logs that a client was disconnected because it does not read its messages.
    fn note_if_deaf(&self, end: End, peer: Peer) {
        if end == End::Deaf {
            let mut state = self.office.desk();
            state.log.note(format_args!(
                "a client from {peer} is disconnected: it does not read its messages"
            ));
        }
    }

    fn front(&self, path: &str, peer: Peer, out: Outbox) -> Option<Box<dyn Front>> {
        let office = self.office.clone();
        match path {
            "/DirectIO" => Some(Box::new(DioFront::new(office, peer, out))),
            "/rpc" => Some(Box::new(RpcFront::new(office, peer, out))),
            _ => None,
        }
    }
}

/// Answer to a plain request at a TLS port.
const PLAIN: &str = "this port speaks TLS only: https:// or wss://";

/// First byte of a TLS connection: the content type of a handshake record (RFC 8446, section 5.1).
const HANDSHAKE: u8 = 22;

/// Returns whether the client starts a TLS handshake. No byte is taken from the stream.
fn begins_tls(stream: &TcpStream, patience: Duration) -> io::Result<bool> {
    let begin = Instant::now();
    let mut first = [0];
    loop {
        match stream.peek(&mut first) {
            Ok(0) => return Err(io::ErrorKind::UnexpectedEof.into()),
            Ok(_) => return Ok(first[0] == HANDSHAKE),
            Err(e) if is_pause(&e) && begin.elapsed() < patience => {}
            Err(e) => return Err(e),
        }
    }
}

fn asks_for_websocket(head: &Head) -> bool {
    let upgrade = head.header("upgrade");
    upgrade.is_some_and(|value| value.eq_ignore_ascii_case("websocket"))
}

/// A counted connection. Dropping it decrements the count of its peer.
struct Place(Arc<Mutex<BTreeMap<Peer, usize>>>, Peer);

impl Place {
    /// Counts a connection of `peer`. Returns `None` if the limit or the share of the peer is reached.
    fn take(
        connections: &Arc<Mutex<BTreeMap<Peer, usize>>>,
        peer: Peer,
        limit: usize,
    ) -> Option<Place> {
        let mut counts = connections.lock().unwrap_or_else(PoisonError::into_inner);
        let own = counts.get(&peer).copied().unwrap_or(0);
        let taken = Taken::by_peer(counts.values().sum(), own);
        taken.admit(1, limit).ok()?;
        counts.insert(peer, own + 1);
        Some(Place(Arc::clone(connections), peer))
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        let mut counts = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(own) = counts.get_mut(&self.1) {
            *own -= 1;
        }
        counts.retain(|_, own| *own > 0);
    }
}

#[cfg(unix)]
impl Reception {
    /// Accepts connections at a Unix socket until the server closes. The permissions of the socket file control access.
    pub(crate) fn take_all_local(&self, listener: &std::os::unix::net::UnixListener) {
        while !self.closing.load(Ordering::Relaxed) {
            match listener.accept() {
                Ok((stream, _)) => self.take_local(stream),
                Err(_) => thread::sleep(PAUSE),
            }
        }
    }

    fn take_local(&self, stream: std::os::unix::net::UnixStream) {
        let ready = stream
            .set_nonblocking(false)
            .and_then(|()| stream.set_read_timeout(Some(TURN)))
            .and_then(|()| stream.set_write_timeout(Some(self.limits.patience)));
        if ready.is_ok() {
            self.admit(Peer::Here, move |reception| {
                let (out, outgoing) = outbox(reception.limits.outbox, reception.limits.watches);
                let mut front = RpcFront::new(reception.office.clone(), Peer::Here, out);
                let most = reception.limits.message;
                let end = chat::lines(
                    Box::new(stream),
                    most,
                    &mut front,
                    &outgoing,
                    &reception.closing,
                );
                reception.note_if_deaf(end, Peer::Here);
            });
        }
    }
}
