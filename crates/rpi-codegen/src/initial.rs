//! C functions that set initial values: of the inputs, of the state, and of fragments that restart.

use crate::header::state_variables;
use crate::statements::{Emitter, initial};
use crate::variables::{Storage, Variable};

/// Returns the function that sets all inputs to their initial values.
pub(crate) fn init_function(emitter: &Emitter<'_>) -> String {
    let name = emitter.options.name;
    let mut lines = String::new();
    for variable in emitter.variables.in_storage(Storage::Input) {
        lines += &initial_values(
            emitter,
            variable,
            variable.slots.start,
            variable.slots.end(),
        );
    }
    format!(
        "void {name}_init(struct {name}_in *in) {{\n  memset(in, 0, sizeof *in);\n{lines}}}\n\n"
    )
}

/// Returns the assignments of the initial values of some slots of a variable that are not 0.
fn initial_values(emitter: &Emitter<'_>, variable: &Variable, start: u32, end: u32) -> String {
    let slots = (start..end).filter(|slot| emitter.slots.initial(*slot) != 0);
    slots
        .map(|slot| {
            let value = initial(emitter.slots, slot, variable.ty);
            format!(
                "  {} = {value};\n",
                emitter.variables.slot(emitter.slots, slot)
            )
        })
        .collect()
}

/// Returns the functions that restore the initial state: of the whole program and of fragments.
pub(crate) fn resets(emitter: &Emitter<'_>) -> String {
    let name = emitter.options.name;
    let mut all = String::new();
    for variable in state_variables(emitter) {
        all += &initial_values(
            emitter,
            variable,
            variable.slots.start,
            variable.slots.end(),
        );
    }
    let mut out =
        format!("void {name}_reset({name}_state *s) {{\n  memset(s, 0, sizeof *s);\n{all}}}\n\n");
    for fragment in &emitter.resets {
        let Some(restored) = emitter.image.fragments.get(*fragment as usize) else {
            continue;
        };
        let range = restored.state;
        let mut lines = String::new();
        for object in emitter.slots.objects(range.start, range.end()) {
            let Some(variable) = emitter.variables.of(object.start) else {
                continue;
            };
            let (from, to) = (object.start.max(range.start), object.end().min(range.end()));
            lines += &restored_values(emitter, variable, from, to);
        }
        let path = restored.path.replace("*/", "* /");
        out += &format!(
            "/* Restores the state of the fragment `{path}`. */\nstatic void {name}_reset_{fragment}({name}_state *s) {{\n  (void)s;\n{lines}}}\n\n"
        );
    }
    out
}

fn restored_values(emitter: &Emitter<'_>, variable: &Variable, from: u32, to: u32) -> String {
    let (path, slots) = (emitter.variables.path(variable), emitter.slots);
    if variable.slots.len > 1 && to - from == variable.slots.len {
        let values = initial_values(emitter, variable, from, to);
        return format!("  memset({path}, 0, sizeof {path});\n{values}");
    }
    let value = |slot| {
        (
            emitter.variables.slot(slots, slot),
            initial(slots, slot, variable.ty),
        )
    };
    let values = (from..to).map(value);
    values
        .map(|(slot, value)| format!("  {slot} = {value};\n"))
        .collect()
}
