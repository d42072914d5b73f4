//! The process of a guard, with its output and its control core.

use std::io::{BufRead, BufReader, Read, Write};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

/// Time until a process must have reached a state; no test asserts a shorter one.
const TIMEOUT: Duration = Duration::from_secs(60);

/// Running `rpi`, killed by the end of the test.
pub(crate) struct Process {
    child: Child,
    output: Arc<Mutex<String>>,
    readers: Vec<std::thread::JoinHandle<()>>,
}

impl Process {
    /// Starts the tool with these arguments and variables.
    pub(crate) fn start(arguments: &[&str], variables: &[(&str, &str)]) -> Process {
        let mut child = Command::new(env!("CARGO_BIN_EXE_rpi"))
            .args(arguments)
            .envs(variables.iter().copied())
            .env("NO_COLOR", "1")
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let output = Arc::<Mutex<String>>::default();
        let streams: [Box<dyn Read + Send>; 2] = [
            Box::new(child.stdout.take().unwrap()),
            Box::new(child.stderr.take().unwrap()),
        ];
        let read = |stream: Box<dyn Read + Send>| {
            let text = Arc::clone(&output);
            std::thread::spawn(move || {
                for line in BufReader::new(stream).lines().map_while(Result::ok) {
                    *text.lock().unwrap() += &format!("{line}\n");
                }
            })
        };
        let readers = streams.into_iter().map(read).collect();
        Process {
            child,
            output,
            readers,
        }
    }

    /// Returns the number of the guard.
    pub(crate) fn id(&self) -> u32 {
        self.child.id()
    }

    /// Returns all output so far.
    pub(crate) fn text(&self) -> String {
        self.output.lock().unwrap().clone()
    }

    /// Waits until the output contains a text this many times.
    pub(crate) fn wait_for(&self, text: &str, times: usize) {
        wait_until(
            || self.text().matches(text).count() >= times,
            || self.text(),
        );
    }

    /// Waits for the control core of the guard, other than `previous`, and returns the number of its process.
    pub(crate) fn core(&self, previous: Option<u32>) -> u32 {
        let id = self.id();
        let mut core = None;
        wait_until(
            || {
                let children = std::fs::read_to_string(format!("/proc/{id}/task/{id}/children"));
                let children = children.unwrap_or_default();
                let first = children.split_whitespace().next();
                core = first.and_then(|child| child.parse().ok());
                core.is_some() && core != previous
            },
            || format!("no core: {}", self.text()),
        );
        core.unwrap()
    }

    /// Waits for the end of the guard. Returns its exit status and all output.
    pub(crate) fn end(mut self) -> (Option<i32>, String) {
        let mut status = None;
        let (child, output) = (&mut self.child, &self.output);
        wait_until(
            || {
                status = child.try_wait().unwrap();
                status.is_some()
            },
            || output.lock().unwrap().clone(),
        );
        for reader in self.readers.drain(..) {
            reader.join().unwrap();
        }
        (status.unwrap().code(), self.text())
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        // The control core ends when its guard has ended.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Sends a signal to a process.
pub(crate) fn signal(process: u32, signal: &str) {
    let status = Command::new("kill")
        .args([signal, &process.to_string()])
        .status();
    assert!(status.unwrap().success());
}

/// Waits until a condition holds. A panic at the end of the time has the text of `state`.
pub(crate) fn wait_until(mut condition: impl FnMut() -> bool, state: impl FnOnce() -> String) {
    let begin = Instant::now();
    while !condition() {
        if begin.elapsed() >= TIMEOUT {
            panic!("{}", state());
        }
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// Waits until a recording has this number of bytes.
pub(crate) fn wait_for_bytes(file: &Path, bytes: u64) {
    let length = || std::fs::metadata(file).map_or(0, |file| file.len());
    wait_until(|| length() >= bytes, || format!("{} bytes", length()));
}

/// Calls a method at a Unix socket, once a server listens at it.
pub(crate) fn call(path: &Path, method: &str) -> Value {
    let mut stream = None;
    wait_until(
        || {
            stream = UnixStream::connect(path).ok();
            stream.is_some()
        },
        || "it does not listen".to_owned(),
    );
    let mut stream = stream.unwrap();
    let request = json!({"jsonrpc": "2.0", "id": 1, "method": method, "params": {}});
    stream.write_all(format!("{request}\n").as_bytes()).unwrap();
    let mut answer = String::new();
    BufReader::new(stream).read_line(&mut answer).unwrap();
    serde_json::from_str(&answer).unwrap()
}
