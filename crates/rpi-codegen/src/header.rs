//! Declarations of the C program: structs and functions.

use crate::c_type::CType;
use crate::devices::function_name;
use crate::external::{declaration, external_functions};
use crate::identifiers::identifier;
use crate::ports::Direction;
use crate::slots::Region;
use crate::statements::{Emitter, declarator};
use crate::variables::{Storage, Variable};
use rpi_image::CommandFlow;
use rpi_image::image::CommandEnd;
use std::fmt::Write;

/// Name of the field that counts the cycles.
pub(crate) const CYCLE: &str = "rpi_cycle";

/// Returns the text of the declarations, between the include guards.
pub(crate) fn declarations(emitter: &Emitter<'_>) -> String {
    let mut out = String::new();
    // Writing to a string cannot fail.
    let _ = write_declarations(emitter, &mut out);
    out
}

fn write_declarations(emitter: &Emitter<'_>, out: &mut String) -> std::fmt::Result {
    let name = emitter.options.name;
    out.push_str(include_str!("prelude.h"));
    out.push('\n');
    results(emitter, out)?;
    writeln!(out, "/* Values that the caller sets before each cycle. */")?;
    let mut fields = field_lines(emitter, Direction::Input);
    let mut called = emitter.image.functions.iter();
    if called.any(|f| f.external.is_none()) {
        fields.push((
            "void *device".to_owned(),
            "first argument of the device functions".to_owned(),
        ));
    }
    structure(out, &format!("{name}_in"), &fields)?;
    writeln!(out, "/* Results of a cycle. */")?;
    let mut fields = field_lines(emitter, Direction::Output);
    fields.push((
        "rpi_fault_report fault".to_owned(),
        "first fault of the cycle".to_owned(),
    ));
    structure(out, &format!("{name}_out"), &fields)?;
    state(emitter, out)?;
    functions(emitter, out)
}

fn results(emitter: &Emitter<'_>, out: &mut String) -> std::fmt::Result {
    let CommandEnd::Results(results) = &emitter.image.end else {
        return Ok(());
    };
    if results.is_empty() {
        return Ok(());
    }
    let name = emitter.options.name;
    writeln!(
        out,
        "/* Results with which the command ends. */\nenum {name}_result {{"
    )?;
    write!(out, "  {name}_CONTINUES = 0")?;
    for (k, result) in results.iter().enumerate() {
        write!(
            out,
            ",\n  {name}_RESULT_{} = {}",
            identifier(&result.name),
            k + 1
        )?;
    }
    writeln!(out, "\n}};\n")
}

fn field_lines(emitter: &Emitter<'_>, direction: Direction) -> Vec<(String, String)> {
    let fields = emitter.interface.of(direction);
    fields
        .map(|f| (declarator(f.ty, &f.name, f.len), f.text.clone()))
        .collect()
}

fn structure(out: &mut String, name: &str, fields: &[(String, String)]) -> std::fmt::Result {
    writeln!(out, "typedef struct {name} {{")?;
    for (field, text) in fields {
        let comment = match text.is_empty() {
            true => String::new(),
            false => format!(" /* {} */", text.replace("*/", "* /")),
        };
        writeln!(out, "  {field};{comment}")?;
    }
    if fields.is_empty() {
        writeln!(out, "  char unused; /* C has no empty structs */")?;
    }
    writeln!(out, "}} {name};\n")
}

/// Returns the variables in the state struct, the larger types first, so that there is no padding between them.
pub(crate) fn state_variables<'a>(emitter: &'a Emitter<'_>) -> Vec<&'a Variable> {
    let mut variables: Vec<&Variable> = emitter.variables.in_storage(Storage::State).collect();
    variables.sort_by_key(|v| v.ty.bytes() == 1);
    variables
}

fn state(emitter: &Emitter<'_>, out: &mut String) -> std::fmt::Result {
    let variables = state_variables(emitter);
    let sizes = variables
        .iter()
        .map(|v| v.ty.bytes() * v.slots.len as usize);
    let mut bytes: usize = sizes.sum();
    let mut fields = Vec::new();
    if counts_cycles(emitter) {
        fields.push((
            format!("uint64_t {CYCLE}"),
            "number of cycles so far".to_owned(),
        ));
        bytes += 8;
    }
    for variable in variables {
        fields.push((
            declarator(variable.ty, &variable.name, variable.slots.len),
            String::new(),
        ));
    }
    let name = emitter.options.name;
    let size = bytes.next_multiple_of(8).max(1);
    writeln!(
        out,
        "/* State of one instance, which the caller owns: about {size} bytes. */"
    )?;
    structure(out, &format!("{name}_state"), &fields)
}

/// Returns whether the state needs the number of the cycle.
pub(crate) fn counts_cycles(emitter: &Emitter<'_>) -> bool {
    let flows = &emitter.image.flows;
    flows
        .iter()
        .any(|f| matches!(f.kind, CommandFlow::Time | CommandFlow::Elapsed))
}

fn functions(emitter: &Emitter<'_>, out: &mut String) -> std::fmt::Result {
    let name = emitter.options.name;
    writeln!(out, "#ifdef __cplusplus\nextern \"C\" {{\n#endif")?;
    for (_, external) in external_functions(emitter.image).values() {
        declaration(external, out)?;
    }
    let device = (0..).zip(&emitter.image.functions);
    for (k, function) in device.filter(|(_, f)| f.external.is_none()) {
        let port = &function.port;
        writeln!(
            out,
            "/* Function {} of the device {}, which the caller defines. It returns false if there is no result.\n   Arguments: {}. Results: {}. */",
            port.port,
            port.device,
            words(
                emitter,
                function.arguments.iter().flat_map(|a| a.start..a.end())
            ),
            words(
                emitter,
                function.results.iter().flat_map(|r| r.start..r.end())
            ),
        )?;
        let function = function_name(name, function, k);
        writeln!(
            out,
            "bool {function}(void *device, const rpi_word *arguments, rpi_word *results);"
        )?;
    }
    writeln!(
        out,
        "/* Sets all inputs to their initial values. */\nvoid {name}_init(struct {name}_in *in);"
    )?;
    writeln!(
        out,
        "/* Sets the state to that before the first cycle. */\nvoid {name}_reset({name}_state *s);"
    )?;
    writeln!(
        out,
        "/* Runs one cycle. Returns 0, or the code of the first fault. Instances are independent of each other.\n   Needs at most {} bytes of stack, without the functions that the caller defines. */\nint32_t {name}_step({name}_state *s, const {name}_in *in, {name}_out *out);",
        stack_bound(emitter)
    )?;
    writeln!(
        out,
        "/* Returns false if the compiler has contracted or reordered operations on reals. */\nbool {name}_self_test(void);\n#ifdef __cplusplus\n}}\n#endif"
    )
}

/// Returns an upper bound of the stack of a cycle in bytes: the local variables twice, because compilers may keep copies, and
/// an allowance for the functions that a cycle calls, whose depth and local variables do not depend on the program.
fn stack_bound(emitter: &Emitter<'_>) -> usize {
    const FUNCTIONS: usize = 4096;
    let variables = [Storage::Scope, Storage::Cycle].into_iter();
    let variables = variables.flat_map(|storage| emitter.variables.in_storage(storage));
    let sizes = variables.map(|v| v.ty.bytes() * v.slots.len as usize);
    let bytes: usize = sizes.map(|size| size.next_multiple_of(8)).sum();
    let bytes = bytes + device_words(emitter) * 8;
    2 * bytes + FUNCTIONS
}

/// Returns the number of words that the calls of device functions pass.
fn device_words(emitter: &Emitter<'_>) -> usize {
    let functions = emitter.image.functions.iter();
    let ranges = functions.flat_map(|f| f.arguments.iter().chain(&f.results));
    ranges.map(|range| range.len as usize + 1).sum()
}

/// Describes words by their types: `7 real, 1 integer`.
fn words(emitter: &Emitter<'_>, slots: impl Iterator<Item = u32>) -> String {
    let mut runs: Vec<(usize, &str)> = Vec::new();
    for slot in slots {
        let is_constant = emitter.slots.region(slot) == Region::Constant;
        let name = match emitter.slots.ty(slot) {
            _ if is_constant => "constant",
            CType::Real => "real",
            CType::Word => "word",
            CType::Bool | CType::Int => "integer",
        };
        match runs.last_mut() {
            Some((count, last)) if *last == name => *count += 1,
            _ => runs.push((1, name)),
        }
    }
    let texts: Vec<String> = runs
        .iter()
        .map(|(count, name)| format!("{count} {name}"))
        .collect();
    if texts.is_empty() {
        "none".to_owned()
    } else {
        texts.join(", ")
    }
}
