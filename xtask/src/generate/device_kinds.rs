//! Generator of the chapter on kinds of devices, from the kinds of the simulator.

use std::fmt::Write;

use rpi_device::PortKind;
use rpi_sim::cell::KindInfo;
use rpi_sim::{Cell, PortInfo, SmallKind};

use super::GENERATED_NOTICE;

const INTRODUCTION: &str = "\
# Kinds of devices

A cell names the kind of each device by the key `kind`. A program names its type. The types are in the modules `motion`, `io` and
`devices` of the [standard library](library.md). [Devices and cells](devices.md) describes arms, inputs and outputs, and platforms.

| kind | device | type |
|---|---|---|
";

pub(super) fn chapter() -> String {
    let mut out = format!("{GENERATED_NOTICE}{INTRODUCTION}");
    for kind in Cell::kinds() {
        let types: Vec<String> = kind
            .device_types
            .iter()
            .map(|ty| format!("`{ty}`"))
            .collect();
        let types = types.join(", ");
        let _ = writeln!(out, "| {} | {} | {types} |", link(&kind), kind.title);
    }
    for kind in Cell::kinds() {
        if let Some(small) = kind.small() {
            section(&mut out, small, &kind.ports());
        }
    }
    out
}

/// Returns the name of a kind of device in Markdown, with a link to the section that describes the kind.
fn link(kind: &KindInfo) -> String {
    match kind.small() {
        Some(small) => format!("[`{}`](#{})", small.name, small.name),
        None => format!("[`{}`](devices.md#celltoml)", kind.name),
    }
}

fn section(out: &mut String, kind: &SmallKind, ports: &[PortInfo]) {
    let _ = write!(out, "\n## {}\n\n{}\n\n", kind.name, kind.description);
    out.push_str("| key | value | default |\n|---|---|---|\n");
    for key in kind.key_infos() {
        let _ = writeln!(
            out,
            "| `{}` | {} | {} |",
            key.name, key.description, key.default
        );
    }
    out.push_str("\n| port | kind | type | indexed | meaning |\n|---|---|---|---|---|\n");
    for port in ports {
        let indexed = if port.indexed { "yes" } else { "" };
        let kind = kind_word(port.kind);
        let _ = writeln!(
            out,
            "| `{}` | {kind} | {} | {indexed} | {} |",
            port.name, port.ty, port.meaning
        );
    }
}

fn kind_word(kind: PortKind) -> &'static str {
    match kind {
        PortKind::Sensor => "sensor",
        PortKind::Actuator => "actuator",
        PortKind::Function => "function",
    }
}
