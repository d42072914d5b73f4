//! `rpic compile --emit fmu`: units that FMPy validates and simulates, with the bits of the core.
//!
//! `RPI_FMPY` is the Python interpreter that has the package `fmpy`.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use rpi_driver::{ClaimPolicy, compile_node, lower_for_execution, read};
use rpi_replay::node_runner::NodeRun;
use rpi_testkit::{report_skip, workspace_root};

/// Period of all programs in ns: 1 ms.
const PERIOD_NS: u64 = 1_000_000;
const CYCLES: usize = 700;

fn rpic(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_rpic"))
        .args(args)
        .env("NO_COLOR", "1")
        .current_dir(workspace_root())
        .output()
        .unwrap()
}

/// Returns the Python interpreter with `fmpy`: the one that `RPI_FMPY` names, that `.ci/run` sets up, or that of the system.
/// `None` if there is none.
fn python() -> Option<String> {
    let own = workspace_root().join("target/python/bin/python");
    let named = std::env::var("RPI_FMPY").ok();
    let candidates = [
        named,
        Some(own.display().to_string()),
        Some("python3".to_owned()),
    ];
    let has_fmpy = |python: &String| {
        let output = Command::new(python).args(["-c", "import fmpy"]).output();
        output.is_ok_and(|output| output.status.success())
    };
    let python = candidates.into_iter().flatten().find(has_fmpy);
    let has_compiler = Command::new("cc").arg("--version").output().is_ok();
    if python.is_none() || !has_compiler {
        report_skip("fmpy (set RPI_FMPY) or cc is not installed");
        return None;
    }
    python
}

/// Runs the script `data/simulate.py`. Returns the lines that it prints.
fn simulate(python: &str, unit: &Path, more: &[&str]) -> Vec<String> {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/simulate.py");
    let mut command = Command::new(python);
    command.arg(script).arg(unit).args(more);
    let output = command.output().unwrap();
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{error}");
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    text.lines().map(str::to_owned).collect()
}

fn emit(folder: &Path, program: &str, options: &[&str]) -> PathBuf {
    let unit = folder.join("unit.fmu");
    let path = unit.display().to_string();
    let output = rpic(&[&["compile", program, "--emit", "fmu", "-o", &path], options].concat());
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{error}");
    unit
}

/// Returns the voltages that the core computes for the inputs of the script.
fn expected() -> Vec<String> {
    let input = read(&workspace_root().join("examples/motor/motor.rpi")).unwrap();
    let compiled = compile_node(&input, Some("Drive"), ClaimPolicy::Off, false).unwrap();
    let node = compiled.node.unwrap();
    let image = lower_for_execution(&node.net, PERIOD_NS).unwrap();
    let mut run = NodeRun::load(image, &node.inputs, &node.outputs[..1], &[]).unwrap();
    let keys: Vec<&str> = node.inputs.iter().map(|c| c.key.as_str()).collect();
    assert_eq!(keys, ["on", "reset", "wanted", "measured"]);
    let row = |cycle: usize| {
        let measured = (cycle % 50) as f64 * 0.1;
        let words = [1, 0, 100_f64.to_bits(), measured.to_bits()];
        let row: Vec<_> = words.iter().map(|word| Some(vec![*word])).collect();
        let outputs = run.cycle(&row).row.unwrap();
        format!("{:016x}", outputs[0].as_ref().unwrap()[0])
    };
    (0..CYCLES).map(row).collect()
}

#[test]
fn a_controller_is_a_valid_unit_with_the_same_bits() {
    let Some(python) = python() else { return };
    let folder = tempfile::tempdir().unwrap();
    let unit = emit(
        folder.path(),
        "examples/motor/motor.rpi",
        &["--node", "Drive"],
    );
    let cycles = CYCLES.to_string();
    let found = simulate(&python, &unit, &["voltage", &cycles]);
    let (units, voltages) = found.split_first().unwrap();
    assert_eq!(units, "wanted: rad/s measured: rad/s voltage: V");
    assert_eq!(voltages, expected());
}

#[test]
fn a_robot_command_is_a_valid_unit() {
    let Some(python) = python() else { return };
    let folder = tempfile::tempdir().unwrap();
    let unit = emit(folder.path(), "crates/rpic/tests/data/joint.rpi", &[]);
    let lines = simulate(&python, &unit, &[]);
    assert!(lines.iter().any(|line| line == "valid"), "{lines:?}");
}

#[test]
fn a_program_with_device_functions_is_refused() {
    let program = "examples/blending/blending.rpi";
    let command = ["--command", "MoveToA"];
    let output = rpic(
        &[
            &["compile", program, "--emit", "fmu", "-o", "/dev/null"],
            &command[..],
        ]
        .concat(),
    );
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{error}");
    assert!(error.contains("functions of devices"), "{error}");
}
