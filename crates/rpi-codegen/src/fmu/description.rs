//! Descriptions of a unit in XML.

use crate::c_type::CType;
use crate::identifiers::Names;
use crate::ports::{Direction, Field, Interface, Meaning};
use rpi_image::image::Image;
use std::collections::BTreeSet;

/// Returns the text of `modelDescription.xml`.
pub(super) fn model(image: &Image, name: &str, interface: &Interface, token: &str) -> String {
    let period = image.period_ns as f64 / 1e9;
    let description = escaped(&image.name);
    let mut names = Names::default();
    names.unique("time");
    let variables = (1..).zip(&interface.fields);
    let variables: String = variables
        .map(|(reference, field)| {
            // An input and an output may have the same name in C, as fields of two structs.
            variable(image, reference, field, &names.unique(&field.name))
        })
        .collect();
    let outputs = (1..).zip(&interface.fields);
    let outputs = outputs.filter(|(_, field)| field.direction == Direction::Output);
    let outputs: Vec<u32> = outputs.map(|(reference, _): (u32, _)| reference).collect();
    let rows = |element: &str| -> String {
        let rows = outputs.iter();
        rows.map(|reference| format!("    <{element} valueReference=\"{reference}\"/>\n"))
            .collect()
    };
    let units = units(interface);
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <fmiModelDescription fmiVersion=\"3.0\" modelName=\"{name}\" instantiationToken=\"{token}\" description=\"{description}\" generationTool=\"rpic\">\n\
         \x20 <CoSimulation modelIdentifier=\"{name}\" canHandleVariableCommunicationStepSize=\"true\" fixedInternalStepSize=\"{period:?}\" canGetAndSetFMUState=\"true\" canSerializeFMUState=\"true\"/>\n\
         {units}\x20 <LogCategories>\n    <Category name=\"error\" description=\"faults of cycles and wrong calls\"/>\n  </LogCategories>\n\
         \x20 <DefaultExperiment startTime=\"0.0\" stepSize=\"{period:?}\"/>\n\
         \x20 <ModelVariables>\n    <Float64 name=\"time\" valueReference=\"0\" causality=\"independent\" variability=\"continuous\" description=\"time in s\"/>\n{variables}  </ModelVariables>\n\
         \x20 <ModelStructure>\n{}{}  </ModelStructure>\n\
         </fmiModelDescription>\n",
        rows("Output"),
        rows("InitialUnknown"),
    )
}

/// Returns the list of the units of all variables; empty if there are none.
fn units(interface: &Interface) -> String {
    let units = interface.fields.iter().map(|field| field.unit.as_str());
    let units: BTreeSet<&str> = units.filter(|unit| !unit.is_empty()).collect();
    if units.is_empty() {
        return String::new();
    }
    let rows = units.iter();
    let rows: String = rows
        .map(|unit| format!("    <Unit name=\"{}\"/>\n", escaped(unit)))
        .collect();
    format!("  <UnitDefinitions>\n{rows}  </UnitDefinitions>\n")
}

/// Returns the text of `sources/buildDescription.xml`.
pub(super) fn build(name: &str) -> String {
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <fmiBuildDescription fmiVersion=\"3.0\">\n\
         \x20 <BuildConfiguration modelIdentifier=\"{name}\">\n    <SourceFileSet language=\"C99\">\n      <SourceFile name=\"{name}.c\"/>\n    </SourceFileSet>\n  </BuildConfiguration>\n\
         </fmiBuildDescription>\n"
    )
}

fn variable(image: &Image, reference: u32, field: &Field, name: &str) -> String {
    let element = match field.ty {
        CType::Bool => "Boolean",
        CType::Int => "Int64",
        CType::Real => "Float64",
        CType::Word => "UInt64",
    };
    let (causality, start) = match field.direction {
        Direction::Input => ("input", format!(" start=\"{}\"", start(image, field))),
        Direction::Output => ("output", String::new()),
    };
    let unit = match field.unit.as_str() {
        "" => String::new(),
        unit => format!(" unit=\"{}\"", escaped(unit)),
    };
    let head = format!(
        "    <{element} name=\"{}\" valueReference=\"{reference}\" causality=\"{causality}\" variability=\"discrete\" description=\"{}\"{unit}{start}",
        escaped(name),
        escaped(&field.text),
    );
    match field.len {
        1 => format!("{head}/>\n"),
        len => format!("{head}>\n      <Dimension start=\"{len}\"/>\n    </{element}>\n"),
    }
}

/// Returns the initial values of an input, separated by spaces.
fn start(image: &Image, field: &Field) -> String {
    let first = match field.meaning {
        Meaning::External(slot) | Meaning::ExternalPresence(slot) => Some(slot),
        _ => None,
    };
    let values = (0..field.len).map(|k| {
        let bits = first.map_or(0, |slot| initial(image, slot + k));
        match field.ty {
            CType::Bool => (bits != 0).to_string(),
            CType::Int => bits.cast_signed().to_string(),
            CType::Word => bits.to_string(),
            CType::Real => real(f64::from_bits(bits)),
        }
    });
    values.collect::<Vec<_>>().join(" ")
}

fn initial(image: &Image, slot: u32) -> u64 {
    let found = image.init.binary_search_by_key(&slot, |entry| entry.0);
    found.map_or(0, |k| image.init[k].1)
}

/// Returns a real in the notation of XML schemas, in which infinity is `INF`.
fn real(value: f64) -> String {
    match value.is_infinite() {
        true if value > 0.0 => "INF".to_owned(),
        true => "-INF".to_owned(),
        false => format!("{value:?}"),
    }
}

/// Returns a text as the content of an XML attribute.
fn escaped(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}
