//! The process of the controller for the driver under test, in Python, and the trace of its robot.

use std::io::{BufRead, BufReader, Read, Write};
use std::path::PathBuf;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::thread;
use std::time::{Duration, Instant};

/// Number of axes of the robot.
const AXES: usize = 6;
/// Duration of a cycle of the controller, in s.
pub(crate) const CYCLE: f64 = 0.002;
/// Initial positions from which the tool comes to the points of the blending example on lines, in rad.
const JOINTS: [&str; AXES] = ["0.3", "-1.9", "-1.7", "-1.1", "1.5708", "0.3"];

/// A running controller.
pub(crate) struct Fake {
    child: Child,
    commands: ChildStdin,
    events: Receiver<String>,
    folder: tempfile::TempDir,
    /// Ports of RTDE and of programs.
    pub(crate) ports: [u16; 2],
    /// All events so far.
    pub(crate) log: Vec<String>,
}

/// Positions of the robot in each cycle of the controller.
pub(crate) struct Trace {
    pub(crate) positions: Vec<[f64; AXES]>,
    /// True if the robot was at rest at the end.
    pub(crate) rests: bool,
    pub(crate) log: String,
}

/// Extremes of a trace.
#[derive(Debug)]
pub(crate) struct Extremes {
    /// Greatest velocity of an axis, in rad/s.
    pub(crate) velocity: f64,
    /// Greatest acceleration of an axis, in rad/s².
    pub(crate) acceleration: f64,
}

impl Fake {
    /// Starts a controller. Without Python 3, reports that on standard error and returns `None`.
    pub(crate) fn start(test: &str) -> Option<Fake> {
        if Command::new("python3").arg("--version").output().is_err() {
            // Writes past the test harness, which captures the output of passing tests.
            let line = format!("SKIPPED: {test}: there is no Python 3\n");
            std::io::stderr().write_all(line.as_bytes()).unwrap();
            return None;
        }
        let folder = tempfile::tempdir().unwrap();
        let script = rpi_testkit::workspace_root().join("crates/rpi/tests/rtde/fake/controller.py");
        let mut child = Command::new("python3")
            .arg("-B")
            .arg(script)
            .arg("--joints")
            .args(JOINTS)
            .arg("--trace")
            .arg(folder.path().join("trace"))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let commands = child.stdin.take().unwrap();
        let output = BufReader::new(child.stdout.take().unwrap());
        let (sender, events) = channel();
        thread::spawn(move || {
            output
                .lines()
                .map_while(Result::ok)
                .try_for_each(|line| sender.send(line))
        });
        let mut fake = Fake {
            child,
            commands,
            events,
            folder,
            ports: [0; 2],
            log: Vec::new(),
        };
        let line = fake.wait_for("PORTS ");
        let mut ports = line.split(' ').skip(1).map(|port| port.parse().unwrap());
        fake.ports = [ports.next().unwrap(), ports.next().unwrap()];
        Some(fake)
    }

    /// Sends a command to the controller, as `controller.py` lists them.
    pub(crate) fn command(&mut self, line: &str) {
        writeln!(self.commands, "{line}").unwrap();
    }

    /// Waits for an event that begins with this text, at most 20 s, and returns it.
    pub(crate) fn wait_for(&mut self, begin: &str) -> String {
        let limit = Instant::now() + Duration::from_secs(20);
        loop {
            let left = limit.saturating_duration_since(Instant::now());
            let Ok(line) = self.events.recv_timeout(left) else {
                panic!("no event `{begin}` of the controller: {:#?}", self.log);
            };
            self.log.push(line.clone());
            if line.starts_with(begin) {
                return line;
            }
        }
    }

    /// Ends the controller and returns the trace of its robot.
    pub(crate) fn end(mut self) -> Trace {
        // The arm is late by the lookahead time of its servo.
        thread::sleep(Duration::from_millis(700));
        self.command("end");
        self.child.wait().unwrap();
        let rest: Vec<String> = self.events.iter().collect();
        self.log.extend(rest);
        let path: PathBuf = self.folder.path().join("trace");
        let mut bytes = Vec::new();
        let mut file = std::fs::File::open(path).unwrap();
        file.read_to_end(&mut bytes).unwrap();
        let values: Vec<f64> = bytes
            .as_chunks()
            .0
            .iter()
            .map(|chunk| f64::from_ne_bytes(*chunk))
            .collect();
        Trace {
            positions: values.as_chunks().0.to_vec(),
            rests: self.log.iter().any(|line| line.starts_with("REST True")),
            log: self.log.join("\n"),
        }
    }
}

impl Drop for Fake {
    fn drop(&mut self) {
        // After an error of the test; otherwise it has ended.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Trace {
    /// Returns the extremes of the trace, as differences of the positions.
    pub(crate) fn extremes(&self) -> Extremes {
        let mut extremes = Extremes {
            velocity: 0.0,
            acceleration: 0.0,
        };
        for window in self.positions.windows(3) {
            let [first, second, third] = window else {
                continue;
            };
            for ((a, b), c) in first.iter().zip(second).zip(third) {
                extremes.velocity = extremes.velocity.max((c - b).abs() / CYCLE);
                let acceleration = (c - 2.0 * b + a).abs() / CYCLE / CYCLE;
                extremes.acceleration = extremes.acceleration.max(acceleration);
            }
        }
        extremes
    }

    /// Checks that the positions are continuous, that the velocities stay within the limit of the arm, and that the
    /// accelerations stay below this limit, in rad/s².
    pub(crate) fn check(&self, acceleration: f64) {
        let extremes = self.extremes();
        let velocity = std::f64::consts::PI;
        assert!(extremes.velocity < velocity, "{extremes:?}\n{}", self.log);
        assert!(
            extremes.acceleration < acceleration,
            "{extremes:?}\n{}",
            self.log
        );
        assert!(self.rests, "{}", self.log);
    }
}
