//! Declarations of the C file: structs, `reset`, variables and outputs.

use super::literals::literal;
use super::names::{identifier, indexed};
use super::types::{c_type, scalar};
use super::variables::Variables;
use crate::flat_net::ScopeId;
use crate::passes::traversal::ops_in_order;
use crate::registers::{Region, Register};
use rpi_image::Scalar;
use rpi_image::image::{CommandEnd, Signal};
use std::fmt::Write;

/// Writes the declarations of the C structs `Inputs`, `Outputs` and `State` to `out`. `state` lists the state variables
/// of primitives, as C type and name.
pub(super) fn structs(
    variables: &Variables<'_>,
    state: &[(&'static str, String)],
    out: &mut String,
) -> std::fmt::Result {
    out.push_str("typedef struct {\n");
    let mut any = false;
    for signal in external(variables) {
        any = true;
        members(variables, out, Register(signal.start), scalar(signal.ty))?;
        if variables.flat.registers.region(Register(signal.present)) != Region::Constant {
            members(variables, out, Register(signal.present), Scalar::Bool)?;
        }
    }
    out.push_str(if any {
        "} Inputs;\n\n"
    } else {
        "  char none;\n} Inputs;\n\n"
    });
    out.push_str("typedef struct {\n");
    for (name, ty, cells) in published(variables) {
        for k in 0..cells.max(1) {
            writeln!(out, "  {ty} {};", indexed(&name, cells, k))?;
        }
    }
    out.push_str("  bool ends;\n} Outputs;\n\ntypedef struct {\n");
    for slot in variables.kept() {
        for k in 0..variables.flat.registers.size(slot) {
            let name = variables.name(slot, k);
            let ty = c_type(variables.ty(slot));
            writeln!(out, "  {ty} {};", name.trim_start_matches("state->"))?;
        }
    }
    for (ty, name) in state {
        writeln!(out, "  {ty} {name};")?;
    }
    out.push_str("  char none;\n} State;\n\n");
    Ok(())
}

fn members(
    variables: &Variables<'_>,
    out: &mut String,
    slot: Register,
    ty: Scalar,
) -> std::fmt::Result {
    for k in 0..variables.flat.registers.size(slot) {
        let name = variables.name(slot, k);
        writeln!(out, "  {} {};", c_type(ty), name.trim_start_matches("in->"))?;
    }
    Ok(())
}

/// Returns the signals that the caller of the C function sets before each cycle: sensors, inputs, and flows that the
/// core provides.
fn external(variables: &Variables<'_>) -> Vec<Signal> {
    let t = &variables.flat.tables;
    let inputs = t
        .inputs
        .iter()
        .flat_map(|i| std::iter::once(i.value).chain(i.last_updated));
    let sensors = t.sensors.iter().map(|s| s.0.value);
    sensors
        .chain(inputs)
        .chain(t.flows.iter().map(|f| f.value))
        .collect()
}

/// Returns the fields of the C struct of outputs, as name, C type and number of slots: exports and set-points, each
/// preceded by a `bool` for its presence.
fn published(variables: &Variables<'_>) -> Vec<(String, &'static str, u32)> {
    let mut all = Vec::new();
    for export in &variables.flat.tables.exports {
        let name = identifier(&export.key);
        all.push((format!("{name}_present"), "bool", 1));
        all.push((
            name,
            c_type(scalar(export.value.ty)),
            export.value.ty.slots(),
        ));
    }
    for (k, actuator) in variables.flat.tables.actuators.iter().enumerate() {
        let name = format!("set_point_{k}");
        all.push((format!("{name}_present"), "bool", 1));
        all.push((
            name,
            c_type(scalar(actuator.port.ty)),
            actuator.port.ty.slots(),
        ));
    }
    all
}

/// Writes the C function `reset`, which sets the state to that before the first cycle, to `out`.
pub(super) fn reset(variables: &Variables<'_>, out: &mut String) -> std::fmt::Result {
    out.push_str("/* The state before the first cycle. */\nvoid reset(State *state) {\n  *state = (State){0};\n");
    for slot in variables.kept() {
        let mut content = Vec::new();
        variables.flat.registers.append_initial(slot, &mut content);
        for (k, bits) in (0..).zip(content).filter(|c| c.1 != 0) {
            let value = literal(bits, variables.ty(slot));
            writeln!(out, "  {} = {value};", variables.name(slot, k))?;
        }
    }
    out.push_str("}\n");
    Ok(())
}

/// Writes to `out` the declarations, with value 0, of the C variables that are assigned only inside an `if`, and marks
/// all set-points as absent.
pub(super) fn guarded_variables(variables: &Variables<'_>, out: &mut String) -> std::fmt::Result {
    for (number, scope) in ops_in_order(variables.flat) {
        if scope == ScopeId::ROOT {
            continue;
        }
        for slot in variables.flat.writes(variables.flat.ops[number as usize]) {
            for k in 0..variables.flat.registers.size(slot) {
                let ty = c_type(variables.ty(slot));
                writeln!(out, "  {ty} {} = 0;", variables.name(slot, k))?;
            }
        }
    }
    for k in 0..variables.flat.tables.actuators.len() {
        writeln!(out, "  out->set_point_{k}_present = false;")?;
    }
    Ok(())
}

/// Writes to `out` the C assignments of the exports and of the end of the command to the fields of the output struct.
pub(super) fn outputs(variables: &Variables<'_>, out: &mut String) -> std::fmt::Result {
    for export in &variables.flat.tables.exports {
        let (name, s) = (identifier(&export.key), export.value);
        let present = variables.bool(Register(s.present));
        writeln!(out, "  out->{name}_present = {present};")?;
        for k in 0..s.ty.slots() {
            let value = variables.cell(Register(s.start), k, scalar(s.ty));
            writeln!(out, "  out->{} = {value};", indexed(&name, s.ty.slots(), k))?;
        }
    }
    let ends: Vec<Signal> = match &variables.flat.tables.end {
        CommandEnd::Results(results) => results.iter().map(|r| r.condition).collect(),
        CommandEnd::Ports { terminate, .. } => terminate.iter().copied().collect(),
    };
    let asks = ends.iter().map(|s| {
        format!(
            "({} && {})",
            variables.bool(Register(s.present)),
            variables.bool(Register(s.start))
        )
    });
    let asks: Vec<String> = std::iter::once("false".to_owned()).chain(asks).collect();
    writeln!(out, "  out->ends = {};", asks.join(" || "))
}
