//! Taking connections: one thread for each, at most so many at a time.

use std::io::{self, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use tungstenite::handshake::derive_accept_key;

use super::chat::{self, Front, Stream, TURN};
use super::guard::Guard;
use super::head::{Head, is_pause};
use super::outbox::{Outbox, outbox};
use super::tls::Identity;
use crate::desk::Office;
use crate::dio::DioFront;
use crate::limits::Limits;
use crate::rpc::RpcFront;
use crate::web;

/// What every connection needs.
#[derive(Clone)]
pub(crate) struct Reception {
    pub(crate) office: Office,
    pub(crate) limits: Limits,
    pub(crate) guard: Guard,
    /// Without it, connections are plain.
    pub(crate) identity: Option<Identity>,
    pub(crate) closing: Arc<AtomicBool>,
    pub(crate) connections: Arc<AtomicUsize>,
}

/// How long to wait for the next connection before looking whether the server closes.
const PAUSE: Duration = Duration::from_millis(20);

impl Reception {
    /// Takes connections until the server closes.
    pub(crate) fn take_all(&self, listener: &TcpListener) {
        while !self.closing.load(Ordering::Relaxed) {
            match listener.accept() {
                Ok((stream, _)) => self.take(stream),
                Err(_) => thread::sleep(PAUSE),
            }
        }
    }

    fn take(&self, stream: TcpStream) {
        let ready = stream
            .set_nonblocking(false)
            .and_then(|()| stream.set_nodelay(true))
            .and_then(|()| stream.set_read_timeout(Some(TURN)))
            .and_then(|()| stream.set_write_timeout(Some(self.limits.patience)));
        if ready.is_ok() {
            self.admit(move |reception| match &reception.identity {
                None => reception.serve(Box::new(stream)),
                Some(identity) => reception.serve_secure(identity, stream),
            });
        }
    }

    /// Serves a client on a thread of its own, unless there are too many.
    pub(crate) fn admit(&self, serve: impl FnOnce(&Reception) + Send + 'static) {
        let count = self.connections.fetch_add(1, Ordering::Relaxed);
        let place = Place(Arc::clone(&self.connections));
        if count >= self.limits.connections {
            return;
        }
        let reception = self.clone();
        let _ = thread::Builder::new()
            .name("rpi-client".into())
            .spawn(move || {
                let _place = place;
                serve(&reception);
            });
    }

    /// Serves who speaks TLS; tells others that they should.
    fn serve_secure(&self, identity: &Identity, mut stream: TcpStream) {
        match begins_tls(&stream, self.limits.patience) {
            Ok(true) => {
                if let Ok(stream) = identity.secure(stream) {
                    self.serve(Box::new(stream));
                }
            }
            Ok(false) => {
                // What came is read first: a connection that is closed before is reset, and the answer with it.
                let _ = Head::read(&mut stream, self.limits.patience);
                let _ = web::Response::refused(400, PLAIN).send(&mut stream);
            }
            Err(_) => {}
        }
    }

    fn serve(&self, mut stream: Box<dyn Stream>) {
        let Ok(head) = Head::read(&mut stream, self.limits.patience) else {
            return;
        };
        let done = match self.refusal(&head) {
            Some(refusal) => refusal.send(&mut stream),
            None if asks_for_websocket(&head) => return self.converse(stream, head),
            None => self.answer(&mut stream, &head),
        };
        let _ = done;
    }

    fn refusal(&self, head: &Head) -> Option<web::Response> {
        if !self.guard.is_no_stranger(head) {
            return Some(web::Response::refused(
                403,
                "pages from elsewhere may not come in",
            ));
        }
        let lacking = self.guard.lacks(head)?;
        Some(web::Response::refused(401, lacking))
    }

    fn answer(&self, stream: &mut dyn Stream, head: &Head) -> io::Result<()> {
        let body = head.body(stream, self.limits.message, self.limits.patience);
        let response = match body {
            Ok(body) => web::respond(&self.office, &self.limits, head, &body),
            Err(_) => web::Response::refused(413, "the body is too long or too slow"),
        };
        response.send(stream)
    }

    fn converse(&self, mut stream: Box<dyn Stream>, head: Head) {
        let (out, outgoing) = outbox(self.limits.outbox, self.limits.watches);
        let Some(mut front) = self.front(&head.path, out) else {
            let _ = web::Response::refused(404, "no conversation is held here").send(&mut stream);
            return;
        };
        let key = head.header("sec-websocket-key").unwrap_or_default();
        let accept = derive_accept_key(key.as_bytes());
        let agreed = write!(
            stream,
            "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
             Sec-WebSocket-Accept: {accept}\r\n\r\n"
        );
        if agreed.and_then(|()| stream.flush()).is_ok() {
            // The reference system's clients are not known to answer pings.
            let silence = Some(self.limits.silence).filter(|_| head.path == "/rpc");
            chat::websocket(
                stream,
                head.rest,
                (self.limits.message, silence),
                &mut *front,
                &outgoing,
                &self.closing,
            );
        }
    }

    fn front(&self, path: &str, out: Outbox) -> Option<Box<dyn Front>> {
        match path {
            "/DirectIO" => Some(Box::new(DioFront::new(self.office.clone(), out))),
            "/rpc" => Some(Box::new(RpcFront::new(self.office.clone(), out))),
            _ => None,
        }
    }
}

/// What who does not speak TLS is told.
const PLAIN: &str = "this port speaks TLS only: https:// or wss://";

/// The first byte of what a TLS client says: a record of a handshake (RFC 8446, section 5.1).
const HANDSHAKE: u8 = 22;

/// Whether the client begins to shake hands for TLS; nothing is taken from the stream.
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

/// One of the places that there are for connections.
struct Place(Arc<AtomicUsize>);

impl Drop for Place {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}

#[cfg(unix)]
impl Reception {
    /// Takes connections at a Unix socket until the server closes. Who may open the socket's file may come in.
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
            self.admit(move |reception| {
                let (out, outgoing) = outbox(reception.limits.outbox, reception.limits.watches);
                let mut front = RpcFront::new(reception.office.clone(), out);
                let most = reception.limits.message;
                chat::lines(
                    Box::new(stream),
                    most,
                    &mut front,
                    &outgoing,
                    &reception.closing,
                );
            });
        }
    }
}
