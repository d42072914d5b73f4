//! `rpi serve` as a process: its files with secrets, its sockets, and the signals of the operator.
#![cfg(unix)]

mod support;

use std::io::{BufRead, BufReader, Write};
use std::os::unix::fs::PermissionsExt;
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use support::{output_text, rpi};

const TOKEN: &str = "a-secret-of-the-tests";

/// Server process with Unix sockets, ended by the end of the test.
struct Process(Child);

impl Process {
    /// Starts a server and waits until its sockets exist.
    fn start(sockets: &[(&Path, &str)]) -> Process {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rpi"));
        command.args(["serve", "--listen", "127.0.0.1:0"]);
        for (path, options) in sockets {
            command.arg(format!("--socket={}{options}", path.display()));
        }
        let server = Process(command.stderr(Stdio::null()).spawn().unwrap());
        let begin = Instant::now();
        while !sockets
            .iter()
            .all(|(path, _)| UnixStream::connect(path).is_ok())
        {
            assert!(
                begin.elapsed() < Duration::from_secs(60),
                "it does not listen"
            );
            std::thread::sleep(Duration::from_millis(5));
        }
        server
    }

    fn signal(&self, signal: &str) {
        let process = self.0.id().to_string();
        let status = Command::new("kill").args([signal, &process]).status();
        assert!(status.unwrap().success());
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Calls a method at a Unix socket.
fn call(path: &Path, method: &str) -> Value {
    let mut stream = UnixStream::connect(path).unwrap();
    let request = json!({"jsonrpc": "2.0", "id": 1, "method": method, "params": {}});
    stream.write_all(format!("{request}\n").as_bytes()).unwrap();
    let mut answer = String::new();
    BufReader::new(stream).read_line(&mut answer).unwrap();
    serde_json::from_str(&answer).unwrap()
}

/// Waits until everything is stopped, or not.
fn wait_for(path: &Path, stopped: bool) {
    let begin = Instant::now();
    while call(path, "emergency.state")["result"]["stopped"] != stopped {
        assert!(
            begin.elapsed() < Duration::from_secs(60),
            "stopped: {stopped}?"
        );
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// A stop by SIGQUIT is the operator's: clients do not reset it, except for those of the operator's socket.
#[test]
fn sigquit_is_reset_by_the_operator_only() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| -> PathBuf { folder.path().join(name) };
    let (clients, panel) = (path("rpi.sock"), path("panel.sock"));
    let sockets = [(&*clients, ""), (&*panel, ",role=operator,mode=600")];
    let server = Process::start(&sockets);
    server.signal("-QUIT");
    wait_for(&clients, true);
    let refused = call(&clients, "emergency.reset");
    assert_eq!(refused["error"]["code"], -32009, "{refused}");
    let begin = Instant::now();
    while call(&panel, "emergency.reset")["error"]["code"] == -32003 {
        assert!(begin.elapsed() < Duration::from_secs(60));
    }
    wait_for(&clients, false);
    server.signal("-QUIT");
    wait_for(&clients, true);
    let begin = Instant::now();
    while call(&clients, "emergency.state")["result"]["stopped"] == true {
        // Repeated, as a reset is refused until all earlier requests are carried out.
        server.signal("-USR1");
        assert!(begin.elapsed() < Duration::from_secs(60));
        std::thread::sleep(Duration::from_millis(50));
    }
}

/// A file with tokens that others may read is refused, with the way to correct it.
#[test]
fn tokens_that_others_may_read_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tokens");
    std::fs::write(&path, format!("anna operator {TOKEN}\n")).unwrap();
    std::fs::set_permissions(&path, PermissionsExt::from_mode(0o644)).unwrap();
    let file = path.to_str().unwrap();
    let serve = || rpi(&["serve", "--listen", "127.0.0.1:0", "--token-file", file]);
    let output = serve();
    let text = output_text(&output);
    assert_eq!(output.status.code(), Some(2), "{text}");
    assert!(text.contains(file) && text.contains("chmod 600"), "{text}");
    std::fs::write(&path, format!("anna operater {TOKEN}\n")).unwrap();
    std::fs::set_permissions(&path, PermissionsExt::from_mode(0o600)).unwrap();
    let text = output_text(&serve());
    let place = format!("{file}:1: there is no role operater");
    assert!(
        text.contains(&place) && text.contains("did you mean operator?"),
        "{text}"
    );
}
