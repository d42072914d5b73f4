//! Properties of all programs, tested on random ones.
//!
//! | file | idea |
//! |---|---|
//! | `random.rs` | random numbers |
//! | `types.rs`, `forms.rs` | types and forms of expressions |
//! | `exprs.rs`, `program.rs` | random expressions, random programs |
//! | `automata.rs` | random automata |
//! | `tree.rs` | tree of a program, and its reduction |
//! | `run.rs` | execution as an image and in the interpreter |
//! | `wrapped.rs` | `main` inside a restart and inside a fragment |
//! | `fixes.rs` | programs with a mistake, and the effect of sure fixes |
//! | `clocked/` | programs with clocks, each in several variants |
//!
//! A plain run tests a few programs; `RPI_PROGRAMS=10000` (`cargo xtask soak`) sets their number, `RPI_SEED` the first
//! seed. A failing program is reduced and printed with its own seed.

mod automata;
mod clocked;
mod exprs;
mod fixes;
mod forms;
mod program;
mod random;
mod run;
mod tree;
mod types;
mod wrapped;

use std::panic::{AssertUnwindSafe, catch_unwind};

use rpi_c_target::CCompiler;
use rpi_diag::FileId;
use rpi_reference::Value;
use rpi_syntax::{Dialect, Parens, Parse, dump_ast, format, parse, print};

use program::{Counts, program};
use random::Random;
use run::CompiledNode;

/// Number of programs in a plain run.
const PROGRAMS: u64 = 100;
/// Number of programs in a plain run that are also compiled as C.
const C_PROGRAMS: u64 = 100;
/// First seed of a plain run.
const SEED: u64 = 20_261_121;
/// Number of cycles of each program.
const CYCLES: usize = 12;

fn number(name: &str, otherwise: u64) -> u64 {
    let number = std::env::var(name).ok().and_then(|text| text.parse().ok());
    number.unwrap_or(otherwise)
}

/// Tests a property on the given number of programs. The property returns a description of the failure; it returns
/// success for programs to which it does not apply.
fn holds_of_all(property: fn(&str, u64) -> Result<(), String>) {
    holds_of(PROGRAMS, property);
}

/// Tests a property that takes longer, on `programs` programs in a plain run.
fn holds_of(programs: u64, property: fn(&str, u64) -> Result<(), String>) {
    let (programs, first) = (number("RPI_PROGRAMS", programs), number("RPI_SEED", SEED));
    let property = |text: &str, seed: u64| {
        let tried = catch_unwind(AssertUnwindSafe(|| property(text, seed)));
        tried.unwrap_or_else(|_| Err("panics: see above".to_owned()))
    };
    for seed in first..first + programs {
        let (tree, _) = program(seed, &mut Counts::default());
        let Err(why) = property(&tree.render(), seed) else {
            continue;
        };
        let kind = |why: &str| why.split(':').next().unwrap_or_default().to_owned();
        let same = |text: &str| property(text, seed).is_err_and(|other| kind(&other) == kind(&why));
        let small = tree::shrink(tree, same);
        let why = property(&small, seed).err().unwrap_or(why);
        panic!("RPI_SEED={seed} RPI_PROGRAMS=1\n{why}\n{small}");
    }
}

#[test]
fn the_optimised_image_equals_the_reference() {
    holds_of_all(|text, seed| {
        let ready = CompiledNode::new(text, "main")?;
        let rows = ready.rows(&mut Random::new(seed), CYCLES);
        let expected = run::reference(text, "main", &rows)?;
        alike(&format!("inputs {rows:?}"), &expected, &ready.run(&rows))
    });
}

/// The compilers that are not installed are reported and left out.
#[test]
fn the_c_text_equals_the_image() {
    if !CCompiler::new("gcc").is_installed() {
        return println!("SKIPPED: gcc is not installed");
    }
    holds_of(C_PROGRAMS, |text, seed| {
        let ready = CompiledNode::new(text, "main")?;
        let rows = ready.rows(&mut Random::new(seed), CYCLES);
        let options = ["-O0", "-O2", "-O1 -fsanitize=undefined,address"];
        let options = options[seed as usize % options.len()];
        let compiler = CCompiler::new(&format!("gcc -std=c99 {options}"));
        ready.run_in_c(&rows, &compiler)
    });
}

#[test]
fn the_image_of_a_command_equals_the_reference() {
    holds_of_all(|text, _| {
        let expected = run::reference_command(text, CYCLES)?;
        alike("command", &expected, &run::run_command(text, CYCLES)?)
    });
}

#[test]
fn print_then_parse_is_the_identity() {
    holds_of_all(|text, _| {
        let tree = parsed(text)?;
        let printed = print(&tree.file, Dialect::Rpi);
        let again = parsed(&printed)?;
        let [one, two] = [&tree, &again].map(|tree| dump_ast(&tree.file, Parens::Drop));
        alike(&printed, &one, &two)
    });
}

#[test]
fn fmt_is_idempotent_and_keeps_meaning() {
    holds_of_all(|text, seed| {
        let once = format(text, Dialect::Rpi).map_err(|f| format!("no format: {f:?}"))?;
        let twice = format(&once, Dialect::Rpi).map_err(|f| format!("no second format: {f:?}"))?;
        alike("formatted again", &once, &twice)?;
        let [before, after] = [
            CompiledNode::new(text, "main")?,
            CompiledNode::new(&once, "main")?,
        ];
        let rows = before.rows(&mut Random::new(seed), CYCLES);
        alike(&once, &before.run(&rows), &after.run(&rows))
    });
}

#[test]
fn resetting_equals_a_fresh_load() {
    holds_of_all(|text, seed| {
        let again = CompiledNode::new(&wrapped::again(text), "Again")?;
        let fresh = CompiledNode::new(text, "main")?;
        let reset = 1 + Random::new(seed).below(CYCLES - 1);
        let rows = fresh.rows(&mut Random::new(seed), CYCLES);
        let inputs =
            |(k, row): (usize, &Vec<Value>)| [&[Value::Bool(k == reset)], &row[..]].concat();
        let found = again.run(&rows.iter().enumerate().map(inputs).collect());
        match found.get(reset..).filter(|found| !found.is_empty()) {
            Some(found) => alike(
                "after the reset",
                &fresh.run(&rows[reset..].to_vec()),
                &found.to_vec(),
            ),
            None => Ok(()),
        }
    });
}

#[test]
fn an_inactive_fragment_equals_an_absent_one() {
    holds_of_all(|text, seed| {
        let inside = CompiledNode::new(&wrapped::inside(text), "Inside")?;
        let fresh = CompiledNode::new(text, "main")?;
        let mut random = Random::new(seed);
        let rows = fresh.rows(&mut random, CYCLES);
        let on: Vec<bool> = rows.iter().map(|_| random.one_in(2)).collect();
        let inputs = |(on, row): (&bool, &Vec<Value>)| [&[Value::Bool(*on)], &row[..]].concat();
        let found = inside.run(&on.iter().zip(&rows).map(inputs).collect());
        let active = on.iter().zip(&rows).filter(|(on, _)| **on);
        let mut active = fresh
            .run(&active.map(|(_, row)| row.clone()).collect())
            .into_iter();
        for (k, (on, seen)) in on.iter().zip(found).enumerate() {
            let beside = |mut leaves: Vec<Option<u64>>| {
                leaves.push(Some(k as u64));
                leaves
            };
            let expected = match on {
                true => active.next().flatten().map(beside),
                false => Some(beside(vec![None; inside.width() - 1])),
            };
            alike(&format!("active {on} in cycle {k}"), &expected, &seen)?;
        }
        Ok(())
    });
}

#[test]
fn every_construct_occurs() {
    let mut counts = Counts::default();
    for seed in SEED..SEED + PROGRAMS {
        program(seed, &mut counts);
    }
    let forms = forms::FORMS.iter().map(|form| form.name);
    let all = forms.chain(program::STATEMENTS.iter().copied());
    let missing: Vec<&str> = all.filter(|name| !counts.0.contains_key(name)).collect();
    assert!(
        missing.is_empty(),
        "never made: {missing:?}; made: {counts:?}"
    );
}

/// Compares two values and returns a description of the difference.
fn alike<T: PartialEq + std::fmt::Debug>(of: &str, expected: &T, found: &T) -> Result<(), String> {
    match expected == found {
        true => Ok(()),
        false => Err(format!(
            "differ: {of}\nexpected {expected:?}\nfound    {found:?}"
        )),
    }
}

fn parsed(text: &str) -> Result<Parse, String> {
    let parse = parse(FileId(0), text, Dialect::Rpi);
    match parse.diagnostics.first() {
        None => Ok(parse),
        Some(diagnostic) => Err(format!("no syntax: {diagnostic:?}\n{text}")),
    }
}
