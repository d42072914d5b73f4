//! What the compiler says of a text: the one way in which the tests of documents and of `tests/ui` ask.

use std::path::{Path, PathBuf};

use rpi_diag::{Finding, SourceMap};
use rpi_driver::{Input, Kind, compile};

/// What was found, and the texts that it is about.
pub(crate) struct Said {
    pub(crate) findings: Vec<Finding>,
    pub(crate) sources: SourceMap,
}

/// Takes a text through all stages up to checked nets, under a file name, which tells its language.
pub(crate) fn check(name: &str, text: &str) -> Said {
    let path = PathBuf::from(name);
    let kind = Kind::of(Path::new(name)).expect("the name tells the language");
    let input = Input {
        path,
        kind,
        bytes: text.as_bytes().to_vec(),
    };
    let compiled = compile(&input).unwrap_or_else(|error| panic!("{error}"));
    Said {
        findings: compiled.findings,
        sources: compiled.sources,
    }
}
