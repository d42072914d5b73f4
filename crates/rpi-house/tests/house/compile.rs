//! What the compiler says of a text: the one way in which the tests of documents and of `tests/ui` ask.

use rpi_diag::{Finding, SourceMap};
use rpi_syntax::Mode;

/// What was found, and the texts that it is about.
pub(crate) struct Said {
    pub(crate) findings: Vec<Finding>,
    pub(crate) sources: SourceMap,
}

/// Checks a text under a file name, which tells its language.
pub(crate) fn check(name: &str, text: &str) -> Said {
    let mut sources = SourceMap::new();
    let file = sources.add(name, text);
    let findings = match name.ends_with(".rpinet") {
        true => rpi_net::rpinet::read("net", file, text).1,
        false => rpi_syntax::parse(file, text, Mode::of_path(name)).findings,
    };
    Said { findings, sources }
}
