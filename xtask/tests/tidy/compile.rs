//! Runs the compiler for the tests of documents and of `tests/ui`.

use std::path::{Path, PathBuf};

use rpi_diag::{Diagnostic, SourceMap};
use rpi_driver::{Input, InputKind, compile};

/// Diagnostics and the source texts that they refer to.
pub(crate) struct CheckOutput {
    pub(crate) diagnostics: Vec<Diagnostic>,
    pub(crate) sources: SourceMap,
}

/// Compiles a text up to checked nets. The extension of the file name decides the language.
pub(crate) fn check(name: &str, text: &str) -> CheckOutput {
    let path = PathBuf::from(name);
    let kind = InputKind::from_path(Path::new(name)).expect("the name tells the language");
    let input = Input {
        path,
        kind,
        bytes: text.as_bytes().to_vec(),
    };
    let compiled = compile(&input).unwrap_or_else(|error| panic!("{error}"));
    CheckOutput {
        diagnostics: compiled.diagnostics,
        sources: compiled.sources,
    }
}
