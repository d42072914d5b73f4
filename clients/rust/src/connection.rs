//! Connection to a control core: a thread owns the websocket, sends requests and distributes answers and updates.

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

use crate::device_info::DeviceInfo;
use crate::error::Error;
use crate::goal::{OnLoss, Session};
use crate::identity::Identity;

/// Read timeout of the websocket. The connection thread waits so long for a message before it sends pending requests.
const READ_TIMEOUT: Duration = Duration::from_millis(2);

/// Transport of a connection: a plain TCP or a TLS stream.
pub(crate) trait Stream: Read + Write + Send {}
impl<T: Read + Write + Send> Stream for T {}

/// Channel to which the connection thread sends the updates of a command or task.
pub(crate) type UpdateSender = Sender<Value>;

/// Message to the connection thread: a call of a method of the server, or a registration for the updates of a command
/// or task.
enum WorkerRequest {
    Call(String, Value, Sender<Result<Value, Error>>),
    Listen(String, UpdateSender),
}

/// Connection to a control core. Clones share the connection.
#[derive(Clone, Debug)]
pub struct Client(Sender<WorkerRequest>);

impl Client {
    /// Connects to the control core at `address` (`host:port`), with a token if the server requires one.
    ///
    /// # Errors
    /// Returns an error if the connection fails or the server rejects it.
    pub fn connect(address: &str, token: Option<&str>) -> Result<Client, Error> {
        Client::connect_over(address, token, |stream| Ok(Box::new(stream)))
    }

    /// Connects over TLS to the control core at `address` (`host:port`). The certificate of the server must be in the
    /// PEM file `authorities`, or be signed by one in it.
    ///
    /// # Errors
    /// Returns an error if the connection fails, the certificate is not valid, or the server rejects the connection.
    #[cfg(feature = "tls")]
    pub fn connect_tls(
        address: &str,
        token: Option<&str>,
        authorities: &std::path::Path,
    ) -> Result<Client, Error> {
        let secure = |stream| crate::tls::connect(stream, address, authorities);
        Client::connect_over(address, token, secure)
    }

    fn connect_over(
        address: &str,
        token: Option<&str>,
        over: impl FnOnce(TcpStream) -> Result<Box<dyn Stream>, Error>,
    ) -> Result<Client, Error> {
        let stream = TcpStream::connect(address).map_err(Error::connection)?;
        stream.set_nodelay(true).map_err(Error::connection)?;
        // A second handle of the socket, for changing its read timeout once the stream is wrapped.
        let options = stream.try_clone().map_err(Error::connection)?;
        let stream = over(stream)?;
        let url = format!("ws://{address}/rpc");
        let mut request = url.into_client_request().map_err(Error::connection)?;
        if let Some(token) = token {
            let shown = HeaderValue::try_from(format!("Bearer {token}"));
            let shown = shown.map_err(Error::connection)?;
            request.headers_mut().insert("Authorization", shown);
        }
        let limited = options.set_read_timeout(Some(HANDSHAKE_TIMEOUT));
        limited.map_err(Error::connection)?;
        let (socket, _) = tungstenite::client(request, stream).map_err(handshake_error)?;
        let turn = options.set_read_timeout(Some(READ_TIMEOUT));
        turn.map_err(Error::connection)?;
        let (orders, todo) = channel();
        let work = move || Worker::new(socket, todo).run();
        let thread = thread::Builder::new().name("rpi-client".into());
        thread.spawn(work).map_err(Error::connection)?;
        Ok(Client(orders))
    }

    /// Calls a method of the server and waits for its result.
    ///
    /// # Errors
    /// Returns an error if the server rejects the request or the connection is closed.
    pub fn call(&self, method: &str, params: Value) -> Result<Value, Error> {
        let (answer, result) = channel();
        let order = WorkerRequest::Call(method.to_owned(), params, answer);
        self.0.send(order).map_err(Error::connection)?;
        result.recv().map_err(Error::connection)?
    }

    /// Returns the devices of the server's cell.
    ///
    /// # Errors
    /// Returns an error if the connection is closed.
    pub fn devices(&self) -> Result<Vec<DeviceInfo>, Error> {
        let answer = self.call("device.list", Value::Null)?;
        let devices = answer["devices"].as_array().into_iter().flatten();
        Ok(devices.map(DeviceInfo::from_json).collect())
    }

    /// Opens a session, which owns the commands and tasks that are loaded in it. `on_loss` is the policy for its
    /// commands when the connection ends.
    ///
    /// # Errors
    /// Returns an error like [`call`](Self::call).
    pub fn open_session(&self, name: &str, on_loss: OnLoss) -> Result<Session, Error> {
        let params = json!({"name": name, "on_loss": on_loss.name()});
        let opened = self.call("session.open", params)?;
        Ok(Session::new(self.clone(), &opened["session"]))
    }

    /// Returns the identity of this client as the server sees it: the name of its token, its role and its rights.
    ///
    /// # Errors
    /// Returns an error if the connection is closed.
    pub fn identity(&self) -> Result<Identity, Error> {
        let described = self.call("client.describe", json!({}))?;
        Ok(Identity::from_json(&described))
    }

    /// Emergency stop: stops all commands of all clients at once. No command can be started until the
    /// [reset](Client::reset_emergency). `by` names the person who requested the stop, or the reason.
    ///
    /// # Errors
    /// Returns an error if the connection is closed.
    pub fn emergency_stop(&self, by: &str) -> Result<(), Error> {
        self.call("emergency.stop", json!({"by": by})).map(drop)
    }

    /// Resets an emergency stop, so that commands can be started again.
    ///
    /// # Errors
    /// Returns an error if devices are still braking, or if the operator requested the stop and the role of this client
    /// is neither `operator` nor `admin`.
    pub fn reset_emergency(&self) -> Result<(), Error> {
        self.call("emergency.reset", json!({})).map(drop)
    }

    /// Sets the speed override of all motions of the library: the share of the programmed speed, from 0 to 1.
    ///
    /// # Errors
    /// Returns an error if the share is not from 0 to 1, or the connection is closed.
    pub fn set_override(&self, share: f64) -> Result<(), Error> {
        let params = json!({"override": share});
        self.call("motion.set", params).map(drop)
    }

    /// Pauses all motions of the library on their paths (`true`), or lets them continue (`false`).
    ///
    /// # Errors
    /// Returns an error if the connection is closed.
    pub fn set_paused(&self, paused: bool) -> Result<(), Error> {
        self.call("motion.set", json!({"paused": paused})).map(drop)
    }

    pub(crate) fn listen(&self, command: &str, listener: UpdateSender) -> Result<(), Error> {
        let order = WorkerRequest::Listen(command.to_owned(), listener);
        self.0.send(order).map_err(Error::connection)
    }
}

/// Maximum time in which the server must respond to the websocket handshake.
const HANDSHAKE_TIMEOUT: Duration = Duration::from_secs(10);

/// Converts a failed websocket handshake to an error, with the message of the server if it sent one.
fn handshake_error<R: HandshakeRole>(why: HandshakeError<R>) -> Error {
    let why = match why {
        HandshakeError::Interrupted(_) => return Error::connection("the server does not answer"),
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

/// State of the connection thread: the websocket, the requests that wait for a response, and the channels for updates.
struct Worker {
    socket: WebSocket<Box<dyn Stream>>,
    requests: Receiver<WorkerRequest>,
    last_id: u64,
    pending: BTreeMap<u64, Sender<Result<Value, Error>>>,
    listeners: BTreeMap<String, Vec<UpdateSender>>,
}

impl Worker {
    fn new(socket: WebSocket<Box<dyn Stream>>, todo: Receiver<WorkerRequest>) -> Worker {
        Worker {
            socket,
            requests: todo,
            last_id: 0,
            pending: BTreeMap::new(),
            listeners: BTreeMap::new(),
        }
    }

    /// Sends requests and receives messages until every handle of the connection is dropped or the connection breaks.
    /// Pending calls then return an error.
    fn run(&mut self) {
        while self.send() && self.receive() {}
        let _ = self.socket.close(None);
        let _ = self.socket.flush();
    }

    fn send(&mut self) -> bool {
        loop {
            match self.requests.try_recv() {
                Ok(WorkerRequest::Listen(command, listener)) => {
                    self.listeners.entry(command).or_default().push(listener);
                }
                Ok(WorkerRequest::Call(method, params, answer)) => {
                    self.last_id += 1;
                    self.pending.insert(self.last_id, answer);
                    let id = self.last_id;
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

    fn receive(&mut self) -> bool {
        match self.socket.read() {
            Ok(Message::Text(text)) => {
                if let Ok(message) = serde_json::from_str(&text) {
                    self.dispatch(&message);
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

    fn dispatch(&mut self, message: &Value) {
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
            .and_then(|id| self.pending.remove(&id));
        let result = match message.get("error") {
            Some(error) => Err(Error::from_json(error)),
            None => Ok(message["result"].clone()),
        };
        if let Some(answer) = waiting {
            // The send fails if the caller is gone, which is no error.
            let _ = answer.send(result);
        }
    }
}
