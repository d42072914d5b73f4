//! What must hold of every program, tried on random ones.
//!
//! | file | idea |
//! |---|---|
//! | `random.rs` | random numbers |
//! | `types.rs`, `forms.rs` | the types and the forms of expressions |
//! | `exprs.rs`, `program.rs` | random expressions, random programs |
//! | `tree.rs` | a program as a tree, and making it smaller |
//! | `run.rs` | running it both ways |
//!
//! A plain run tries a few programs; `RPI_PROGRAMS=10000` (`cargo xtask soak`) tries so many, `RPI_SEED` others. What
//! fails is made smaller and printed; its seed is the program's own.

mod exprs;
mod forms;
mod program;
mod random;
mod run;
mod tree;
mod types;

use program::{Counts, program};
use random::Random;
use run::Ready;

/// Programs in a plain run.
const PROGRAMS: u64 = 200;
/// The seed of a plain run.
const SEED: u64 = 20_261_121;
/// Cycles that each program runs.
const CYCLES: usize = 12;

fn number(name: &str, otherwise: u64) -> u64 {
    let asked = std::env::var(name).ok().and_then(|text| text.parse().ok());
    asked.unwrap_or(otherwise)
}

/// Tries a property on so many programs. It says what does not hold, if the program is one it speaks of.
fn holds_of_all(property: fn(&str, u64) -> Result<(), String>) {
    let (programs, first) = (number("RPI_PROGRAMS", PROGRAMS), number("RPI_SEED", SEED));
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
        let ready = Ready::new(text, "main")?;
        let rows = ready.rows(&mut Random::new(seed), CYCLES);
        let expected = run::reference(text, "main", &rows).map_err(|e| format!("no reference: {e}"))?;
        let found = ready.run(&rows);
        match expected == found {
            true => Ok(()),
            false => Err(format!("differ: inputs {rows:?}\nreference {expected:?}\nimage     {found:?}")),
        }
    });
}
