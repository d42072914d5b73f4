//! C statements of device accesses: set-points and device functions.

use crate::access::response_type;
use crate::c_type::CType;
use crate::identifiers::identifier;
use crate::ports::{Direction, Meaning, shared_actuator};
use crate::statements::Emitter;
use rpi_image::DeviceResponse;
use rpi_image::image::{DeviceFunction, TRUE};

impl Emitter<'_> {
    /// Returns the statements of [`Step::Actuate`](rpi_image::Step): the set-point, and the responses that the caller
    /// gives for it.
    pub(crate) fn actuate(&mut self, number: u32) -> Vec<String> {
        let image = self.image;
        let actuator = &image.actuators[number as usize];
        let shared = shared_actuator(image, number);
        let field = |meaning| {
            self.interface
                .name(Direction::Output, meaning)
                .unwrap_or("")
        };
        let (value, present) = (
            field(Meaning::SetPoint(shared)),
            field(Meaning::SetPointPresence(shared)),
        );
        let mut lines = Vec::new();
        for (response, slot) in &actuator.responses {
            let text = match self
                .interface
                .name(Direction::Input, Meaning::Response(shared, *response))
            {
                Some(name) => format!("in->{name}"),
                None if *response == DeviceResponse::ConcurrentAccess => format!("out->{present}"),
                None => "false".to_owned(),
            };
            lines.push(self.assignment(*slot, response_type(*response), &text));
        }
        let ports = image.actuators.iter().filter(|a| a.port == actuator.port);
        if ports.count() > 1 {
            let place = self.place(actuator.origin_slot());
            lines.push(format!(
                "if (out->{present}) {{\n  rpi_fault(cx, RPI_CONCURRENT_ACCESS, {place});\n}}"
            ));
        }
        lines.push(format!("out->{present} = true;"));
        let slots = actuator.inputs.iter().flat_map(|i| i.start..i.end());
        let ty = CType::of_type(actuator.port.ty);
        let single = actuator.inputs.iter().map(|i| i.len).sum::<u32>() == 1;
        for (k, slot) in slots.enumerate() {
            let element = if single {
                String::new()
            } else {
                format!("[{k}]")
            };
            let set_point = self.variables.value(self.slots, slot, ty);
            lines.push(format!("out->{value}{element} = {set_point};"));
        }
        lines
    }

    /// Returns the statements of [`Step::Call`](rpi_image::Step): a call of an external function with words.
    pub(crate) fn call_device(&mut self, number: u32) -> Vec<String> {
        let image = self.image;
        let function = &image.functions[number as usize];
        if let Some(external) = &function.external {
            return self.call_external(function, external);
        }
        let arguments: Vec<u32> = function
            .arguments
            .iter()
            .flat_map(|a| a.start..a.end())
            .collect();
        let results: Vec<u32> = function
            .results
            .iter()
            .flat_map(|r| r.start..r.end())
            .collect();
        let mut body = vec![
            format!("rpi_word arguments[{}];", arguments.len().max(1)),
            format!("rpi_word results[{}];", results.len().max(1)),
            "bool is_found;".to_owned(),
        ];
        for (k, slot) in arguments.iter().enumerate() {
            body.push(self.argument_word(k, *slot));
        }
        if arguments.is_empty() {
            body.push("arguments[0].integer = 0;".to_owned());
        }
        let name = function_name(self.options.name, function, number);
        body.push(format!(
            "is_found = {name}(in->device, arguments, results);"
        ));
        if !results.is_empty() {
            let count = results.len();
            body.push(format!(
                "if (!is_found) {{\n  rpi_no_result(results, {count});\n}}"
            ));
        }
        for (k, slot) in results.iter().enumerate() {
            body.push(self.result_word(k, *slot));
        }
        if function.present != TRUE {
            body.push(self.assignment(function.present, CType::Bool, "is_found"));
        }
        let body: String = body
            .iter()
            .flat_map(|l| l.lines())
            .map(|l| format!("  {l}\n"))
            .collect();
        vec![format!("{{\n{body}}}")]
    }

    fn argument_word(&self, k: usize, slot: u32) -> String {
        match self.word(slot) {
            (text, CType::Real) => format!("arguments[{k}].real = {text};"),
            (text, CType::Word) => format!("arguments[{k}].real = rpi_real({text});"),
            (text, CType::Bool) => {
                format!("arguments[{k}].integer = {text} ? INT64_C(1) : INT64_C(0);")
            }
            (text, CType::Int) => format!("arguments[{k}].integer = {text};"),
        }
    }

    fn result_word(&self, k: usize, slot: u32) -> String {
        let ty = self.slots.ty(slot);
        let value = match ty {
            CType::Real => format!("results[{k}].real"),
            CType::Word => format!("rpi_bits(results[{k}].real)"),
            CType::Bool => format!("results[{k}].integer != 0"),
            CType::Int => format!("results[{k}].integer"),
        };
        self.assignment(slot, ty, &value)
    }
}

/// Returns the name of the external function for a device function: `program` is [`Options::name`](crate::Options), and
/// `number` the index of the function in the image.
#[must_use]
pub fn function_name(program: &str, function: &DeviceFunction, number: u32) -> String {
    let text = format!("{}_{}", function.port.device, function.port.port);
    format!("{program}_{}_{number}", identifier(&text))
}
