//! A server in this process, its clients and its workers.

use std::io::{BufRead, BufReader, Write};
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use rpi_serve::{CompilerSettings, Server, Settings, SocketSettings, WorkerSettings};
use rpi_sim::Cell;
use serde_json::{Value, json};

/// Timeout of every wait in tests.
pub(crate) const PATIENCE: Duration = Duration::from_secs(120);

/// Server with the folder of its socket.
pub(crate) struct Scene {
    folder: tempfile::TempDir,
    server: Option<Server>,
}

impl Scene {
    /// Opens a server whose workers run the tool under a name of its own, with these changes of their settings.
    pub(crate) fn with_workers(change: impl FnOnce(&mut WorkerSettings)) -> Scene {
        let folder = tempfile::tempdir().unwrap();
        let program = folder.path().join("worker");
        std::os::unix::fs::symlink(env!("CARGO_BIN_EXE_rpi"), &program).unwrap();
        let mut settings = WorkerSettings::new(program, vec!["compile-worker".into()]);
        change(&mut settings);
        Scene::open(folder, CompilerSettings::Workers(settings))
    }

    /// Opens a server that compiles in this process.
    pub(crate) fn in_process() -> Scene {
        Scene::open(tempfile::tempdir().unwrap(), CompilerSettings::InProcess)
    }

    fn open(folder: tempfile::TempDir, compiler: CompilerSettings) -> Scene {
        let cell = Cell::parse("cell.toml", super::CELL).unwrap();
        let settings = Settings {
            listen: ([127, 0, 0, 1], 0).into(),
            sockets: vec![SocketSettings::new(folder.path().join("rpi.sock"))],
            compiler,
            // Only the texts are under test, not the speed of this machine.
            cycle_share: None,
            ..Settings::default()
        };
        let server = Server::open(&cell, &settings, ()).unwrap();
        Scene {
            folder,
            server: Some(server),
        }
    }

    /// Closes the server.
    pub(crate) fn close(&mut self) {
        self.server.take().unwrap().close().unwrap();
    }

    /// Connects a client with a session.
    pub(crate) fn client(&self) -> Client {
        let stream = UnixStream::connect(self.folder.path().join("rpi.sock")).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        let mut client = Client {
            reader: BufReader::new(stream.try_clone().unwrap()),
            stream,
            session: String::new(),
        };
        let opened = client.call("session.open", &json!({"name": "test"}));
        opened["result"]["session"]
            .as_str()
            .unwrap()
            .clone_into(&mut client.session);
        client
    }

    /// Returns the address of the server.
    pub(crate) fn address(&self) -> std::net::SocketAddr {
        self.server.as_ref().unwrap().address()
    }

    /// Returns the path of a file in the folder of the server.
    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Returns the process ids of the running workers.
    pub(crate) fn workers(&self) -> Vec<u32> {
        let program = self.path("worker");
        let processes = std::fs::read_dir("/proc").unwrap().flatten();
        let ids = processes.filter_map(|entry| entry.file_name().to_str()?.parse().ok());
        ids.filter(|id| is_running(*id, &program)).collect()
    }

    /// Waits until this number of workers runs.
    pub(crate) fn wait_for_workers(&self, count: usize) -> Vec<u32> {
        let begin = Instant::now();
        loop {
            let workers = self.workers();
            if workers.len() == count {
                return workers;
            }
            assert!(begin.elapsed() < PATIENCE, "{workers:?} for {count}");
            std::thread::sleep(Duration::from_millis(1));
        }
    }
}

/// Returns whether a process runs a program. A process that has ended has no command line.
fn is_running(id: u32, program: &Path) -> bool {
    let line = std::fs::read(format!("/proc/{id}/cmdline")).unwrap_or_default();
    let first = line.split(|byte| *byte == 0).next().unwrap_or_default();
    first == program.as_os_str().as_encoded_bytes()
}

/// Sends a signal to a process.
pub(crate) fn signal(process: u32, signal: &str) {
    let status = Command::new("kill")
        .args([signal, &process.to_string()])
        .status();
    assert!(status.unwrap().success());
}

/// Client at the Unix socket, with a session.
pub(crate) struct Client {
    stream: UnixStream,
    reader: BufReader<UnixStream>,
    session: String,
}

impl Client {
    /// Sends a request.
    pub(crate) fn send(&mut self, method: &str, params: &Value) {
        let request = json!({"jsonrpc": "2.0", "id": 1, "method": method, "params": params});
        self.stream
            .write_all(format!("{request}\n").as_bytes())
            .unwrap();
    }

    /// Receives the next answer.
    pub(crate) fn receive(&mut self) -> Value {
        let mut answer = String::new();
        self.reader.read_line(&mut answer).unwrap();
        serde_json::from_str(&answer).unwrap_or_else(|error| panic!("{error}: {answer}"))
    }

    /// Sends a request and returns its answer.
    pub(crate) fn call(&mut self, method: &str, params: &Value) -> Value {
        self.send(method, params);
        self.receive()
    }

    /// Requests to load a text, without waiting for the answer.
    pub(crate) fn begin_load(&mut self, text: &str, language: &str) {
        let params = json!({"session": self.session, "text": text, "language": language});
        self.send("command.load", &params);
    }

    /// Loads a net. Returns the answer.
    pub(crate) fn load(&mut self, text: &str) -> Value {
        self.begin_load(text, "rpinet");
        self.receive()
    }

    /// Loads a command or task (`command` or `task`) of a program. Returns the answer.
    pub(crate) fn load_named(&mut self, kind: &str, text: &str, name: Option<&str>) -> Value {
        let mut params = json!({"session": self.session, "text": text, "language": "rpi"});
        if let Some(name) = name {
            params[kind] = json!(name);
        }
        self.call(&format!("{kind}.load"), &params)
    }
}

/// Returns the reasons of a rejected load, as one text.
#[track_caller]
pub(crate) fn reasons(answer: &Value) -> String {
    assert_eq!(answer["error"]["code"], -32002, "{answer}");
    answer["error"]["data"]["reasons"].to_string()
}

/// Asserts that a text was loaded.
#[track_caller]
pub(crate) fn assert_loaded(answer: &Value) {
    assert!(answer["result"]["command"].is_string(), "{answer}");
}
