//! Clocks: flows sampled by sampled flows, in nodes, fragments and states, in `.rpi` and in Lustre.
//!
//! Every random program here is correct by construction, because the generator knows the clock of every flow. It is run
//! as an image and by the reference interpreter, and rewritten in equivalent ways (M4). Each variant must be accepted
//! and have the same values in every cycle.
//!
//! | file | idea |
//! |---|---|
//! | `model.rs` | data model of programs |
//! | `generator.rs`, `statements.rs` | random programs and statements |
//! | `exprs.rs`, `forms.rs` | random expressions of a type and a clock |
//! | `write.rs` | conversion of a model to text |
//! | `vary.rs`, `enclose.rs` | equivalent variants |
//! | `shrink.rs` | reduction of failing programs |

mod enclose;
mod exprs;
mod forms;
mod generator;
mod model;
mod shrink;
mod statements;
mod vary;
mod write;

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};

use rpi_driver::InputKind;
use rpi_reference::Value;

use crate::random::Random;
use crate::run::{self, CompiledNode, Rows};
use crate::{CYCLES, PROGRAMS, SEED, alike, number};
use model::Model;

/// Number of variants of each program.
const VARIANTS: u64 = 4;

/// Returns the text of a random program.
pub(crate) fn text(seed: u64, lustre: bool) -> String {
    generator::model(seed, lustre).text()
}

/// Compiles a model, or returns the reason why that fails.
fn ready(model: &Model) -> Result<CompiledNode, String> {
    CompiledNode::of_kind(&model.text(), "main", kind(model))
}

fn kind(model: &Model) -> InputKind {
    if model.lustre {
        InputKind::Lustre
    } else {
        InputKind::Rpi
    }
}

/// Runs a program as an image and in the interpreter.
fn runs(model: &Model, seed: u64) -> Result<(Rows, Vec<run::CycleResult>), String> {
    let ready = ready(model)?;
    let mut rows = ready.rows(&mut Random::new(seed), CYCLES);
    rows.iter_mut().flatten().for_each(small);
    let expected = run::reference_of_kind(&model.text(), "main", &rows, kind(model))?;
    alike(
        &format!("image and reference, inputs {rows:?}"),
        &expected,
        &ready.run(&rows),
    )?;
    Ok((rows, expected))
}

/// Limits an integer input, so that no program overflows. Otherwise removing an unused equation could remove a fault.
fn small(value: &mut Value) {
    if let Value::Int(number) = value {
        *number %= 100;
    }
}

/// Runs a variant of a program.
fn varies(
    model: &Model,
    seed: u64,
    rows: &Rows,
    expected: &Vec<run::CycleResult>,
) -> Result<(), String> {
    let mut random = Random::new(seed);
    let mut other = model.clone();
    let (name, way) = *random.pick(vary::TRANSFORMATIONS);
    if !way(&mut other, &mut random) {
        return Ok(());
    }
    let text = other.text();
    let run = || ready(&other).map(|ready| ready.run(rows));
    let found = catch_unwind(AssertUnwindSafe(run)).unwrap_or_else(|_| Err("panics".to_owned()));
    let found = found.map_err(|why| format!("{name}, {why}\n{text}"))?;
    alike(
        &format!("variant {name}, inputs {rows:?}\n{text}"),
        expected,
        &found,
    )
}

fn holds(model: &Model, seed: u64) -> Result<(), String> {
    let (rows, expected) = runs(model, seed)?;
    for k in 0..VARIANTS {
        varies(
            model,
            seed.wrapping_mul(VARIANTS).wrapping_add(k),
            &rows,
            &expected,
        )?;
    }
    Ok(())
}

/// Returns the kind of a failure: the text up to the first colon or line end.
fn sort(why: &str) -> String {
    why.split([':', '\n']).next().unwrap_or_default().to_owned()
}

fn tried(model: &Model, seed: u64) -> Result<(), String> {
    let tried = catch_unwind(AssertUnwindSafe(|| holds(model, seed)));
    tried.unwrap_or_else(|_| Err("panics: see above".to_owned()))
}

/// Returns a smaller program with the same kind of failure, and its message.
fn smallest(model: Model, seed: u64, why: String) -> (Model, String) {
    let same = |model: &Model| tried(model, seed).is_err_and(|other| sort(&other) == sort(&why));
    let small = shrink::shrink(model, same);
    let why = tried(&small, seed).err().unwrap_or(why);
    (small, why)
}

/// Tests the given number of programs.
fn holds_of_all(lustre: bool) {
    let (programs, first) = (number("RPI_PROGRAMS", PROGRAMS), number("RPI_SEED", SEED));
    let mut sorts: BTreeMap<String, u64> = BTreeMap::new();
    for seed in first..first + programs {
        let model = generator::model(seed, lustre);
        let Err(why) = tried(&model, seed) else {
            continue;
        };
        // With `RPI_SURVEY`, one program of each kind of failure is shown.
        let count = sorts.entry(sort(&why)).or_default();
        *count += 1;
        if *count > 1 {
            continue;
        }
        if number("RPI_SURVEY", 0) == 2 {
            println!("RPI_SEED={seed} as it was\n{why}\n{}", model.text());
        }
        let (small, why) = smallest(model, seed, why);
        let shown = format!("RPI_SEED={seed} RPI_PROGRAMS=1\n{why}\n{}", small.text());
        assert!(number("RPI_SURVEY", 0) > 0, "{shown}");
        println!("{shown}");
    }
    assert!(sorts.is_empty(), "{sorts:#?}");
}

#[test]
fn clocks_mean_the_same_however_a_program_is_written() {
    holds_of_all(false);
}

#[test]
fn clocks_mean_the_same_however_lustre_is_written() {
    holds_of_all(true);
}
