//! The manual describes every key, port, error code and limit as it is in the code.

use rpi_device::PortKind;
use rpi_kin::ArmModel;
use rpi_sim::Cell;
use rpi_sim::error_code::ERROR_CODES;

/// The chapter on devices, and the generated one on their kinds.
fn manual() -> String {
    let read = |page: &str| {
        let path = rpi_testkit::workspace_root().join("docs/src").join(page);
        std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{page}: {error}"))
    };
    read("devices.md") + &read("device-kinds.md")
}

fn must_have(manual: &str, line: &str) {
    assert!(manual.contains(line), "docs/src/devices.md lacks\n{line}");
}

#[test]
fn every_kind_and_key_is_described() {
    let manual = manual();
    for kind in Cell::kinds() {
        must_have(&manual, &format!("`{}`", kind.name));
        for key in kind.keys() {
            must_have(&manual, &format!("| `{key}` |"));
        }
    }
}

#[test]
fn every_port_is_described_with_its_type() {
    let manual = manual();
    for port in Cell::kinds().flat_map(|kind| kind.ports()) {
        let kind = match port.kind {
            PortKind::Sensor => "sensor",
            PortKind::Actuator => "actuator",
            PortKind::Function => "function",
        };
        let index = if port.indexed { "yes" } else { "" };
        must_have(
            &manual,
            &format!("| `{}` | {kind} | {} | {index} |", port.name, port.ty),
        );
    }
}

#[test]
fn every_error_code_is_told() {
    let manual = manual();
    for (number, line) in ERROR_CODES.iter().enumerate() {
        assert_eq!(line.code.0, number as i64, "ascending, without a gap");
        must_have(
            &manual,
            &format!("| {number} | {} | {} |", line.name, line.description),
        );
    }
}

#[test]
fn every_arm_is_told_with_its_limits() {
    let manual = manual();
    for model in rpi_kin::models::ALL {
        must_have(&manual, &limits(model));
    }
}

/// The manual's table of one arm's limits, in degrees.
fn limits(model: &ArmModel) -> String {
    let short = |value: f64| {
        let rounded = (value.to_degrees() * 10.0).round() / 10.0;
        if rounded.is_finite() {
            rounded.to_string()
        } else {
            "none".to_owned()
        }
    };
    let mut table = format!("**`{}`**, {}.", model.id, model.display_name);
    table += &format!(" Source: {}.\n\n", model.source);
    table += "| axis | range, deg | velocity, deg/s | acceleration, deg/s² | jerk, deg/s³ |\n|---|---|---|---|---|\n";
    for (axis, limits) in model.limits.iter().enumerate() {
        let range = format!(
            "{} to {}",
            short(limits.position.lower),
            short(limits.position.upper)
        );
        let [velocity, acceleration, jerk] =
            [limits.velocity, limits.acceleration, limits.jerk].map(short);
        table += &format!("| {axis} | {range} | {velocity} | {acceleration} | {jerk} |\n");
    }
    table
}

#[test]
fn the_cells_in_the_manual_are_good() {
    let manual = manual();
    let mut blocks = manual
        .split("```toml\n")
        .skip(1)
        .map(|rest| rest.split("```").next().unwrap_or(""));
    assert!(blocks.clone().count() >= 3);
    assert!(blocks.all(|text| {
        Cell::parse("devices.md", text)
            .map_err(|errors| eprintln!("{errors}"))
            .is_ok()
    }));
}
