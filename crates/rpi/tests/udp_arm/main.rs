//! Programs on an arm behind a controller, which runs in a process of its own: the same programs as in simulation, with
//! the same bits, and a safe end of each failure.

use std::io::{BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

mod controller;
#[path = "../support/mod.rs"]
mod support;

use controller::Settings;
use support::{output_text, rpi};

/// Variable with the settings of the process of a controller.
const SETTINGS: &str = "RPI_TEST_CONTROLLER";

/// The process of a controller: started by the tests below with its settings, and without effect otherwise.
#[test]
#[ignore = "the other tests start it as a process"]
fn controller_process() {
    if let Ok(settings) = std::env::var(SETTINGS) {
        controller::run(Settings::from_text(&settings));
    }
}

/// A running controller.
struct Process {
    child: Child,
    output: BufReader<std::process::ChildStdout>,
    port: u16,
}

/// Set-points and end of a controller.
struct Log {
    brakes: u32,
    rests: bool,
    /// Bits of the positions of all axes, without repetitions.
    set_points: Vec<Vec<u64>>,
}

impl Process {
    fn start(settings: &Settings) -> Process {
        let mut child = Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "controller_process", "--ignored", "--nocapture"])
            .env(SETTINGS, settings.to_text())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut output = BufReader::new(child.stdout.take().unwrap());
        let mut line = String::new();
        while !line.starts_with("PORT ") {
            line.clear();
            assert!(output.read_line(&mut line).unwrap() > 0, "it has no port");
        }
        let port = line["PORT ".len()..].trim().parse().unwrap();
        Process {
            child,
            output,
            port,
        }
    }

    fn end(mut self) -> Log {
        // The controller plays the last set-points some cycles after they came.
        std::thread::sleep(Duration::from_millis(500));
        drop(self.child.stdin.take());
        let mut text = String::new();
        self.output.read_to_string(&mut text).unwrap();
        self.child.wait().unwrap();
        let end = text
            .lines()
            .find(|line| line.starts_with("BRAKES"))
            .unwrap();
        let words: Vec<&str> = end.split(' ').collect();
        let lines = text.lines().filter_map(|line| line.strip_prefix("SET "));
        let bits = lines.map(|line| line.split(' ').map(|word| word.parse().unwrap()).collect());
        Log {
            brakes: words[1].parse().unwrap(),
            rests: words[3] == "true",
            set_points: without_repetitions(bits.collect()),
        }
    }
}

fn without_repetitions(mut all: Vec<Vec<u64>>) -> Vec<Vec<u64>> {
    all.dedup();
    all
}

const PERIOD_MS: u64 = 4;
const JOINTS_DEG: [f64; 7] = [0.0, -30.0, 0.0, 90.0, 0.0, -60.0, 0.0];

fn settings(loss: f64) -> Settings {
    Settings {
        period: Duration::from_millis(PERIOD_MS),
        loss,
        jitter: Duration::from_millis(2),
        depth: 25,
        // Longer than a loaded machine may hold up the core, shorter than the outage.
        watchdog: 75,
        outage_at: 0,
        joints: JOINTS_DEG
            .map(|angle| angle * (std::f64::consts::PI / 180.0))
            .to_vec(),
    }
}

/// A folder with the example of blending, one round of it, and cells for simulation and for a controller.
struct Project(tempfile::TempDir);

impl Project {
    fn new(port: u16) -> Project {
        let folder = tempfile::tempdir().unwrap();
        let example = rpi_testkit::workspace_root().join("examples/blending");
        let read = |file: &str| std::fs::read_to_string(example.join(file)).unwrap();
        let program = read("blending.rpi").replace("repeat 9 times", "repeat 1 times");
        let cell = read("cell.toml");
        let kind = format!("kind = \"udp-arm\"\naddress = \"127.0.0.1:{port}\"\ntimeout = 0.4");
        let files = [
            ("blending.rpi", program),
            ("real.toml", cell.replace("kind = \"arm\"", &kind)),
            ("cell.toml", cell),
        ];
        for (name, text) in files {
            std::fs::write(folder.path().join(name), text).unwrap();
        }
        Project(folder)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn command(&self, cell: &str, more: &[&str]) -> Command {
        let mut rpi = Command::new(env!("CARGO_BIN_EXE_rpi"));
        rpi.arg("run")
            .arg(self.path("blending.rpi"))
            .arg("--cell")
            .arg(self.path(cell));
        let period = format!("{PERIOD_MS}ms");
        rpi.args(["--period", &period])
            .args(more)
            .env("NO_COLOR", "1");
        rpi
    }
}

/// Commanded positions of the joints in a recording, by cycle, without repetitions.
fn recorded(path: &Path) -> Vec<Vec<u64>> {
    let text = std::fs::read_to_string(path).unwrap();
    let mut cycles: Vec<Vec<u64>> = Vec::new();
    for line in text
        .lines()
        .filter(|line| line.contains("joint.commanded_position["))
    {
        let mut fields = line.split(',');
        let cycle: usize = fields.next().unwrap().parse().unwrap();
        let value: f64 = fields.nth(1).unwrap().parse().unwrap();
        cycles.resize(cycles.len().max(cycle + 1), Vec::new());
        cycles[cycle].push(value.to_bits());
    }
    without_repetitions(cycles)
}

#[test]
fn blending_has_the_bits_of_the_simulation_in_spite_of_losses() {
    let controller = Process::start(&settings(0.01));
    let project = Project::new(controller.port);
    let table = project.path("out.csv");
    let simulated = project
        .command("cell.toml", &["--record", table.to_str().unwrap()])
        .output()
        .unwrap();
    assert!(simulated.status.success(), "{}", output_text(&simulated));
    let real = project
        .command("real.toml", &["--real-time"])
        .output()
        .unwrap();
    let log = controller.end();
    let text = output_text(&real);
    assert_eq!(real.status.code(), Some(0), "{text}");
    assert!(
        text.contains("taken over at at_b") && text.contains("arm: ok, at rest"),
        "{text}"
    );
    assert_eq!((log.brakes, log.rests), (0, true), "{text}");
    assert_same_bits(&log, &table);
}

/// Compares the set-points that a controller played with the recording of a simulated run.
fn assert_same_bits(log: &Log, table: &Path) {
    let expected = recorded(table);
    let first = expected.first().unwrap();
    let mut set_points = log.set_points.iter();
    let begin = set_points.position(|set_point| set_point == first);
    let played = &log.set_points[begin.expect("the first set-point")..];
    assert_eq!(played.len(), expected.len());
    let pairs = played.iter().zip(&expected);
    let differences = pairs.filter(|(one, other)| one != other).count();
    assert_eq!(differences, 0, "of {} set-points", expected.len());
}

/// Client that runs the task of a program on a server and prints its end.
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

#[test]
fn the_server_runs_the_same_task() {
    let controller = Process::start(&settings(0.01));
    let project = Project::new(controller.port);
    let (socket, period) = (project.path("rpi.sock"), format!("{PERIOD_MS}ms"));
    let mut server = Command::new(env!("CARGO_BIN_EXE_rpi"))
        .args(["serve", "--listen", "127.0.0.1:0", "--period", &period])
        .arg("--cell")
        .arg(project.path("real.toml"))
        .arg("--socket")
        .arg(&socket)
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut line = String::new();
    let mut messages = BufReader::new(server.stderr.take().unwrap());
    messages.read_line(&mut line).unwrap();
    assert!(line.starts_with("serving at"), "{line}");
    let clients = rpi_testkit::workspace_root().join("clients/python");
    let client = Command::new("python3")
        .args(["-c", CLIENT])
        .args([&socket, &project.path("blending.rpi")])
        .env("PYTHONPATH", clients)
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .output();
    std::thread::sleep(Duration::from_millis(500));
    server.kill().unwrap();
    server.wait().unwrap();
    let log = controller.end();
    let Ok(client) = client else {
        // Writes past the test harness, which captures the output of passing tests.
        let line = b"SKIPPED: the server with a controller: there is no Python 3\n";
        return std::io::stderr().write_all(line).unwrap();
    };
    let text = output_text(&client);
    assert!(client.status.success() && text.contains("done"), "{text}");
    assert_eq!((log.brakes, log.rests), (0, true), "{text}");
}

#[test]
fn an_outage_is_reported_and_ends_at_rest_and_the_next_run_succeeds() {
    let controller = Process::start(&Settings {
        outage_at: 300,
        ..settings(0.0)
    });
    let project = Project::new(controller.port);
    let real = project
        .command("real.toml", &["--real-time"])
        .output()
        .unwrap();
    let text = output_text(&real);
    assert!(matches!(real.status.code(), Some(1 | 3)), "{text}");
    assert!(text.contains("connection-lost"), "{text}");
    assert!(text.contains("at rest"), "{text}");
    let again = project
        .command("real.toml", &["--real-time"])
        .output()
        .unwrap();
    let log = controller.end();
    let text = output_text(&again);
    assert_eq!(again.status.code(), Some(0), "{text}");
    assert_eq!((log.brakes, log.rests), (1, true), "{text}");
}

#[test]
fn a_killed_program_leaves_the_arm_at_rest() {
    let controller = Process::start(&settings(0.0));
    let project = Project::new(controller.port);
    let mut real = project
        .command("real.toml", &["--real-time"])
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    std::thread::sleep(Duration::from_millis(1500));
    real.kill().unwrap();
    real.wait().unwrap();
    std::thread::sleep(Duration::from_secs(1));
    let log = controller.end();
    assert_eq!((log.brakes, log.rests), (1, true));
}

/// The guard of a killed core has no connection to the arm: the watchdog of the controller brakes it. The recording
/// replays up to the cut, and the next run succeeds.
#[test]
#[cfg(target_os = "linux")]
fn the_controller_brakes_the_arm_of_a_killed_core() {
    let controller = Process::start(&settings(0.0));
    let project = Project::new(controller.port);
    let file = project.path("out.mcap");
    let recorded = ["--real-time", "--guard", "--record", file.to_str().unwrap()];
    let mut guard = project
        .command("real.toml", &recorded)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    std::thread::sleep(Duration::from_millis(2500));
    let id = guard.id();
    let children = std::fs::read_to_string(format!("/proc/{id}/task/{id}/children")).unwrap();
    let killed = Command::new("kill")
        .args(["-KILL", children.trim()])
        .status();
    assert!(killed.unwrap().success());
    let mut text = String::new();
    let errors = guard.stderr.take().unwrap();
    BufReader::new(errors).read_to_string(&mut text).unwrap();
    assert_eq!(guard.wait().unwrap().code(), Some(4), "{text}");
    assert!(text.contains("was ended by SIGKILL"), "{text}");
    assert!(
        support::recordings::ticks_up_to_the_cut(&file) > 100,
        "{text}"
    );
    std::thread::sleep(Duration::from_secs(1));
    let again = project.command("real.toml", &["--real-time"]).output();
    let again = again.unwrap();
    let log = controller.end();
    assert_eq!(again.status.code(), Some(0), "{}", output_text(&again));
    assert_eq!((log.brakes, log.rests), (1, true), "{text}");
}

#[test]
fn a_real_device_needs_real_time_and_its_controller() {
    let project = Project::new(1);
    let simulated = project.command("real.toml", &[]).output().unwrap();
    let text = output_text(&simulated);
    assert_eq!(simulated.status.code(), Some(2), "{text}");
    assert!(
        text.contains("device `arm`") && text.contains("--real-time"),
        "{text}"
    );
    let absent = project
        .command("real.toml", &["--real-time"])
        .output()
        .unwrap();
    let text = output_text(&absent);
    assert_eq!(absent.status.code(), Some(2), "{text}");
    assert!(
        text.contains("no controller with 7 axes answers at 127.0.0.1:1"),
        "{text}"
    );
    let cell = project.path("real.toml");
    let checked = rpi(&["cell", "check", cell.to_str().unwrap()]);
    assert!(checked.status.success(), "{}", output_text(&checked));
}
