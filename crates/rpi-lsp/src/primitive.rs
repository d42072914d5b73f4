//! Primitives rendered as declarations of the language.

use rpi_image::{Fallback, InPort, Param, ParamType, PortType, PrimDesc};

/// Returns the declaration of a primitive in the syntax of the language: name, static parameters, in-ports and
/// out-ports.
pub(crate) fn signature(desc: &PrimDesc) -> String {
    let statics = static_parameters(desc).into_iter();
    let statics: Vec<String> = statics.map(|(_, text)| text).collect();
    let inputs = desc.inputs.iter().map(|p| (p.name, p.ty));
    let outputs = desc.outputs.iter().map(|p| (p.name, p.ty));
    let statics = match statics.is_empty() {
        true => String::new(),
        false => format!(" <<{}>>", statics.join("; ")),
    };
    let name = desc.name;
    format!(
        "primitive {name}{statics}\n  ({})\n  returns ({})",
        ports(inputs),
        ports(outputs)
    )
}

/// Returns the static parameters of a primitive: the name and the declaration `name: type` of each.
pub(crate) fn static_parameters(desc: &PrimDesc) -> Vec<(&'static str, String)> {
    let fallbacks = desc.inputs.iter().filter_map(fallback_param);
    let params = desc.params.iter().map(|one| (one.name, param(one)));
    fallbacks.chain(params).collect()
}

/// Returns the in-ports of a primitive: the name and the declaration `name: type` of each.
pub(crate) fn in_ports(desc: &PrimDesc) -> Vec<(&'static str, String)> {
    let text = |port: &InPort| format!("{}: {}", port.name, port_type(port.ty));
    desc.inputs
        .iter()
        .map(|port| (port.name, text(port)))
        .collect()
}

/// Returns the documentation of a primitive, without the space at the start of each line that the Rust doc comment
/// contains.
pub(crate) fn doc(desc: &PrimDesc) -> String {
    let lines = desc.doc.trim().lines();
    let lines: Vec<&str> = lines
        .map(|line| line.strip_prefix(' ').unwrap_or(line))
        .collect();
    lines.join("\n")
}

/// Returns the name and the declaration `name: type` of the static parameter that replaces an unconnected in-port; `None` if no
/// parameter does.
fn fallback_param(port: &InPort) -> Option<(&'static str, String)> {
    match port.fallback {
        Fallback::Param(name, _) => Some((name, format!("{name}: {}", port_type(port.ty)))),
        _ => None,
    }
}

fn param(param: &Param) -> String {
    let ty = match param.ty {
        ParamType::Scalar(scalar) => scalar.to_string(),
        ParamType::Array(scalar) => format!("{scalar}^n"),
        ParamType::Str => "text".to_owned(),
    };
    format!("{}: {ty}", param.name)
}

fn ports(ports: impl Iterator<Item = (&'static str, PortType)>) -> String {
    let ports: Vec<String> = ports
        .map(|(name, ty)| format!("{name}: {}", port_type(ty)))
        .collect();
    ports.join("; ")
}

fn port_type(ty: PortType) -> String {
    match ty {
        PortType::Scalar(scalar) => scalar.to_string(),
        PortType::Array(scalar) => format!("{scalar}^n"),
        PortType::Matrix => "matrix".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rpi_prims::{PrimId, registry};

    #[test]
    fn a_primitive_reads_as_it_would_be_declared() {
        let desc = PrimId::from_name("Core::DoubleAdd").unwrap().desc();
        let expected = "primitive Core::DoubleAdd <<First: real; Second: real>>\n  \
                        (inFirst: real; inSecond: real)\n  returns (outValue: real)";
        assert_eq!(signature(desc), expected);
    }

    #[test]
    fn every_primitive_has_words() {
        for prim in registry() {
            assert!(!doc(&prim.desc).is_empty(), "{}", prim.desc.name);
        }
    }
}
