//! Tests of the registry against the catalogue of the reference system.

use rpi_image::{Fallback, ParamType, PortType, PrimDesc, Scalar};
use rpi_prims::differences::IGNORED_IN_PORTS;
use rpi_prims::{PrimId, registry};
use std::collections::BTreeSet;

/// In-ports that the reference system declares but ignores.
const IGNORED: [(&str, &str); 2] = [("IO::OutBool", "inActive"), ("IO::OutReal", "inActive")];

/// Types that are not supported: field buses of single vendors, and names registered by mistake or without code.
const FOREIGN: [&str; 4] = [
    "schunkwsg::",
    "KUKA::youBot::",
    "KUKA:LWR::",
    "PreviousNetResult",
];

fn catalogue(file: &str) -> Option<String> {
    let path = rpi_testkit::external_data_path(&format!("reference/catalogue/{file}"))?;
    Some(std::fs::read_to_string(path).expect("a readable file"))
}

#[test]
fn all_types_of_the_reference_are_registered() {
    let Some(names) = catalogue("all-type-names.txt") else {
        return;
    };
    let ours = |name: &&str| !FOREIGN.iter().any(|foreign| name.starts_with(foreign));
    let missing: Vec<&str> = names
        .lines()
        .map(str::trim)
        .filter(|name| !name.is_empty())
        .filter(ours)
        .filter(|name| PrimId::from_name(name).is_none())
        .collect();
    assert!(missing.is_empty(), "{} missing: {missing:?}", missing.len());
}

#[test]
fn ports_and_parameters_are_those_of_the_reference() {
    let Some(table) = catalogue("javarcc-registered.tsv") else {
        return;
    };
    let mut wrong = Vec::new();
    for line in table.lines().skip(1) {
        let columns: Vec<&str> = line.split('\t').collect();
        let desc = PrimId::from_name(columns[0]).expect("registered").desc();
        check_inputs(desc, columns[1], &mut wrong);
        check_outputs(desc, columns[2], &mut wrong);
        check_params(desc, columns.get(3).copied().unwrap_or(""), &mut wrong);
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

fn items(list: &str) -> impl Iterator<Item = (&str, &str)> {
    list.split(", ").filter_map(|item| item.split_once(':'))
}

fn check_inputs(desc: &PrimDesc, list: &str, wrong: &mut Vec<String>) {
    for (name, ty) in items(list) {
        let known = desc.input(name).map(|k| desc.inputs[k].ty);
        let left_out =
            IGNORED.contains(&(desc.name, name)) || IGNORED_IN_PORTS.contains(&(desc.name, name));
        if known != port_type(ty) && !left_out && desc.name != "Core::IntArrayIsNull" {
            wrong.push(format!("{} {name}: {ty}, ours {known:?}", desc.name));
        }
    }
}

fn check_outputs(desc: &PrimDesc, list: &str, wrong: &mut Vec<String>) {
    for (name, ty) in items(list) {
        let known = desc.output(name).map(|k| desc.outputs[k].ty);
        if known != port_type(ty) && desc.name != "Core::IntArrayIsNull" {
            wrong.push(format!("{} {name}: {ty}, ours {known:?}", desc.name));
        }
    }
    let (ours, theirs) = (desc.outputs.len(), items(list).count());
    if ours != theirs {
        wrong.push(format!("{} has {ours} outputs, not {theirs}", desc.name));
    }
}

fn check_params(desc: &PrimDesc, list: &str, wrong: &mut Vec<String>) {
    for (name, _) in items(list) {
        if desc.param(name).is_none() && desc.in_port_of_param(name).is_none() {
            wrong.push(format!("{} has no parameter {name}", desc.name));
        }
    }
}

fn port_type(text: &str) -> Option<PortType> {
    let element = text
        .strip_prefix("ArrayType<")
        .and_then(|t| t.strip_suffix('>'))
        .or_else(|| text.strip_suffix("Array"));
    Some(match element {
        Some(element) => PortType::Array(scalar(element)?),
        None if text == "MutableMatrix" => PortType::Matrix,
        None => PortType::Scalar(scalar(text)?),
    })
}

fn scalar(text: &str) -> Option<Scalar> {
    Some(match text {
        "bool" => Scalar::Bool,
        "int" => Scalar::Int,
        "double" => Scalar::Real,
        "Long" => Scalar::Time,
        "Vector" => Scalar::Vector,
        "Rotation" => Scalar::Rotation,
        "Frame" => Scalar::Pose,
        "Twist" => Scalar::Twist,
        "Wrench" => Scalar::Wrench,
        _ => return None,
    })
}

#[test]
fn names_are_sorted_and_found() {
    for (k, prim) in registry().iter().enumerate() {
        assert_eq!(
            PrimId::from_name(prim.desc.name).map(|id| usize::from(id.0)),
            Some(k)
        );
    }
    assert!(PrimId::from_name("Core::Nothing").is_none());
}

#[test]
fn names_within_a_primitive_are_different() {
    for desc in registry().iter().map(|p| &p.desc) {
        let mut params = BTreeSet::new();
        let mut fresh =
            |name: &'static str| assert!(params.insert(name), "{}: {name} twice", desc.name);
        desc.params.iter().for_each(|p| fresh(p.name));
        for input in desc.inputs {
            match input.fallback {
                Fallback::Param(name, _) => fresh(name),
                Fallback::ComposedOfParams(names, _) => {
                    names.iter().for_each(|(name, _)| fresh(name))
                }
                Fallback::Required | Fallback::AbsentValue => {}
            }
        }
        let ports: BTreeSet<_> = desc.inputs.iter().map(|p| p.name).collect();
        assert_eq!(ports.len(), desc.inputs.len(), "{}", desc.name);
    }
}

#[test]
fn defaults_have_the_type_of_their_parameter() {
    for desc in registry().iter().map(|p| &p.desc) {
        for param in desc.params {
            let ParamType::Scalar(scalar) = param.ty else {
                continue;
            };
            let value = param.default.value(scalar.into());
            let matches = value.is_none_or(|v| v.ty() == Some(scalar.into()));
            assert!(matches, "{} {}", desc.name, param.name);
        }
        for input in desc.inputs {
            let (Fallback::Param(name, default), PortType::Scalar(scalar)) =
                (input.fallback, input.ty)
            else {
                continue;
            };
            let value = default.value(scalar.into());
            let matches = value.is_none_or(|v| v.ty() == Some(scalar.into()));
            assert!(matches, "{} {name}", desc.name);
        }
    }
}

#[test]
fn roles_and_code_go_together() {
    for prim in registry() {
        let computes = prim.desc.role == rpi_image::Role::Compute;
        let has_code = prim.total.is_some() || prim.optional.is_some();
        assert_eq!(computes, has_code, "{}", prim.desc.name);
        assert!(
            prim.desc.doc.trim().ends_with('.'),
            "{}: {}",
            prim.desc.name,
            prim.desc.doc
        );
    }
}
