//! Ends of runs: devices are at rest, and a refused set-point is reported with its location.

mod tool;

use std::path::Path;

use tool::{printed, rpi};

/// A run that ends at rest leaves nothing to brake.
#[test]
fn examples_end_at_rest() {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    for name in ["first", "blending", "lifting", "assembly", "tending"] {
        let program = examples.join(format!("{name}/{name}.rpi"));
        let run = rpi(&["run", program.to_str().unwrap(), "--json"]);
        assert_eq!(run.status.code(), Some(0), "{name}: {}", printed(&run));
        let outcome: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
        for command in outcome["commands"].as_array().unwrap() {
            assert_eq!(
                command["braked"],
                serde_json::Value::Null,
                "{name}: {command}"
            );
        }
    }
}

/// A set-point refused by a device is reported as such with its location, and not as a missing set-point.
#[test]
fn a_refused_set_point_is_told_as_that() {
    let folder = tempfile::tempdir().unwrap();
    let program = folder.path().join("jump.rpi");
    let text = "use motion;
command Jump (arm: Arm)
let
  p = if time > 0.1[s] then 0.5[rad] else 0.0001[rad/s] * time;
  arm.joints = [p, 0[rad], 0[rad], 0[rad], 0[rad], 0[rad], 0[rad]];
  finish over when time > 1[s];
tel
";
    std::fs::write(&program, text).unwrap();
    let cell = "[devices.arm]\nkind = \"arm\"\nmodel = \"kuka-lwr4+\"\nenforce = [\"velocity\"]\n";
    std::fs::write(folder.path().join("cell.toml"), cell).unwrap();
    let run = rpi(&["run", program.to_str().unwrap()]);
    assert_eq!(run.status.code(), Some(3), "{}", printed(&run));
    let text = printed(&run);
    assert!(text.contains("FAULT at arm.joints"), "{text}");
    assert!(text.contains("the device refuses its set-point"), "{text}");
    assert!(text.contains("velocity at axis 0"), "{text}");
}

/// An analogue output would keep its value, and the program would go on as if it had set it. The fault sets the safe value.
#[test]
fn an_output_that_is_not_a_number_is_a_fault_with_its_place() {
    let folder = tempfile::tempdir().unwrap();
    let program = folder.path().join("valve.rpi");
    let text = "use io;
command Open (valve: AnalogueIo<<0, 2>>)
let
  opening = if time < 5[ms] then 0.5 else 0.0 / 0.0;
  valve.set = [0.25, opening];
  finish over when time > 1[s];
tel
";
    std::fs::write(&program, text).unwrap();
    let cell = "[devices.valve]\nkind = \"analogue-io\"\noutputs = 2\n\
                safe = [{ output = 1, value = 0.125 }]\n";
    std::fs::write(folder.path().join("cell.toml"), cell).unwrap();
    let record = folder.path().join("run.csv");
    let files = [&program, &record].map(|file| file.to_str().unwrap());
    let run = rpi(&["run", files[0], "--record", files[1]]);
    let text = printed(&run);
    assert_eq!(run.status.code(), Some(3), "{text}");
    assert!(text.contains("FAULT at valve.set"), "{text}");
    assert!(text.contains("valve.rpi:5"), "{text}");
    assert!(text.contains("not-a-number"), "{text}");
    let rows = std::fs::read_to_string(record).unwrap();
    let values: Vec<&str> = rows
        .lines()
        .filter_map(|row| row.split_once(",valve.out.real[1],").map(|row| row.1))
        .collect();
    assert!(values.contains(&"0.5"), "{values:?}");
    assert_eq!(values.last(), Some(&"0.125"), "{rows}");
}
