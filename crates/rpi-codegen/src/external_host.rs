//! C program that computes external functions for another process.
//!
//! The program reads the number of a function, in the order of the names in C, and its arguments, and replies with a line
//! of its results. Words have the form of those of the [`driver`](crate::driver()).

use crate::c_type::CType;
use crate::external::{PortSlots, declaration, element, external_functions, one_array, parameter};
use rpi_image::Image;
use rpi_image::Scalar;
use rpi_image::external::{ExternalFunction, ExternalPort};

/// Returns the text of the program for the external functions of an image.
#[must_use]
pub fn external_host(image: &Image) -> String {
    let mut out = include_str!("prelude.h").to_owned() + "#include <string.h>\n";
    out += include_str!("driver.c");
    let functions = external_functions(image);
    out += "#ifdef __cplusplus\nextern \"C\" {\n#endif\n";
    for (_, external) in functions.values() {
        // Writing to a string cannot fail.
        let _ = declaration(external, &mut out);
    }
    out += "#ifdef __cplusplus\n}\n#endif\n";
    for (number, (_, external)) in functions.values().enumerate() {
        out += &format!(
            "static void call_{number}(void) {{\n{}}}\n\n",
            body(external)
        );
    }
    out += "int main(void) {\n  int number;\n  while (scanf(\"%d\", &number) == 1) {\n";
    for number in 0..functions.len() {
        out += &format!("    if (number == {number}) {{\n      call_{number}();\n    }}\n");
    }
    out += "    printf(\"\\n\");\n    fflush(stdout);\n  }\n  return 0;\n}\n";
    out
}

/// Returns the statements that read the arguments of a function, call it, and write its results.
fn body(external: &ExternalFunction) -> String {
    let mut out = variables(&external.inputs, "in") + &variables(&external.outputs, "out");
    for (place, kind) in places(&external.inputs, "in") {
        let word = match kind {
            Scalar::Real => "driver_real(driver_read())",
            Scalar::Bool => "driver_read() != 0U",
            _ => "driver_integer(driver_read())",
        };
        out += &format!("  {place} = {word};\n");
    }
    out += &call(external);
    for (place, kind) in places(&external.outputs, "out") {
        out += &match kind {
            Scalar::Real => format!("  driver_write(driver_bits({place}));\n"),
            Scalar::Bool => format!("  driver_write({place} ? 1U : 0U);\n"),
            _ => format!("  driver_write((uint64_t){place});\n"),
        };
    }
    out
}

/// Returns the statement that calls a function with the variables of its ports.
fn call(external: &ExternalFunction) -> String {
    let inputs = (0..external.inputs.len()).map(|k| parameter("in", k));
    let mut arguments: Vec<String> = inputs.collect();
    let result = match external.result() {
        Some(_) => format!("{} = ", parameter("out", 0)),
        None => {
            let outputs = external.outputs.iter().enumerate();
            arguments.extend(outputs.map(|(k, port)| match port.is_array {
                true => parameter("out", k),
                false => format!("&{}", parameter("out", k)),
            }));
            String::new()
        }
    };
    let (symbol, arguments) = (&external.symbol, arguments.join(", "));
    format!("  {result}{symbol}({arguments});\n")
}

/// Returns the declarations of variables for ports.
fn variables(ports: &[ExternalPort], direction: &str) -> String {
    let lines = ports.iter().enumerate().map(|(k, port)| {
        let (ty, name) = (CType::of(port.kind).name(), parameter(direction, k));
        match port.is_array {
            true => format!("  static {ty} {name}[{}];\n", port.len),
            false => format!("  {ty} {name} = 0;\n"),
        }
    });
    lines.collect()
}

/// Returns the C expressions of all values of ports, in the order of a call.
fn places(ports: &[ExternalPort], direction: &str) -> Vec<(String, Scalar)> {
    let mut slots: Vec<PortSlots> = one_array(ports);
    slots.sort_by_key(|p| p.slots.start);
    let values = slots.iter().flat_map(|p| {
        let name = parameter(direction, p.index);
        let places = (0..p.slots.len).map(move |k| element(&name, &ports[p.index], k));
        places.map(|place| (place, p.kind))
    });
    values.collect()
}
