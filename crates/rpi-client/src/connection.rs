//! The connection: a thread that owns the websocket, requests that go to it, answers that come back.

use std::collections::BTreeMap;
use std::io::{ErrorKind, Read, Write};
use std::net::TcpStream;
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::thread;
use std::time::Duration;

use serde_json::{Value, json};
use tungstenite::client::IntoClientRequest;
use tungstenite::handshake::{HandshakeError, HandshakeRole};
use tungstenite::http::HeaderValue;
use tungstenite::{Message, WebSocket};

use crate::error::Error;
use crate::goal::{OnLoss, Session};

/// How long the thread listens before it looks whether there is something to send.
const TURN: Duration = Duration::from_millis(2);

/// What a conversation is held over.
pub(crate) trait Stream: Read + Write + Send {}
impl<T: Read + Write + Send> Stream for T {}

/// Takes what the server tells about a command.
pub(crate) type Listener = Sender<Value>;

/// What the thread is asked to do.
enum Order {
    Call(String, Value, Sender<Result<Value, Error>>),
    Listen(String, Listener),
}

/// A control core.
#[derive(Clone, Debug)]
pub struct Core(Sender<Order>);

impl Core {
    /// Connects to a control core at `address:port`, showing a token if it wants one.
    ///
    /// # Errors
    /// If there is none, or it does not let us in.
    pub fn connect(address: &str, token: Option<&str>) -> Result<Core, Error> {
        Core::connect_over(address, token, |stream| Ok(Box::new(stream)))
    }

    /// Connects over TLS to a control core at `address:port`, whose certificate one of those in the PEM file `authorities`
    /// must have signed, or be.
    ///
    /// # Errors
    /// If there is none, it is another than it should be, or it does not let us in.
    #[cfg(feature = "tls")]
    pub fn connect_tls(
        address: &str,
        token: Option<&str>,
        authorities: &std::path::Path,
    ) -> Result<Core, Error> {
        let secure = |stream| crate::tls::secure(stream, address, authorities);
        Core::connect_over(address, token, secure)
    }

    fn connect_over(
        address: &str,
        token: Option<&str>,
        over: impl FnOnce(TcpStream) -> Result<Box<dyn Stream>, Error>,
    ) -> Result<Core, Error> {
        let stream = TcpStream::connect(address).map_err(Error::connection)?;
        stream.set_nodelay(true).map_err(Error::connection)?;
        let options = stream.try_clone().map_err(Error::connection)?;
        let stream = over(stream)?;
        let url = format!("ws://{address}/rpc");
        let mut request = url.into_client_request().map_err(Error::connection)?;
        if let Some(token) = token {
            let shown = HeaderValue::try_from(format!("Bearer {token}"));
            let shown = shown.map_err(Error::connection)?;
            request.headers_mut().insert("Authorization", shown);
        }
        let patience = options.set_read_timeout(Some(PATIENCE));
        patience.map_err(Error::connection)?;
        let (socket, _) = tungstenite::client(request, stream).map_err(not_let_in)?;
        let turn = options.set_read_timeout(Some(TURN));
        turn.map_err(Error::connection)?;
        let (orders, todo) = channel();
        let work = move || Talk::new(socket, todo).run();
        let thread = thread::Builder::new().name("rpi-client".into());
        thread.spawn(work).map_err(Error::connection)?;
        Ok(Core(orders))
    }

    /// Calls a method of the server and waits for its result.
    ///
    /// # Errors
    /// What the server has against it, or that there is no connection.
    pub fn call(&self, method: &str, params: Value) -> Result<Value, Error> {
        let (answer, result) = channel();
        let order = Order::Call(method.to_owned(), params, answer);
        self.0.send(order).map_err(Error::connection)?;
        result.recv().map_err(Error::connection)?
    }

    /// Opens a session; `on_loss` says what becomes of its commands without us.
    ///
    /// # Errors
    /// See [`call`](Self::call).
    pub fn open_session(&self, name: &str, on_loss: OnLoss) -> Result<Session, Error> {
        let params = json!({"name": name, "on_loss": on_loss.name()});
        let opened = self.call("session.open", params)?;
        Ok(Session::new(self.clone(), &opened["session"]))
    }

    /// Emergency stop: everything is stopped at once, whoever it belongs to, and nothing can be started until it is
    /// [reset](Core::reset_emergency). `by` says who wants it, or why.
    ///
    /// # Errors
    /// If there is no connection.
    pub fn emergency_stop(&self, by: &str) -> Result<(), Error> {
        self.call("emergency.stop", json!({"by": by})).map(drop)
    }

    /// Lets commands start again after an emergency stop.
    ///
    /// # Errors
    /// While devices are still braking.
    pub fn reset_emergency(&self) -> Result<(), Error> {
        self.call("emergency.reset", json!({})).map(drop)
    }

    pub(crate) fn listen(&self, command: &str, listener: Listener) -> Result<(), Error> {
        let order = Order::Listen(command.to_owned(), listener);
        self.0.send(order).map_err(Error::connection)
    }
}

/// How long a server may take to answer when it is called.
const PATIENCE: Duration = Duration::from_secs(10);

/// Why the server does not let us in, in its own words if it has some.
fn not_let_in<R: HandshakeRole>(why: HandshakeError<R>) -> Error {
    let why = match why {
        HandshakeError::Interrupted(_) => return Error::connection("it does not answer"),
        HandshakeError::Failure(why) => why,
    };
    match why {
        tungstenite::Error::Http(answer) => {
            let words = answer.body().as_deref().unwrap_or_default();
            let words = String::from_utf8_lossy(words);
            Error::connection(format!("{}: {}", answer.status(), words.trim()))
        }
        other => Error::connection(other),
    }
}

/// The thread's side.
struct Talk {
    socket: WebSocket<Box<dyn Stream>>,
    todo: Receiver<Order>,
    last: u64,
    waiting: BTreeMap<u64, Sender<Result<Value, Error>>>,
    listeners: BTreeMap<String, Vec<Listener>>,
}

impl Talk {
    fn new(socket: WebSocket<Box<dyn Stream>>, todo: Receiver<Order>) -> Talk {
        Talk {
            socket,
            todo,
            last: 0,
            waiting: BTreeMap::new(),
            listeners: BTreeMap::new(),
        }
    }

    /// Talks until nobody needs the connection any more, or it breaks; who still waits then learns so.
    fn run(&mut self) {
        while self.send() && self.hear() {}
        let _ = self.socket.close(None);
        let _ = self.socket.flush();
    }

    fn send(&mut self) -> bool {
        loop {
            match self.todo.try_recv() {
                Ok(Order::Listen(command, listener)) => {
                    self.listeners.entry(command).or_default().push(listener);
                }
                Ok(Order::Call(method, params, answer)) => {
                    self.last += 1;
                    self.waiting.insert(self.last, answer);
                    let id = self.last;
                    let request =
                        json!({"jsonrpc": "2.0", "id": id, "method": method, "params": params});
                    if self
                        .socket
                        .send(Message::text(request.to_string()))
                        .is_err()
                    {
                        return false;
                    }
                }
                Err(TryRecvError::Empty) => return true,
                Err(TryRecvError::Disconnected) => return false,
            }
        }
    }

    fn hear(&mut self) -> bool {
        match self.socket.read() {
            Ok(Message::Text(text)) => {
                if let Ok(message) = serde_json::from_str(&text) {
                    self.take(&message);
                }
                true
            }
            Ok(Message::Close(_)) => false,
            Ok(_) => true,
            Err(tungstenite::Error::Io(e)) => {
                matches!(e.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut)
            }
            Err(_) => false,
        }
    }

    fn take(&mut self, message: &Value) {
        if message["method"] == "update" {
            let params = &message["params"];
            let about = params["command"].as_str().or(params["task"].as_str());
            let about = about.unwrap_or_default();
            if let Some(listeners) = self.listeners.get_mut(about) {
                listeners.retain(|listener| listener.send(params.clone()).is_ok());
                if listeners.is_empty() || params["state"] == "unloaded" {
                    self.listeners.remove(about);
                }
            }
            return;
        }
        let waiting = message["id"]
            .as_u64()
            .and_then(|id| self.waiting.remove(&id));
        let result = match message.get("error") {
            Some(error) => Err(Error::of(error)),
            None => Ok(message["result"].clone()),
        };
        if let Some(answer) = waiting {
            // Who has gone meanwhile does not want to know.
            let _ = answer.send(result);
        }
    }
}
