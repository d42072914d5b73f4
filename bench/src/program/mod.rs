//! Texts of programs to check: how long that takes, and whether it grows as they do.
//!
//! A [`Shape`] writes a program of about so many equations. [`SOUND`] are programs without faults, [`FAULTY`] have a
//! finding for every few equations, for a compiler may not be slow to complain either.

mod bodies;
mod faults;
mod parts;

/// A way to write a program of any size.
#[derive(Clone, Copy)]
pub struct Shape {
    /// What it is, in two words.
    pub name: &'static str,
    /// How its file's name ends: the language.
    pub ending: &'static str,
    write: fn(usize) -> String,
}

impl Shape {
    /// A program of about so many equations.
    #[must_use]
    pub fn text(&self, equations: usize) -> String {
        (self.write)(equations)
    }
}

const fn shape(name: &'static str, ending: &'static str, write: fn(usize) -> String) -> Shape {
    Shape {
        name,
        ending,
        write,
    }
}

/// Programs in which nothing is found.
pub const SOUND: &[Shape] = &[
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

/// Programs in which much is found: what their names say.
pub const FAULTY: &[Shape] = &[
    shape("broken items", "rpi", faults::broken_items),
    shape("broken equations", "rpi", faults::broken_equations),
    shape("unknown names", "rpi", faults::unknown_names),
    shape("undeclared flows", "lus", faults::undeclared),
    shape("duplicates", "rpi", faults::duplicates),
    shape("defined twice", "rpi", faults::defined_twice),
    shape("wrong types", "rpi", faults::wrong_types),
    shape("unused flows", "rpi", faults::unused),
    shape("rings", "rpi", faults::rings),
    shape("one ring", "rpi", faults::one_ring),
    shape("no first value", "rpi", faults::no_first_value),
    shape("absent", "rpi", faults::absent),
];

/// A file as people write it: a module of the library without its tests, 300 lines long; it uses another one.
#[must_use]
pub fn written() -> &'static str {
    let module = include_str!("../../../stdlib/motion.rpi");
    module
        .find("\ntest ")
        .map_or(module, |tests| &module[..tests])
}

/// The program `f(k)` for each number, each on a line of its own.
fn lines(count: usize, line: impl Fn(usize) -> String) -> String {
    let mut text = String::new();
    for k in 0..count {
        text.push_str(&line(k));
        text.push('\n');
    }
    text
}

/// A list of `prefix0, prefix1, ...`.
fn names(prefix: &str, count: usize) -> String {
    let names: Vec<String> = (0..count).map(|k| format!("{prefix}{k}")).collect();
    names.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use rpi_diag::Finding;
    use rpi_driver::{Input, Kind, compile};
    use std::path::PathBuf;

    fn findings(ending: &str, text: String) -> Vec<Finding> {
        let path = PathBuf::from(format!("p.{ending}"));
        let input = Input {
            kind: Kind::of(&path).expect("a language"),
            path,
            bytes: text.into_bytes(),
        };
        compile(&input).expect("a program").findings
    }

    #[test]
    fn a_written_file_has_no_faults() {
        assert_eq!(findings("rpi", written().to_owned()), []);
    }

    #[test]
    fn nothing_is_found_in_sound_programs() {
        for shape in SOUND {
            let found = findings(shape.ending, shape.text(200));
            assert_eq!(found, [], "{}.{}", shape.name, shape.ending);
        }
    }

    /// The codes of the findings that each faulty program is about.
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
        for (shape, (name, code)) in FAULTY.iter().zip(CODES) {
            assert_eq!(shape.name, *name);
            for finding in findings(shape.ending, shape.text(100)) {
                assert_eq!(finding.code.as_str(), *code, "{name}");
            }
        }
    }

    #[test]
    fn findings_grow_with_faulty_programs() {
        for shape in FAULTY {
            let few = findings(shape.ending, shape.text(100)).len();
            let many = findings(shape.ending, shape.text(400)).len();
            let whole = ["one ring", "defined twice"].contains(&shape.name);
            assert!(
                few > 0 && (whole || many >= 2 * few),
                "{}: {few}, {many}",
                shape.name
            );
        }
    }
}
