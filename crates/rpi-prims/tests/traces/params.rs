//! Conversion of the parameters of a recorded net to values, and checks of their names.

use crate::net;
use crate::text;
use crate::trace::Trace;
use rpi_image::{ParamType, PortType, Type, Value};
use rpi_prims::Prim;
use rpi_prims::differences;

pub(crate) fn port_param(ty: PortType) -> ParamType {
    match ty {
        PortType::Scalar(s) => ParamType::Scalar(s),
        PortType::Array(s) => ParamType::Array(s),
        PortType::Matrix => ParamType::Str,
    }
}

pub(crate) fn params(prim: &Prim, net: &net::Prim) -> Result<Vec<Value>, String> {
    let one = |p: &rpi_image::Param| {
        let given = net.params.iter().find(|(name, _)| name == p.name);
        parameter(p.ty, given.map(|(_, text)| text.as_str()), p.default)
    };
    prim.desc.params.iter().map(one).collect()
}

pub(crate) fn parameter(
    ty: ParamType,
    text: Option<&str>,
    default: rpi_image::PortDefault,
) -> Result<Value, String> {
    let ty = match (ty, text) {
        (ParamType::Scalar(s), _) => Type::Scalar(s),
        (ParamType::Array(s), text) => Type::Array(s, text.map_or(0, text::array_len)),
        (ParamType::Str, text) => return Ok(Value::Str(text.unwrap_or_default().into())),
    };
    match text {
        None => default
            .value(ty)
            .ok_or_else(|| "a parameter is missing".into()),
        Some(text) => {
            let cells = text::cells(ty, text).ok_or_else(|| format!("not a {ty}: {text}"))?;
            let cells = cells.into();
            Ok(Value::Slots { ty, cells })
        }
    }
}

pub(crate) fn check_names(prim: &Prim, net: &net::Prim) -> Result<(), String> {
    let extra = |name: &str| differences::IGNORED_IN_PORTS.contains(&(prim.desc.name, name));
    let unknown_port = net
        .inputs
        .iter()
        .find(|(name, _)| prim.desc.input(name).is_none() && !extra(name));
    let unknown_param = net.params.iter().find(|(name, _)| {
        prim.desc.param(name).is_none() && prim.desc.in_port_of_param(name).is_none()
    });
    match unknown_port.or(unknown_param) {
        Some((name, _)) => Err(format!("{} has no {name}", net.ty)),
        None => Ok(()),
    }
}

pub(crate) fn check_len(ty: Type, name: &str, trace: &Trace) -> Result<(), String> {
    let Type::Array(_, len) = ty else {
        return Ok(());
    };
    let recorded = trace.ports.get(name).into_iter().flatten().flatten().next();
    match recorded.map(|text| text::array_len(text)) {
        Some(n) if n != len => Err(format!("{name} has {len} values, recorded are {n}")),
        _ => Ok(()),
    }
}
