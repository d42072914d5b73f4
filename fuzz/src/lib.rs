//! Entry points for untrusted input, as functions from bytes, and the budget of each input.
//!
//! Fuzzers (`fuzz/targets/`, run by `cargo xtask fuzz`) and stable tests (`tests/`) call the same functions. No input may make
//! an entry point panic, hang or allocate without bound. This crate must not depend on the meaning of a diagnostic; it
//! only checks that diagnostics point into the text and can be rendered.
//!
//! | file | idea |
//! |---|---|
//! | `texts.rs` | lexer, parser and checker |
//! | `net.rs` | importer |
//! | `image.rs` | image loader |
//! | `recording.rs` | recordings, traces and cell descriptions |
//! | `server.rs` | messages of clients of the server, and compressed files |
//! | `current_input.rs` | file with the current input, for crashes |
//! | `budget.rs` | one second and 200 MB |
//! | `seeds.rs` | initial corpus: every program of the project |
//! | `mutator.rs` | reproducible mutations |
//! | `dictionary.rs` | dictionary |

mod budget;
mod current_input;
mod dictionary;
mod image;
mod mutator;
mod net;
mod recording;
mod seeds;
mod server;
mod texts;

pub use budget::{CPU_BUDGET, MEMORY_BUDGET, run_within_budget};
pub use dictionary::dictionary;
pub use mutator::Mutator;
pub use seeds::{Seed, saved_inputs};
pub use texts::LUSTRE;

/// Entry point of the product for untrusted input, which fuzzers call with mutated inputs.
#[derive(Debug)]
pub struct Entry {
    /// Name of the entry point, and of the fuzz target that calls it.
    pub name: &'static str,
    /// Function that processes one input. It panics if the product handles the input wrongly.
    pub run: fn(&[u8]),
    /// Function that returns the initial corpus of inputs for the entry point.
    pub seeds: fn() -> Vec<Seed>,
}

/// All entry points for fuzzers, the one that runs the most code first.
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
        name: "recording",
        run: recording::read,
        seeds: recording::seeds,
    },
    Entry {
        name: "trace",
        run: recording::parse_trace,
        seeds: seeds::traces,
    },
    Entry {
        name: "cell",
        run: recording::parse_cell,
        seeds: seeds::cells,
    },
    Entry {
        name: "http",
        run: rpi_serve::entry_points::http,
        seeds: server::requests,
    },
    Entry {
        name: "lines",
        run: rpi_serve::entry_points::lines,
        seeds: server::lines,
    },
    Entry {
        name: "websocket",
        run: rpi_serve::entry_points::websocket,
        seeds: server::frames,
    },
    Entry {
        name: "directio",
        run: rpi_serve::entry_points::directio,
        seeds: server::messages,
    },
    Entry {
        name: "gzip",
        run: server::decompress,
        seeds: server::compressed,
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

/// Returns the entry point with this name; `None` if there is none.
#[must_use]
pub fn entry(name: &str) -> Option<&'static Entry> {
    ENTRIES.iter().find(|entry| entry.name == name)
}

/// Processes an input with the entry point `name`, within the budget of time and memory. If the environment variable
/// `RPI_FUZZ_LAST` names a file, the input is saved there first.
///
/// # Panics
/// Panics if there is no such entry point, if the entry point panics, or if the budget is exceeded.
pub fn run(name: &str, input: &[u8]) {
    let entry = entry(name).unwrap_or_else(|| panic!("unknown entry point: {name}"));
    current_input::save(input);
    run_within_budget(|| (entry.run)(input));
}
