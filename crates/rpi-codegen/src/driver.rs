//! C program that runs a translated image cycle by cycle for another process.
//!
//! The program reads words (16 hexadecimal digits or fewer) from standard input. `r` restores the initial state. `s` and
//! one word per element of the input struct run a cycle; the reply is a line with the fault code, the line of the fault
//! and one word per element of the output struct. During a cycle, a line `c`, the number of a device function and its
//! arguments asks for the results of the function: 1 and one word each, or 0. `t` replies with the result of the
//! self-test, `i` with the number of clock periods of all cycles on a target with a clock for measurements.

use crate::c_type::CType;
use crate::devices::function_name;
use crate::external::{external_functions, remote_definition};
use crate::ports::{Direction, Field, Interface};
use rpi_image::image::Image;

/// Returns the text of the program after the text of the translated image. `name` is that of
/// [`Options`](crate::Options).
#[must_use]
pub fn driver(image: &Image, name: &str, interface: &Interface) -> String {
    let mut out = include_str!("driver.c").to_owned();
    if !image.functions.is_empty() {
        out += include_str!("driver_call.c");
    }
    for (k, external) in external_functions(image).values() {
        out += &remote_definition(external, *k);
    }
    let device = (0..).zip(&image.functions);
    for (k, function) in device.filter(|(_, f)| f.external.is_none()) {
        let arguments: u32 = function.arguments.iter().map(|a| a.len).sum();
        let results: u32 = function.results.iter().map(|r| r.len).sum();
        let function = function_name(name, function, k);
        out += &format!(
            "bool {function}(void *device, const rpi_word *arguments, rpi_word *results) {{\n  (void)device;\n  return driver_call({k}, arguments, {arguments}, results, {results});\n}}\n\n"
        );
    }
    let reads: String = interface.of(Direction::Input).map(read).collect();
    let writes: String = interface.of(Direction::Output).map(write).collect();
    out += &main_function(name, &reads, &writes);
    out
}

/// Returns the main function with the statements that read the inputs and write the outputs.
fn main_function(name: &str, reads: &str, writes: &str) -> String {
    format!(
        "int main(void) {{\n  static {name}_in in;\n  static {name}_state state;\n  static {name}_out out;\n  uint64_t clocks = 0U;\n  char request;\n  {name}_init(&in);\n  {name}_reset(&state);\n  while (scanf(\" %c\", &request) == 1) {{\n    if (request == 'r') {{\n      {name}_init(&in);\n      {name}_reset(&state);\n    }} else if (request == 't') {{\n      printf(\"%d\\n\", {name}_self_test() ? 1 : 0);\n      fflush(stdout);\n    }} else if (request == 'i') {{\n      driver_write(clocks);\n      printf(\"\\n\");\n      fflush(stdout);\n    }} else {{\n      int32_t fault;\n      uint32_t begin;\n{reads}      begin = DRIVER_CLOCK();\n      fault = {name}_step(&state, &in, &out);\n      clocks += (DRIVER_CLOCK() - begin) & 0xFFFFFFU;\n      printf(\"%ld %lu\", (long)fault, (unsigned long)out.fault.line);\n{writes}      printf(\"\\n\");\n      fflush(stdout);\n    }}\n  }}\n  return 0;\n}}\n"
    )
}

fn elements(field: &Field) -> impl Iterator<Item = String> {
    let struct_name = match field.direction {
        Direction::Input => "in",
        Direction::Output => "out",
    };
    let (name, len) = (field.name.clone(), field.len);
    (0..len).map(move |k| match len {
        1 => format!("{struct_name}.{name}"),
        _ => format!("{struct_name}.{name}[{k}]"),
    })
}

fn read(field: &Field) -> String {
    let value = match field.ty {
        CType::Bool => "driver_read() != 0U",
        CType::Int => "driver_integer(driver_read())",
        CType::Real => "driver_real(driver_read())",
        CType::Word => "driver_read()",
    };
    elements(field)
        .map(|place| format!("      {place} = {value};\n"))
        .collect()
}

fn write(field: &Field) -> String {
    let word = |place: &str| match field.ty {
        CType::Bool => format!("{place} ? 1U : 0U"),
        CType::Int | CType::Word => format!("(uint64_t){place}"),
        CType::Real => format!("driver_bits({place})"),
    };
    elements(field)
        .map(|place| format!("      driver_write({});\n", word(&place)))
        .collect()
}
