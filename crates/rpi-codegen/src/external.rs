//! Calls of functions in C that are defined outside of the program, their declarations, and functions that stand for them.

use crate::access::Access;
use crate::c_type::CType;
use crate::statements::Emitter;
use rpi_image::Scalar;
use rpi_image::external::{ExternalFunction, ExternalPort};
use rpi_image::image::{DeviceFunction, Image, SlotRange};
use std::collections::BTreeMap;
use std::fmt::Write;

/// Values of a port among the slots of a call: the index of the port, and its slots.
pub(crate) struct PortSlots {
    pub(crate) index: usize,
    pub(crate) slots: SlotRange,
    pub(crate) kind: Scalar,
}

/// Returns the slots of each port, in the order of the declaration. `ranges` are the slots of the groups of values.
fn port_slots(ports: &[ExternalPort], ranges: &[SlotRange]) -> Vec<PortSlots> {
    let groups = ExternalFunction::group_lens(ports).zip(ranges);
    let slots = groups.flat_map(|((kind, _), range)| {
        let group = ExternalFunction::group(ports, kind);
        group.map(move |(index, offset, len)| PortSlots {
            index,
            slots: SlotRange {
                start: range.start + offset,
                len,
            },
            kind,
        })
    });
    let mut slots: Vec<PortSlots> = slots.collect();
    slots.sort_by_key(|p| p.index);
    slots
}

/// Appends the accesses of a call to the slots of its values.
pub(crate) fn accesses(
    function: &DeviceFunction,
    external: &ExternalFunction,
    out: &mut Vec<Access>,
) {
    let groups = [
        (&external.inputs, &function.arguments, false),
        (&external.outputs, &function.results, true),
    ];
    for (ports, ranges, writes) in groups {
        let typed = ExternalFunction::group_lens(ports).zip(ranges);
        out.extend(typed.map(|((kind, _), range)| {
            Access::new(range.start, range.len, Some(CType::of(kind)), writes).array()
        }));
    }
}

impl Emitter<'_> {
    /// Returns the statement that calls an external function.
    pub(crate) fn call_external(
        &mut self,
        function: &DeviceFunction,
        external: &ExternalFunction,
    ) -> Vec<String> {
        let mut arguments = Vec::new();
        for port in port_slots(&external.inputs, &function.arguments) {
            let (start, ty) = (port.slots.start, CType::of(port.kind));
            arguments.push(match external.inputs[port.index].is_array {
                true => self.array(start, port.slots.len, ty),
                false => self.variables.value(self.slots, start, ty),
            });
        }
        let results = port_slots(&external.outputs, &function.results);
        let symbol = &external.symbol;
        if let (Some(port), Some(slots)) = (external.result(), results.first()) {
            let value = format!("{symbol}({})", arguments.join(", "));
            let ty = CType::of(port.kind);
            return vec![self.assignment(slots.slots.start, ty, &value)];
        }
        let pointers = results.iter();
        arguments.extend(pointers.map(|p| self.variables.pointer(self.slots, p.slots.start)));
        vec![format!("{symbol}({});", arguments.join(", "))]
    }
}

/// Returns the external functions of an image without repetition, by their names in C, each with the index of its first
/// call.
#[must_use]
pub fn external_functions(image: &Image) -> BTreeMap<&str, (u32, &ExternalFunction)> {
    let mut all = BTreeMap::new();
    for (k, function) in (0..).zip(&image.functions) {
        if let Some(external) = &function.external {
            all.entry(external.symbol.as_str()).or_insert((k, external));
        }
    }
    all
}

/// Returns the index of the first call of the external function that a call with this index calls. Other functions of
/// an image keep their index.
#[must_use]
pub fn shared_function(image: &Image, number: usize) -> usize {
    let external = image.functions.get(number);
    let external = external.and_then(|f| f.external.as_ref());
    let first = external.and_then(|e| external_functions(image).get(e.symbol.as_str()).copied());
    first.map_or(number, |(k, _)| k as usize)
}

/// Returns the first line of the function in C without the semicolon.
fn prototype(external: &ExternalFunction) -> String {
    let mut parameters = Vec::new();
    for (k, port) in external.inputs.iter().enumerate() {
        let ty = CType::of(port.kind).name();
        parameters.push(match port.is_array {
            true => format!("const {ty} *{}", parameter("in", k)),
            false => format!("{ty} {}", parameter("in", k)),
        });
    }
    if let Some(port) = external.result() {
        let ty = CType::of(port.kind).name();
        return format!("{ty} {}({})", external.symbol, list(&parameters));
    }
    let outputs = external.outputs.iter().enumerate();
    parameters.extend(outputs.map(|(k, port)| {
        let ty = CType::of(port.kind).name();
        format!("{ty} *{}", parameter("out", k))
    }));
    format!("void {}({})", external.symbol, list(&parameters))
}

/// Names of ports may be keywords of C, so the parameters are numbered; the comment names the ports.
pub(crate) fn parameter(direction: &str, k: usize) -> String {
    format!("{direction}{}", k + 1)
}

fn list(parameters: &[String]) -> String {
    match parameters {
        [] => "void".to_owned(),
        all => all.join(", "),
    }
}

/// Appends the declaration of an external function with its description.
pub(crate) fn declaration(external: &ExternalFunction, out: &mut String) -> std::fmt::Result {
    let name = &external.name;
    writeln!(
        out,
        "/* Function {name} of the program, which the caller defines. Its results must depend only on its arguments, and it\n   must return within the cycle. It keeps no address that it gets."
    )?;
    for (k, port) in external.inputs.iter().enumerate() {
        writeln!(out, "   {}: {}", parameter("in", k), description(port))?;
    }
    for (k, port) in external.outputs.iter().enumerate() {
        match external.result() {
            Some(_) => writeln!(out, "   result: {}", description(port))?,
            None => writeln!(out, "   {}: {}", parameter("out", k), description(port))?,
        }
    }
    writeln!(out, "*/\n{};", prototype(external))
}

fn description(port: &ExternalPort) -> String {
    let text = format!("{}: {}", port.name, port.ty).replace("*/", "* /");
    match port.is_array {
        true => format!("{text}, {} values", port.len),
        false => text,
    }
}

/// Returns a definition of an external function that asks another process for its results: call number `number`.
pub(crate) fn remote_definition(external: &ExternalFunction, number: u32) -> String {
    let count = |ports: &[ExternalPort]| ports.iter().map(|p| p.len).sum::<u32>();
    let (arguments, results) = (count(&external.inputs), count(&external.outputs));
    let mut body = format!(
        "  rpi_word arguments[{}];\n  rpi_word results[{}];\n  arguments[0].integer = 0;\n",
        arguments.max(1),
        results.max(1)
    );
    body += &sent_arguments(&external.inputs);
    body +=
        &format!("  (void)driver_call({number}, arguments, {arguments}, results, {results});\n");
    body += &received_results(external);
    format!("{} {{\n{body}}}\n\n", prototype(external))
}

fn sent_arguments(ports: &[ExternalPort]) -> String {
    let mut out = String::new();
    for port in one_array(ports) {
        for k in 0..port.slots.len {
            let place = element(&parameter("in", port.index), &ports[port.index], k);
            let at = port.slots.start + k;
            out += &match port.kind {
                Scalar::Real => format!("  arguments[{at}].real = {place};\n"),
                Scalar::Bool => format!("  arguments[{at}].integer = {place} ? 1 : 0;\n"),
                _ => format!("  arguments[{at}].integer = {place};\n"),
            };
        }
    }
    out
}

fn received_results(external: &ExternalFunction) -> String {
    let mut out = String::new();
    for port in one_array(&external.outputs) {
        for k in 0..port.slots.len {
            let value = word_value(port.kind, port.slots.start + k);
            out += &match external.result() {
                Some(_) => format!("  return {value};\n"),
                None => format!("  {}[{k}] = {value};\n", parameter("out", port.index)),
            };
        }
    }
    out
}

fn word_value(kind: Scalar, at: u32) -> String {
    match kind {
        Scalar::Real => format!("results[{at}].real"),
        Scalar::Bool => format!("results[{at}].integer != 0"),
        _ => format!("results[{at}].integer"),
    }
}

pub(crate) fn element(name: &str, port: &ExternalPort, k: u32) -> String {
    match port.is_array {
        true => format!("{name}[{k}]"),
        false => name.to_owned(),
    }
}

/// Returns the slots of each port if the groups of values follow each other in one array, in the order of the
/// declaration.
pub(crate) fn one_array(ports: &[ExternalPort]) -> Vec<PortSlots> {
    let mut start = 0;
    let groups = ExternalFunction::group_lens(ports).map(|(_, len)| {
        let range = SlotRange { start, len };
        start += len;
        range
    });
    let ranges: Vec<SlotRange> = groups.collect();
    port_slots(ports, &ranges)
}
