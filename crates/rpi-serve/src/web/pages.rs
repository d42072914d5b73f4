//! HTTP pages about the server: modules, types, devices, sessions, nets.

use std::collections::BTreeMap;
use std::sync::Arc;

use http::StatusCode;
use rpi_image::{PortType, PrimDesc, Scalar};
use rpi_prims::registry;

use super::response::Response;
use super::xml::XmlWriter;
use crate::state::{ApiError, SharedState};

/// Index page with all paths of the server, shown at `/`.
const INDEX: &str = "RPI control core\n\n\
    /modules   the primitives, with ports and parameters\n\
    /types     the types of values\n\
    /devices   the devices; POST adds and removes simulated ones\n\
    /sessions  the open sessions\n\
    /nets      the commands; of one /nets/<name>/dio (its text), /xml (its parts), /debug (its inputs and exports), /stats\n\
    /extensions  groups of primitives\n\
    /log       the latest log lines\n\
    /metrics   counters and histograms for monitoring, as OpenMetrics text\n\
    /eval      POST: one cycle of a net\n\
    /DirectIO  websocket: the DirectIO protocol 2.0\n\
    /rpc       websocket: JSON-RPC 2.0\n";

/// Returns the page whose path has these segments, or an error response.
pub(crate) fn page(shared: &SharedState, parts: &[&str]) -> Response {
    match parts {
        [] => Response::text(INDEX.to_owned()),
        ["modules"] => Response::xml(modules()),
        ["types"] => Response::xml(types()),
        ["devices"] => Response::xml(devices(shared)),
        ["sessions"] => Response::xml(sessions(shared)),
        ["nets"] => Response::xml(nets(shared)),
        ["extensions"] => Response::xml(extensions()),
        ["log"] => Response::text(shared.lock().log.text()),
        ["nets", name, "dio"] => page_or_404(text(shared, name), Response::text),
        ["nets", name, "xml"] => page_or_404(net_structure(shared, name), Response::xml),
        ["nets", name, "debug"] => page_or_404(debug(shared, name), Response::xml),
        ["nets", name, "stats"] => page_or_404(stats(shared, name), Response::xml),
        ["rpc" | "DirectIO"] => Response::error(
            StatusCode::UPGRADE_REQUIRED,
            "this path is a websocket, not a page",
        ),
        _ => Response::error(
            StatusCode::NOT_FOUND,
            "there is no such page; / lists all pages",
        ),
    }
}

fn page_or_404(page: Result<String, ApiError>, kind: fn(String) -> Response) -> Response {
    match page {
        Ok(body) => kind(body),
        Err(why) => Response::error(StatusCode::NOT_FOUND, &why.to_string()),
    }
}

fn modules() -> String {
    let mut xml = XmlWriter::new("modules");
    for prim in registry() {
        module(&mut xml, &prim.desc);
    }
    xml.finish()
}

fn module(xml: &mut XmlWriter, desc: &PrimDesc) {
    xml.begin("module", &[("name", desc.name)]);
    xml.leaf("description", &[], desc.doc.trim());
    for port in desc.inputs {
        let ty = type_name(port.ty);
        xml.leaf("inport", &[("name", port.name), ("type", &ty)], "");
    }
    for port in desc.outputs {
        let ty = type_name(port.ty);
        xml.leaf("outport", &[("name", port.name), ("type", &ty)], "");
    }
    for param in desc.params {
        xml.leaf("parameter", &[("name", param.name)], "");
    }
    xml.end();
}

/// Returns the name of a scalar type in the DirectIO protocol, such as `Core::double` for a real.
fn scalar_name(scalar: Scalar) -> String {
    let (module, name) = match scalar {
        Scalar::Bool => ("Core", "bool"),
        Scalar::Int => ("Core", "int"),
        Scalar::Real => ("Core", "double"),
        Scalar::Time => ("Core", "nsecs"),
        Scalar::Vector => ("World", "Vector"),
        Scalar::Rotation => ("World", "Rotation"),
        Scalar::Pose => ("World", "Frame"),
        Scalar::Twist => ("World", "Twist"),
        Scalar::Wrench => ("World", "Wrench"),
    };
    format!("{module}::{name}")
}

fn type_name(ty: PortType) -> String {
    match ty {
        PortType::Scalar(scalar) => scalar_name(scalar),
        PortType::Array(scalar) => format!("{}Array", scalar_name(scalar)),
        PortType::Matrix => ["Core", "matrix"].join("::"),
    }
}

fn types() -> String {
    let mut xml = XmlWriter::new("types");
    for scalar in Scalar::ALL {
        xml.leaf("type", &[("name", &scalar_name(scalar))], "");
    }
    xml.finish()
}

fn devices(shared: &SharedState) -> String {
    let mut xml = XmlWriter::new("devices");
    for info in shared.lock().devices.all() {
        xml.begin("device", &[("name", &info.name), ("type", &info.kind)]);
        for (interface, parameters) in &info.interfaces {
            xml.begin("interface", &[("name", interface)]);
            for (key, value) in parameters {
                xml.leaf("parameter", &[("name", key), ("value", value)], "");
            }
            xml.end();
        }
        xml.end();
    }
    xml.finish()
}

fn sessions(shared: &SharedState) -> String {
    let mut xml = XmlWriter::new("sessions");
    for (name, owner) in shared.lock().objects.sessions.all() {
        xml.leaf("session", &[("name", &name), ("description", owner)], "");
    }
    xml.finish()
}

fn nets(shared: &SharedState) -> String {
    let mut xml = XmlWriter::new("nets");
    for (name, record) in shared.lock().objects.commands.all() {
        let state = format!("{:?}", record.status.phase);
        let about = [
            ("name", name.as_str()),
            ("description", &record.title),
            ("state", &state),
        ];
        xml.leaf("net", &about, "");
    }
    xml.finish()
}

fn text(shared: &SharedState, name: &str) -> Result<String, ApiError> {
    let state = shared.lock();
    let (_, record) = state.objects.commands.find(name)?;
    let origin = record.origin.as_ref();
    let none = || ApiError::Unknown(format!("text of {name}: it is part of a task"));
    Ok(origin.ok_or_else(none)?.text.to_string())
}

/// Returns the structure of a command's net as XML. The net is compiled again from its text, without locking the state.
fn net_structure(shared: &SharedState, name: &str) -> Result<String, ApiError> {
    let state = shared.lock();
    let origin = state.objects.commands.find(name)?.1.origin.clone();
    let none = || ApiError::Unknown(format!("text of {name}: it is part of a task"));
    let (source, timeout) = (origin.ok_or_else(none)?, state.limits.request_timeout);
    let compiler = Arc::clone(&state.compiler);
    drop(state);
    let page = compiler.structure(source, timeout);
    page.map_err(ApiError::Rejected)
}

/// Returns the inputs of a command and its latest exported values as XML.
fn debug(shared: &SharedState, name: &str) -> Result<String, ApiError> {
    let state = shared.lock();
    let (_, record) = state.objects.commands.find(name)?;
    let mut xml = XmlWriter::new("debug");
    xml.leaf("state", &[], &format!("{:?}", record.status.phase));
    xml.leaf("cycles", &[], &record.cycles().to_string());
    for input in record.image.iter().flat_map(|image| &image.inputs) {
        let ty = input.value.ty.to_string();
        xml.leaf("input", &[("key", &input.key), ("type", &ty)], "");
    }
    for (key, value) in record.values() {
        xml.leaf("export", &[("key", &key)], &value);
    }
    Ok(xml.finish())
}

/// Returns as XML the groups of primitives (the part of their names before `::`) with the number of primitives in each.
fn extensions() -> String {
    let mut groups: BTreeMap<&str, usize> = BTreeMap::new();
    for prim in registry() {
        let group = prim.desc.name.split_once("::");
        *groups.entry(group.map_or("", |g| g.0)).or_default() += 1;
    }
    let mut xml = XmlWriter::new("extensions");
    for (name, count) in groups {
        let about = [("name", name), ("modules", &count.to_string())];
        xml.leaf("extension", &about, "");
    }
    xml.finish()
}

fn stats(shared: &SharedState, name: &str) -> Result<String, ApiError> {
    let state = shared.lock();
    let (_, record) = state.objects.commands.find(name)?;
    let mut xml = XmlWriter::new("stats");
    xml.leaf("cycles", &[], &record.cycles().to_string());
    xml.leaf("period", &[("unit", "ns")], &record.period_ns().to_string());
    xml.leaf("memory", &[("unit", "bytes")], &record.bytes().to_string());
    let bound = state.core.bound_ns(record).unwrap_or(0);
    xml.leaf("bound", &[("unit", "ns")], &bound.to_string());
    let overruns = record.overruns().map_or(0, |(count, _)| count);
    xml.leaf("overruns", &[], &overruns.to_string());
    Ok(xml.finish())
}
