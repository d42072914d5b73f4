//! Server and clients for tests.

use std::io::{Read, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpStream};
use std::time::{Duration, Instant};

use rpi_core::CycleObserver;
use rpi_serve::{Server, Settings};
use rpi_sim::Cell;
use tungstenite::protocol::Role;
use tungstenite::{Message, WebSocket};

/// Timeout of every wait in tests.
pub(crate) const PATIENCE: Duration = Duration::from_secs(30);

pub(crate) const CELL: &str = "
[devices.arm]
kind = \"arm\"
model = \"kuka-lwr4+\"
enforce = [\"position\", \"velocity\"]
";

pub(crate) fn settings() -> Settings {
    Settings {
        listen: SocketAddr::from((Ipv4Addr::LOCALHOST, 0)),
        ..Settings::default()
    }
}

pub(crate) fn server(settings: &Settings, watch: impl CycleObserver + Send + 'static) -> Server {
    let cell = Cell::parse("cell.toml", CELL).unwrap_or_else(|errors| panic!("{errors}"));
    Server::open(&cell, settings, watch).unwrap()
}

pub(crate) fn open() -> Server {
    server(&settings(), ())
}

/// Websocket client.
pub(crate) struct Client {
    socket: WebSocket<TcpStream>,
    tag: u32,
    /// Received messages.
    heard: Vec<String>,
    /// Number of messages received up to and including the latest one waited for.
    before: usize,
}

impl Client {
    pub(crate) fn dio(address: SocketAddr) -> Client {
        Client::at(address, "/DirectIO/")
    }

    pub(crate) fn rpc(address: SocketAddr) -> Client {
        Client::at(address, "/rpc")
    }

    /// Connects as the client of the reference system does: without version and masking.
    pub(crate) fn at(address: SocketAddr, path: &str) -> Client {
        let stream = TcpStream::connect(address).unwrap();
        Client::over(stream, path)
    }

    fn over(mut stream: TcpStream, path: &str) -> Client {
        write!(
            stream,
            "GET {path} HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
             Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n"
        )
        .unwrap();
        let head = read_head(&mut stream);
        assert!(head.contains("101"), "{head}");
        assert!(head.contains("s3pPLMBiTxaQ9kYGzzhZRbK+xOo="), "{head}");
        stream
            .set_read_timeout(Some(Duration::from_millis(5)))
            .unwrap();
        Client {
            socket: WebSocket::from_raw_socket(stream, Role::Client, None),
            tag: 0,
            heard: Vec::new(),
            before: 0,
        }
    }

    pub(crate) fn socket_mut(&mut self) -> &mut WebSocket<TcpStream> {
        &mut self.socket
    }

    pub(crate) fn send(&mut self, text: &str) {
        self.socket.send(Message::text(text)).unwrap();
    }

    /// Waits for the first message that `wanted` accepts, among earlier ones too. Returns the result of `wanted`.
    pub(crate) fn wait<T>(&mut self, what: &str, wanted: impl Fn(&str) -> Option<T>) -> T {
        self.wait_from(0, what, wanted)
    }

    /// Waits for the first accepted message after all that were waited for before.
    pub(crate) fn wait_for_next<T>(&mut self, what: &str, wanted: impl Fn(&str) -> Option<T>) -> T {
        self.wait_from(self.before, what, wanted)
    }

    fn wait_from<T>(&mut self, from: usize, what: &str, wanted: impl Fn(&str) -> Option<T>) -> T {
        let begin = Instant::now();
        loop {
            let mut later = self.heard.iter().skip(from);
            if let Some(at) = later.position(|text| wanted(text).is_some()) {
                let at = from + at;
                self.before = at.max(self.before.saturating_sub(1));
                return wanted(&self.heard.remove(at)).unwrap();
            }
            assert!(begin.elapsed() < PATIENCE, "{what}: only {:?}", self.heard);
            if let Ok(Message::Text(text)) = self.socket.read() {
                self.heard.push(text.to_string());
            }
        }
    }

    /// Receives for this time. Returns all messages, including earlier ones.
    pub(crate) fn listen(&mut self, time: Duration) -> Vec<String> {
        let begin = Instant::now();
        while begin.elapsed() < time {
            if let Ok(Message::Text(text)) = self.socket.read() {
                self.heard.push(text.to_string());
            }
        }
        self.before = 0;
        std::mem::take(&mut self.heard)
    }

    /// Sends a DirectIO request. Returns the argument of `ok(...)` or `err(...)`.
    pub(crate) fn ask(&mut self, request: &str) -> Result<String, String> {
        self.tag += 1;
        let tag = format!("c{}", self.tag);
        self.send(&format!("{tag}={request}"));
        let text = |answer: &str, name: &str| {
            let inner = answer.strip_prefix(&format!("{tag}={name}("))?;
            Some(inner.strip_suffix(')')?.trim_matches('"').to_owned())
        };
        self.wait(request, |answer| {
            let good = text(answer, "ok").map(Ok);
            good.or_else(|| text(answer, "err").map(Err))
        })
    }

    /// Loads a net in a session. Returns its name.
    pub(crate) fn load(&mut self, session: &str, net: &str) -> String {
        let net = net.replace('\\', "\\\\").replace('"', "\\\"");
        self.ask(&format!("nene(\"{net}\",\"{session}\",\"test\",0.0,1)"))
            .unwrap()
    }
}

pub(crate) fn read_head(stream: &mut TcpStream) -> String {
    let mut head = Vec::new();
    let mut byte = [0];
    while !head.ends_with(b"\r\n\r\n") && stream.read(&mut byte).is_ok_and(|n| n == 1) {
        head.push(byte[0]);
    }
    String::from_utf8_lossy(&head).into_owned()
}

/// Sends an HTTP request. Returns the whole response.
pub(crate) fn http(address: SocketAddr, request: &str) -> String {
    let mut stream = TcpStream::connect(address).unwrap();
    stream.set_read_timeout(Some(PATIENCE)).unwrap();
    stream.write_all(request.as_bytes()).unwrap();
    let mut answer = String::new();
    let _ = stream.read_to_string(&mut answer);
    answer
}

pub(crate) fn get(address: SocketAddr, path: &str) -> String {
    http(
        address,
        &format!("GET {path} HTTP/1.1\r\nHost: localhost\r\n\r\n"),
    )
}

pub(crate) fn post(address: SocketAddr, path: &str, body: &str) -> String {
    let length = body.len();
    http(
        address,
        &format!(
            "POST {path} HTTP/1.1\r\nHost: localhost\r\nContent-Length: {length}\r\n\r\n{body}"
        ),
    )
}
