//! Rule 2: a primitive is declared in exactly one place.

use std::collections::BTreeMap;

use rpi_image::Role;
use rpi_prims::differences::DIFFERENCES;
use rpi_prims::{PrimId, registry};
use rpi_testkit::files_below;
use xtask::{functions, source_files};

#[test]
fn names_are_declared_once() {
    let names: Vec<&str> = registry().iter().map(|prim| prim.desc.name).collect();
    let unsorted = names.windows(2).find(|pair| pair[0] >= pair[1]);
    assert_eq!(
        unsorted, None,
        "two primitives of one name, or a registry out of order"
    );
}

#[test]
fn declarations_are_complete() {
    for prim in registry() {
        let desc = &prim.desc;
        assert!(
            !desc.doc.trim().is_empty(),
            "{}: no documentation",
            desc.name
        );
        let bounded = desc.work > 0 || desc.role != Role::Compute;
        assert!(bounded, "{}: no work bound", desc.name);
        let ports = desc
            .inputs
            .iter()
            .map(|p| p.name)
            .chain(desc.outputs.iter().map(|p| p.name));
        let mut seen: BTreeMap<&str, usize> = BTreeMap::new();
        ports.for_each(|name| *seen.entry(name).or_default() += 1);
        let twice: Vec<_> = seen.iter().filter(|(_, count)| **count > 1).collect();
        assert!(
            twice.is_empty(),
            "{}: ports declared twice: {twice:?}",
            desc.name
        );
    }
}

/// A sensor has only out-ports. An actuator has in-ports, and out-ports only for the responses of the device: one for
/// each declared answer, namely an error number, a Boolean about an error, or completion.
#[test]
fn sensors_only_give_and_actuators_only_take() {
    let (mut sensors, mut actuators) = (0, 0);
    for prim in registry() {
        let desc = &prim.desc;
        let names: Vec<&str> = desc.outputs.iter().map(|port| port.name).collect();
        match desc.role {
            Role::Sensor(_) => {
                sensors += 1;
                assert!(desc.inputs.is_empty(), "{} has in-ports", desc.name);
                assert!(!names.is_empty(), "{} has no out-ports", desc.name);
            }
            Role::Actuator(device) => {
                actuators += 1;
                assert!(!desc.inputs.is_empty(), "{} has no in-ports", desc.name);
                assert_eq!(names.len(), device.responses.len(), "{}", desc.name);
                let answers = names.iter().all(|name| is_answer(name));
                assert!(answers, "{} has the out-ports {names:?}", desc.name);
            }
            _ => {}
        }
    }
    assert!(sensors > 5 && actuators > 5, "{sensors} and {actuators}");
}

/// Returns whether a port name denotes a response of a device to a set-point.
fn is_answer(name: &str) -> bool {
    let name = name.trim_start_matches("out");
    name.starts_with("Error") || ["Completed", "Success", "Finished", "StatusCode"].contains(&name)
}

/// Other crates refer to primitives by name, and the names must be registered.
#[test]
fn names_in_other_crates_are_registered() {
    for file in source_files()
        .iter()
        .filter(|file| file.owner != "rpi-prims")
    {
        for name in quoted_names(file.without_tests()) {
            assert!(
                PrimId::from_name(name).is_some(),
                "{}: no primitive {name}",
                file.path.display()
            );
        }
    }
}

#[test]
fn every_difference_to_the_reference_names_a_test_that_exists() {
    let files = files_below("crates/rpi-prims", &[".rs"]);
    let text: String = files
        .iter()
        .filter_map(|path| std::fs::read_to_string(path).ok())
        .collect();
    let tests: Vec<&str> = functions(&text).iter().map(|f| f.name).collect();
    for difference in DIFFERENCES {
        assert!(
            tests.contains(&difference.test),
            "{}: no test {}",
            difference.name,
            difference.test
        );
    }
}

/// Returns all string literals of the form `"Core::Something"` or `"Rpi::Something"`.
fn quoted_names(text: &str) -> impl Iterator<Item = &str> {
    let literals = text
        .lines()
        .flat_map(|line| line.split('"').skip(1).step_by(2));
    literals.filter(|literal| {
        let name = literal
            .strip_prefix("Core::")
            .or(literal.strip_prefix("Rpi::"))
            .unwrap_or("");
        !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric())
    })
}
