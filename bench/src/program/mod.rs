//! Generated programs for measuring the checker and how its time grows with the size.
//!
//! A [`Shape`] generates a program of about the requested number of equations. [`VALID`] are programs without errors;
//! [`INVALID`] have a diagnostic for every few equations, because reporting many errors must not be slow either.

mod bodies;
mod errors;
mod parts;

/// Generator of benchmark programs with one pattern of equations, in any size.
#[derive(Clone, Copy)]
pub struct Shape {
    /// Name of the pattern, shown in the table of the benchmark.
    pub name: &'static str,
    /// File extension of the generated program, which gives its language: `rpi` or `lus`.
    pub extension: &'static str,
    write: fn(usize) -> String,
}

impl Shape {
    /// Returns the text of a program with about this number of equations.
    #[must_use]
    pub fn text(&self, equations: usize) -> String {
        (self.write)(equations)
    }
}

const fn shape(name: &'static str, ending: &'static str, write: fn(usize) -> String) -> Shape {
    Shape {
        name,
        extension: ending,
        write,
    }
}

/// Patterns of programs without errors and warnings.
pub const VALID: &[Shape] = &[
    shape("chain", "lus", bodies::chain_declared),
    shape("chain", "rpi", bodies::chain),
    shape("copies", "rpi", bodies::copies),
    shape("wide layer", "lus", bodies::layer),
    shape("delays", "rpi", bodies::delays),
    shape("arrays", "lus", bodies::arrays),
    shape("array chain", "rpi", bodies::array_chain),
    shape("many nodes", "lus", parts::nodes),
    shape("many calls", "rpi", parts::calls),
    shape("call ladder", "rpi", parts::ladder),
    shape("fragments", "rpi", parts::fragments),
    shape("automata", "rpi", parts::automata),
    shape("one automaton", "rpi", parts::automaton),
    shape("clocks", "lus", parts::clocks),
    shape("commands", "rpi", parts::commands),
];

/// Patterns of programs with many diagnostics of the kind that the name gives.
pub const INVALID: &[Shape] = &[
    shape("broken items", "rpi", errors::broken_items),
    shape("broken equations", "rpi", errors::broken_equations),
    shape("unknown names", "rpi", errors::unknown_names),
    shape("undeclared flows", "lus", errors::undeclared),
    shape("duplicates", "rpi", errors::duplicates),
    shape("defined twice", "rpi", errors::defined_twice),
    shape("wrong types", "rpi", errors::wrong_types),
    shape("unused flows", "rpi", errors::unused),
    shape("rings", "rpi", errors::dependency_cycles),
    shape("one ring", "rpi", errors::one_dependency_cycle),
    shape("no first value", "rpi", errors::no_first_value),
    shape("absent", "rpi", errors::absent),
];

/// Returns a hand-written program of 300 lines: a module of the standard library without its tests, which uses another
/// module.
#[must_use]
pub fn library_program() -> &'static str {
    let module = include_str!("../../../stdlib/motion.rpi");
    module
        .find("\ntest ")
        .map_or(module, |tests| &module[..tests])
}

/// Returns the texts `line(0)`, `line(1)`, ... up to `count` texts, each on a line of its own.
fn lines(count: usize, line: impl Fn(usize) -> String) -> String {
    let mut text = String::new();
    for k in 0..count {
        text.push_str(&line(k));
        text.push('\n');
    }
    text
}

/// Returns the list of names `prefix0, prefix1, ...` with `count` names.
fn names(prefix: &str, count: usize) -> String {
    let names: Vec<String> = (0..count).map(|k| format!("{prefix}{k}")).collect();
    names.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use rpi_diag::Diagnostic;
    use rpi_driver::{Input, InputKind, compile};
    use std::path::PathBuf;

    fn diagnostics(ending: &str, text: String) -> Vec<Diagnostic> {
        let path = PathBuf::from(format!("p.{ending}"));
        let input = Input {
            kind: InputKind::from_path(&path).expect("a language"),
            path,
            bytes: text.into_bytes(),
        };
        compile(&input).expect("a program").diagnostics
    }

    #[test]
    fn a_written_file_has_no_faults() {
        assert_eq!(diagnostics("rpi", library_program().to_owned()), []);
    }

    #[test]
    fn nothing_is_found_in_sound_programs() {
        for shape in VALID {
            let found = diagnostics(shape.extension, shape.text(200));
            assert_eq!(found, [], "{}.{}", shape.name, shape.extension);
        }
    }

    /// The code of the diagnostics that each faulty program must cause.
    const CODES: &[(&str, &str)] = &[
        ("broken items", "RPI0004"),
        ("broken equations", "RPI0001"),
        ("unknown names", "RPI1001"),
        ("undeclared flows", "RPI1001"),
        ("duplicates", "RPI1002"),
        ("defined twice", "RPI1008"),
        ("wrong types", "RPI2002"),
        ("unused flows", "RPI3101"),
        ("rings", "RPI4001"),
        ("one ring", "RPI4001"),
        ("no first value", "RPI5001"),
        ("absent", "RPI3001"),
    ];

    #[test]
    fn what_is_found_is_what_the_name_says() {
        for (shape, (name, code)) in INVALID.iter().zip(CODES) {
            assert_eq!(shape.name, *name);
            for diagnostic in diagnostics(shape.extension, shape.text(100)) {
                assert_eq!(diagnostic.code.as_str(), *code, "{name}");
            }
        }
    }

    #[test]
    fn findings_grow_with_faulty_programs() {
        for shape in INVALID {
            let few = diagnostics(shape.extension, shape.text(100)).len();
            let many = diagnostics(shape.extension, shape.text(400)).len();
            let whole = ["one ring", "defined twice"].contains(&shape.name);
            assert!(
                few > 0 && (whole || many >= 2 * few),
                "{}: {few}, {many}",
                shape.name
            );
        }
    }
}
