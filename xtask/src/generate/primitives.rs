//! Generator of the chapter on primitives, from the registry.

use std::fmt::Write;

use rpi_image::{Fallback, ParamType, PortType, PrimDesc};
use rpi_prims::registry;

use super::GENERATED_NOTICE;

pub(super) fn chapter() -> String {
    let mut out =
        format!("{GENERATED_NOTICE}# Primitives\n\nBuilding blocks of nets, by registered name. ");
    out.push_str("An in-port listed with a parameter uses that parameter if it is not connected. ");
    out.push_str(
        "The work bound is the number of elementary operations in one cycle; an addition of two reals is one.\n",
    );
    let mut module = "";
    for prim in registry() {
        let here = prim.desc.name.split("::").next().unwrap_or("");
        if here != module {
            module = here;
            let _ = write!(out, "\n## {module}\n");
        }
        out.push_str(&entry(&prim.desc));
    }
    out
}

fn entry(desc: &PrimDesc) -> String {
    let mut out = format!("\n### {}\n\n{}\n\n", desc.name, unindent(desc.doc));
    let inputs = desc.inputs.iter().map(|port| match port.fallback {
        Fallback::Param(name, _) => format!("`{}: {}` or `{name}`", port.name, port_type(port.ty)),
        _ => format!("`{}: {}`", port.name, port_type(port.ty)),
    });
    line(&mut out, "In", inputs);
    let params = desc
        .params
        .iter()
        .map(|param| format!("`{}: {}`", param.name, param_type(param.ty)));
    line(&mut out, "Parameters", params);
    line(
        &mut out,
        "Out",
        desc.outputs
            .iter()
            .map(|port| format!("`{}: {}`", port.name, port_type(port.ty))),
    );
    let fault = if desc.may_fault { "; may fault" } else { "" };
    let _ = writeln!(out, "- Work: {}{fault}", desc.work);
    out
}

fn line(out: &mut String, head: &str, items: impl Iterator<Item = String>) {
    let items: Vec<String> = items.collect();
    if !items.is_empty() {
        let _ = writeln!(out, "- {head}: {}", items.join(", "));
    }
}

/// Returns a doc comment without the space at the start of each line, which follows the `///`.
fn unindent(doc: &str) -> String {
    let lines: Vec<&str> = doc
        .trim()
        .lines()
        .map(|line| line.strip_prefix(' ').unwrap_or(line))
        .collect();
    lines.join("\n")
}

fn port_type(ty: PortType) -> String {
    match ty {
        PortType::Scalar(scalar) => scalar.to_string(),
        PortType::Array(scalar) => format!("{scalar}^n"),
        PortType::Matrix => "matrix".to_owned(),
    }
}

fn param_type(ty: ParamType) -> String {
    match ty {
        ParamType::Scalar(scalar) => scalar.to_string(),
        ParamType::Array(scalar) => format!("{scalar}^n"),
        ParamType::Str => "text".to_owned(),
    }
}
