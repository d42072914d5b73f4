//! The entries that take what others wrote, as plain functions from bytes, and the budget that each input has.
//!
//! Fuzzers (`fuzz/`, run by `cargo xtask fuzz`) and stable tests (`tests/`) call the same functions: no input may make an
//! entry panic, hang or take memory without end. What an entry finds wrong is its own business; this crate must not know
//! what a finding means, only that findings point into the text and can be shown.
//!
//! | file | idea |
//! |---|---|
//! | `texts.rs` | lexer, parser and checker |
//! | `net.rs` | importer |
//! | `image.rs` | image loader |
//! | `last.rs` | the input at hand, for ends that leave no trace |
//! | `budget.rs` | one second and 200 MB |
//! | `seeds.rs` | inputs to begin with: every program of the project |
//! | `mutate.rs` | small damage, repeatable |
//! | `words.rs` | the dictionary |

mod budget;
mod image;
mod last;
mod mutate;
mod net;
mod seeds;
mod texts;
mod words;

pub use budget::{CPU, MEMORY, within};
pub use mutate::Mutator;
pub use seeds::{Seed, found};
pub use texts::LUSTRE;
pub use words::dictionary;

/// An entry that takes foreign input.
#[derive(Debug)]
pub struct Entry {
    /// The name of its fuzz target.
    pub name: &'static str,
    /// What is done with an input.
    pub run: fn(&[u8]),
    /// Inputs to begin with.
    pub seeds: fn() -> Vec<Seed>,
}

/// All entries, the deepest first.
pub const ENTRIES: &[Entry] = &[
    Entry {
        name: "checker",
        run: texts::check,
        seeds: seeds::texts,
    },
    Entry {
        name: "image",
        run: image::load,
        seeds: seeds::images,
    },
    Entry {
        name: "importer",
        run: net::import,
        seeds: seeds::nets,
    },
    Entry {
        name: "parser",
        run: texts::parse,
        seeds: seeds::texts,
    },
    Entry {
        name: "lexer",
        run: texts::lex,
        seeds: seeds::texts,
    },
];

/// The entry of this name.
#[must_use]
pub fn entry(name: &str) -> Option<&'static Entry> {
    ENTRIES.iter().find(|entry| entry.name == name)
}

/// Runs an input through the entry of this name, within its budget. `RPI_FUZZ_LAST` names a file that keeps the input.
///
/// # Panics
/// If there is no such entry, and if the entry does what none may do.
pub fn run(name: &str, input: &[u8]) {
    let entry = entry(name).unwrap_or_else(|| panic!("no entry is called {name}"));
    last::keep(input);
    within(|| (entry.run)(input));
}
