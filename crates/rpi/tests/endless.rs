//! Tasks without an end: the paper's Listing 1, whose commands take over from one another for ever, and palletising.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

/// Digest of a minute of the arm: the same in every build, on every machine.
const MINUTE: &str = "be6687103bef8039";

/// Writes the example with its nine rounds made endless.
fn endless(folder: &Path) -> std::path::PathBuf {
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/blending");
    let text = std::fs::read_to_string(example.join("blending.rpi")).unwrap();
    let endless = text.replace("repeat 9 times", "repeat");
    assert_ne!(text, endless);
    let program = folder.join("endless.rpi");
    std::fs::write(&program, endless).unwrap();
    std::fs::copy(example.join("cell.toml"), folder.join("cell.toml")).unwrap();
    program
}

fn run(options: &[&str]) -> serde_json::Value {
    let folder = tempfile::tempdir().unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_rpi"))
        .arg("run")
        .arg(endless(folder.path()))
        .args(["--json", "--digest"])
        .args(options)
        .output()
        .unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn a_minute_has_the_same_bits_in_every_build() {
    let outcome = run(&["--time", "60s"]);
    assert_eq!(outcome["late"], 0);
    assert_eq!(outcome["devices"][0]["condition"], "ok");
    assert_eq!(outcome["digest"], MINUTE);
}

/// Real time gives the same bits as simulated time: a command that is loaded in time takes over in the same cycle.
#[test]
fn real_time_has_the_same_bits() {
    let [real, simulated] = ["--real-time", "--sim-time"].map(|pace| run(&["--time", "4s", pace]));
    assert_eq!(real["late"], 0);
    assert_eq!(real["digest"], simulated["digest"]);
}

/// Memory does not grow after the first minute, for ten minutes or for the time in `RPI_ENDLESS`; `cargo xtask soak`
/// takes a day.
#[test]
fn memory_is_constant() {
    let long = std::env::var("RPI_ENDLESS").unwrap_or_else(|_| "600s".to_owned());
    let folder = tempfile::tempdir().unwrap();
    let jobs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/jobs");
    let programs = [
        endless(folder.path()),
        jobs.join("palletising/palletising.rpi"),
    ];
    for program in programs {
        let [short, long] = ["60s", &long].map(|time| peak(&program, time));
        let name = program.display();
        println!("{name}: {short} kB in a minute, {long} kB in the end");
        assert!(
            long < short + 4096,
            "{name}: {short} kB have become {long} kB"
        );
    }
}

/// Returns the peak memory of a run in kB.
fn peak(program: &Path, time: &str) -> u64 {
    let mut run = Command::new(env!("CARGO_BIN_EXE_rpi"))
        .arg("run")
        .arg(program)
        .args(["--time", time])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut peak = 0;
    let status = loop {
        let text = std::fs::read_to_string(format!("/proc/{}/status", run.id()));
        let text = text.unwrap_or_default();
        let line = text.lines().find(|line| line.starts_with("VmHWM:"));
        let now = line.and_then(|line| line.split_whitespace().nth(1)?.parse().ok());
        peak = peak.max(now.unwrap_or(0));
        if let Some(status) = run.try_wait().unwrap() {
            break status;
        }
        std::thread::sleep(Duration::from_millis(10));
    };
    assert!(status.success());
    peak
}
