//! Sends the program to the controller, in a thread of its own: a port that does not answer must not delay the exchange.

use super::UrSpec;
use super::session::connect;
use std::io::{self, Read, Write};
use std::net::TcpStream;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::sync::{Arc, PoisonError, RwLock};
use std::thread;
use std::time::{Duration, Instant};

/// Time for which the connection stays open after the program was sent, unless the program runs earlier.
const OPEN_TIME: Duration = Duration::from_secs(2);

/// State of the transmission of a program.
#[derive(Debug)]
pub(super) enum UploadState {
    /// The controller has not accepted the connection yet.
    Connecting,
    /// The program was sent. The connection is open, so that the end of it does not reset the port before the program starts.
    Sent,
    /// The thread has ended: the program did not start in time.
    Over,
    Failed(io::Error),
}

/// Transmission of a program. Dropping it closes the connection, and prevents that the program is sent later.
pub(super) struct Upload {
    results: Receiver<io::Result<()>>,
    is_sent: bool,
    /// True if the program must not be sent any more. The thread sends it with a lock for reading.
    is_cancelled: Arc<RwLock<bool>>,
    is_over: Arc<AtomicBool>,
}

impl Upload {
    /// Starts the thread.
    ///
    /// # Errors
    /// Returns the error of the system that creates the thread.
    pub(super) fn start(spec: &UrSpec, text: String) -> io::Result<Self> {
        let (sender, results) = channel();
        let upload = Self {
            results,
            is_sent: false,
            is_cancelled: Arc::default(),
            is_over: Arc::default(),
        };
        let is_cancelled = Arc::clone(&upload.is_cancelled);
        let is_over = Arc::clone(&upload.is_over);
        let (host, port) = (spec.host.clone(), spec.script_port);
        let run = move || {
            let sent = send(&host, port, &text, &is_cancelled);
            if let Some(stream) = report(sent, &sender) {
                drain(stream, &is_over);
            }
        };
        let thread = thread::Builder::new().name("rpi-rtde-upload".into());
        thread.spawn(run)?;
        Ok(upload)
    }

    /// Returns the state of the transmission.
    pub(super) fn state(&mut self) -> UploadState {
        match self.results.try_recv() {
            Ok(Ok(())) => {
                self.is_sent = true;
                UploadState::Sent
            }
            Ok(Err(error)) => UploadState::Failed(error),
            Err(TryRecvError::Disconnected) => UploadState::Over,
            Err(TryRecvError::Empty) if self.is_sent => UploadState::Sent,
            Err(TryRecvError::Empty) => UploadState::Connecting,
        }
    }
}

impl Drop for Upload {
    fn drop(&mut self) {
        // Never waits: if the thread holds the lock, it sends at this moment.
        if let Ok(mut is_cancelled) = self.is_cancelled.try_write() {
            *is_cancelled = true;
        }
        self.is_over.store(true, Ordering::Relaxed);
    }
}

/// Connects and sends the program. Returns `None` if the transmission was cancelled before.
fn send(
    host: &str,
    port: u16,
    text: &str,
    is_cancelled: &RwLock<bool>,
) -> io::Result<Option<TcpStream>> {
    let mut stream = connect(host, port)?;
    let lock = is_cancelled.read().unwrap_or_else(PoisonError::into_inner);
    if *lock {
        return Ok(None);
    }
    stream.write_all(text.as_bytes())?;
    stream.set_read_timeout(Some(Duration::from_millis(20)))?;
    Ok(Some(stream))
}

/// Reports the result. Returns the connection over which the program was sent.
fn report(
    sent: io::Result<Option<TcpStream>>,
    sender: &Sender<io::Result<()>>,
) -> Option<TcpStream> {
    // The receiver is gone if the transmission was cancelled.
    let (result, stream) = match sent {
        Ok(stream) => (Ok(()), stream),
        Err(error) => (Err(error), None),
    };
    let _ = sender.send(result);
    stream
}

/// Reads what the controller sends to the port of programs until the program runs: closing a connection with unread bytes
/// resets it, and a program that has not arrived is lost.
fn drain(mut stream: TcpStream, is_over: &AtomicBool) {
    let limit = Instant::now() + OPEN_TIME;
    let mut bytes = [0; 4096];
    while Instant::now() < limit && !is_over.load(Ordering::Relaxed) {
        match stream.read(&mut bytes) {
            Ok(1..) => {}
            Err(error)
                if matches!(
                    error.kind(),
                    io::ErrorKind::WouldBlock
                        | io::ErrorKind::TimedOut
                        | io::ErrorKind::Interrupted
                ) => {}
            // Closed by the controller.
            _ => return,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::net::TcpListener;

    fn spec(port: u16) -> UrSpec {
        UrSpec {
            host: "127.0.0.1".to_owned(),
            rtde_port: 1,
            script_port: port,
            timeout: 0.1,
            lookahead: 0.1,
            gain: 300.0,
        }
    }

    /// Waits until the transmission has another state than this.
    fn wait(upload: &mut Upload) -> UploadState {
        loop {
            match upload.state() {
                UploadState::Connecting => thread::sleep(Duration::from_millis(1)),
                state => return state,
            }
        }
    }

    #[test]
    fn a_program_is_sent_and_the_connection_stays_open_until_the_end() {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let port = listener.local_addr().expect("bound").port();
        let mut upload = Upload::start(&spec(port), "def p():\nend\n".to_owned()).expect("started");
        let (mut stream, _) = listener.accept().expect("a client");
        let mut text = [0; 13];
        stream.read_exact(&mut text).expect("the program");
        assert_eq!(&text, b"def p():\nend\n");
        assert!(matches!(wait(&mut upload), UploadState::Sent));
        stream.set_nonblocking(true).expect("set");
        assert!(stream.read(&mut text).is_err(), "still open");
        stream.set_nonblocking(false).expect("set");
        drop(upload);
        assert_eq!(stream.read(&mut text).expect("closed"), 0);
    }

    #[test]
    fn a_port_that_rejects_is_reported_and_a_cancelled_program_is_not_sent() {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let port = listener.local_addr().expect("bound").port();
        let cancelled = RwLock::new(true);
        assert!(
            send("127.0.0.1", port, "x", &cancelled)
                .expect("connected")
                .is_none()
        );
        drop(listener);
        let mut upload = Upload::start(&spec(port), String::new()).expect("started");
        assert!(matches!(wait(&mut upload), UploadState::Failed(_)));
    }
}
