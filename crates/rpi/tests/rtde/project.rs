//! A folder with the blending example for an arm with six axes, a server that runs it, and a client.

use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use super::support::output_text;

/// The example, one round of it, and cells for simulation and for a controller.
pub(crate) struct Project(tempfile::TempDir);

const FAST: &str = "use motion;
command Go (arm: Arm<<6>>)
let
  way = PointToPoint<<n: 6; speed: 2.8[rad/s]; acceleration: 7.5[rad/s^2]; jerk: 60[rad/s^3]>>(arm, [2.8, -1.9, -1.7, -1.1, 1.5708, 0.3]);
  arm.joints = way.joints;
  finish at_a when way.done;
  fail stopped when way.stopped;
  fail arm_error when arm.error;
tel
";

impl Project {
    pub(crate) fn new(ports: [u16; 2]) -> Project {
        let folder = tempfile::tempdir().unwrap();
        let example = rpi_testkit::workspace_root().join("examples/blending/blending.rpi");
        let program = std::fs::read_to_string(example).unwrap();
        let program = program.replace("repeat 9 times", "repeat 1 times");
        let [rtde, script] = ports;
        // The time limit has a reserve for loaded machines.
        let real = format!(
            "kind = \"ur-arm\"\naddress = \"127.0.0.1\"\nrtde_port = {rtde}\nscript_port = {script}\ntimeout = 0.2\n"
        );
        let simulated = "kind = \"arm\"\njoints = [0.3, -1.9, -1.7, -1.1, 1.5708, 0.3]\n";
        let cell = |keys: &str| format!("[devices.arm]\nmodel = \"ur5e\"\n{keys}");
        let files = [
            ("blending.rpi", program),
            ("real.toml", cell(&real)),
            ("cell.toml", cell(simulated)),
        ];
        for (name, text) in files {
            std::fs::write(folder.path().join(name), text).unwrap();
        }
        Project(folder)
    }

    /// The same, with a program that turns the first axis by 2.5 rad at up to 2.8 rad/s in place of the example.
    pub(crate) fn fast(ports: [u16; 2]) -> Project {
        let project = Project::new(ports);
        std::fs::write(project.path("blending.rpi"), FAST).unwrap();
        project
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Returns the command that runs the example on a cell, with more arguments.
    pub(crate) fn command(&self, cell: &str, more: &[&str]) -> Command {
        let mut rpi = Command::new(env!("CARGO_BIN_EXE_rpi"));
        rpi.arg("run")
            .arg(self.path("blending.rpi"))
            .arg("--cell")
            .arg(self.path(cell))
            .args(["--period", "2ms"])
            .args(more)
            .env("NO_COLOR", "1");
        rpi
    }

    /// Runs the example on the controller. Returns the exit code and the output.
    pub(crate) fn run_real(&self) -> (Option<i32>, String) {
        let output = self.command("real.toml", &["--real-time"]).output();
        let output = output.unwrap();
        (output.status.code(), output_text(&output))
    }

    /// Starts a server with the controller.
    pub(crate) fn serve(&self) -> Server<'_> {
        let mut process = Command::new(env!("CARGO_BIN_EXE_rpi"))
            .args(["serve", "--listen", "127.0.0.1:0", "--period", "2ms"])
            .arg("--cell")
            .arg(self.path("real.toml"))
            .arg("--socket")
            .arg(self.path("rpi.sock"))
            .arg("--log")
            .arg(self.path("server.log"))
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut messages = BufReader::new(process.stderr.take().unwrap());
        let mut line = String::new();
        messages.read_line(&mut line).unwrap();
        assert!(line.starts_with("serving at"), "{line}");
        Server {
            project: self,
            process,
            _messages: messages,
        }
    }
}

/// A running server.
pub(crate) struct Server<'a> {
    project: &'a Project,
    process: Child,
    _messages: BufReader<std::process::ChildStderr>,
}

/// Client that runs the task of a program and prints its end.
const CLIENT: &str = "
import asyncio, sys
from rpi_client import connect

async def main(socket, program):
    async with await connect(socket) as core:
        session = await core.open_session('blending', on_loss='cancel')
        task = await session.load_task(open(program).read())
        await task.start()
        print(await task.result())

asyncio.run(main(*sys.argv[1:]))
";

impl Server<'_> {
    /// Starts a client that runs the task of the example.
    pub(crate) fn start_task(&self) -> Child {
        let clients = rpi_testkit::workspace_root().join("clients/python");
        Command::new("python3")
            .args(["-B", "-c", CLIENT])
            .args([
                self.project.path("rpi.sock"),
                self.project.path("blending.rpi"),
            ])
            .env("PYTHONPATH", clients)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap()
    }

    /// Runs the task of the example to its end. Returns the output of the client.
    pub(crate) fn run_task(&self) -> String {
        output_text(&self.start_task().wait_with_output().unwrap())
    }

    /// Returns the errors of the arm that the server has logged so far, in their order, with `ok` for the end of an error.
    pub(crate) fn errors(&self) -> Vec<String> {
        let log = std::fs::read_to_string(self.project.path("server.log")).unwrap_or_default();
        let parts = log.split("device arm: ").skip(1);
        let words = parts.map(|rest| rest.split(|c: char| !c.is_alphabetic() && c != '-').next());
        words
            .map(|word| word.unwrap_or_default().to_owned())
            .collect()
    }

    /// Waits until the arm has no error, at most 20 s.
    pub(crate) fn wait_for_recovery(&self) {
        let begin = Instant::now();
        while self.errors().last().is_none_or(|error| error != "ok") {
            let waited = begin.elapsed();
            assert!(waited < Duration::from_secs(20), "{:?}", self.errors());
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    /// Ends the process, as a crash does, after the last set-points have been played.
    pub(crate) fn kill(self) {
        std::thread::sleep(Duration::from_millis(300));
        drop(self);
    }
}

impl Drop for Server<'_> {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
