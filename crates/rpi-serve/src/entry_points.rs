//! Entry points for messages of clients as functions from bytes, for fuzzers. Only with the feature `entry-points`.
//!
//! All of them use one server in this process, without a thread per client: the messages are handled on the calling
//! thread, so that their time and memory can be measured. The client is an operator, who can load nothing: the compiler
//! has entry points of its own.

use std::io::{self, Read, Write};
use std::net::{Ipv4Addr, SocketAddr};
use std::sync::OnceLock;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use http::Method;
use rpi_sim::Cell;

use crate::client_token::ClientToken;
use crate::dio::DioConnection;
use crate::limits::Limits;
use crate::peer::Peer;
use crate::role::{Identity, Role};
use crate::rpc::RpcConnection;
use crate::server::Server;
use crate::settings::Settings;
use crate::state::SharedState;
use crate::transport::{
    AuthPolicy, AuthThrottle, ConnectionCounts, ConnectionHandler, Head, MemoryPool, MeteredStream,
    Outbox, OutboxReceiver, Places, RequestError, Stream, framing, outbox,
};
use crate::web;

/// Time limit of reads from bytes in memory, which need none.
const TIMEOUT: Duration = Duration::from_secs(60);

/// Cell of the server: devices that messages can name.
const CELL: &str = "[devices.arm]\nkind = \"arm\"\nmodel = \"kuka-lwr4+\"\n";

/// Stream from a client that has sent these bytes and reads everything.
struct Bytes(io::Cursor<Vec<u8>>);

impl Read for Bytes {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.0.read(buffer)
    }
}

impl Write for Bytes {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Stream for Bytes {
    fn end_writing(&mut self) {}
}

fn stream(input: &[u8]) -> MeteredStream {
    let memory = MemoryPool::new(Limits::default().memory.incoming);
    let memory = memory.connection(Peer::Local, usize::MAX);
    let bytes = Bytes(io::Cursor::new(input.to_vec()));
    MeteredStream::new(Box::new(bytes), memory, TIMEOUT)
}

/// Returns the state of the server, which runs from the first call to the end of the process.
///
/// # Panics
/// If the server cannot be opened.
fn state() -> &'static SharedState {
    static SERVER: OnceLock<(Server, SharedState)> = OnceLock::new();
    let (_, state) = SERVER.get_or_init(|| {
        let settings = Settings {
            listen: SocketAddr::from((Ipv4Addr::LOCALHOST, 0)),
            // The cycle is not under test, and needs the processor.
            tick_ns: 100_000_000,
            ..Settings::default()
        };
        let server = Cell::parse("cell.toml", CELL)
            .map_err(|errors| errors.to_string())
            .and_then(|cell| Server::open(&cell, &settings, ()).map_err(|e| e.to_string()));
        let server = server.unwrap_or_else(|error| panic!("{error}"));
        let state = server.shared().expect("the server is open");
        (server, state)
    });
    state
}

fn operator() -> Identity {
    Identity::unnamed(Peer::Local, Role::Operator)
}

/// Returns the queue of messages to a client.
fn queue() -> (Outbox, OutboxReceiver) {
    let limits = Limits::default();
    let memory = MemoryPool::new(limits.memory.outgoing);
    outbox(&limits, memory.connection(Peer::Local, limits.queued_bytes))
}

/// Reads a request over HTTP with its body, checks its token and its origin, and answers it. Pages are answered; requests
/// that change the server are not.
pub fn http(input: &[u8]) {
    let mut stream = stream(input);
    let limits = Limits::default();
    let head = match Head::read(&mut stream, TIMEOUT) {
        Ok(head) => head,
        Err(error) => return drop(error.to_string()),
    };
    let token = ClientToken::new("fuzzer", Role::Operator, "a-secret");
    for tokens in [Vec::new(), vec![token]] {
        let policy = AuthPolicy {
            tokens,
            origins: Vec::new(),
        };
        let _ = policy.is_own_host(&head) && policy.is_same_origin(&head);
        let _ = policy.identify(&head, Peer::Local);
    }
    let body = match head.body(&mut stream, limits.message_bytes, TIMEOUT) {
        Ok(body) => body,
        Err(RequestError::Connection(error)) => panic!("the stream has no errors: {error}"),
        Err(RequestError::Rejected(..)) => return,
    };
    assert!(body.len() <= input.len(), "the body is a part of the input");
    web::parse_form(&body);
    if head.method != Method::POST {
        let places = Places::new(limits);
        let counts = ConnectionCounts::new(&places, &AuthThrottle::default());
        let response = web::respond((state(), &operator()), (&limits, &counts), &head, &body);
        // The stream takes every byte.
        let _ = response.send(&mut stream, head.method == Method::HEAD);
    }
}

/// Handles the lines of a client at a Unix socket: requests of JSON-RPC.
pub fn lines(input: &[u8]) {
    let (out, outgoing) = queue();
    let limits = Limits::default();
    let mut client = RpcConnection::new(state().clone(), operator(), out, limits);
    let most = limits.message_bytes;
    framing::lines(
        stream(input),
        most,
        &mut client,
        &outgoing,
        &AtomicBool::new(false),
    );
}

/// Handles the frames of a client at the websocket of JSON-RPC.
pub fn websocket(input: &[u8]) {
    let (out, outgoing) = queue();
    let limits = Limits::default();
    let mut client = RpcConnection::new(state().clone(), operator(), out, limits);
    framing::websocket(
        stream(input),
        Vec::new(),
        (limits.message_bytes, None),
        &mut client,
        &outgoing,
        &AtomicBool::new(false),
    );
}

/// Handles a message of DirectIO.
pub fn directio(input: &[u8]) {
    let (out, _outgoing) = queue();
    let mut client = DioConnection::new(state().clone(), operator(), out, &Limits::default());
    client.on_message(&String::from_utf8_lossy(input));
}
