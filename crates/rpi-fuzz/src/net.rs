//! Nets in the reference system's text form: importer.

use rpi_driver::{Input, Kind, compile, import};

use crate::texts::{lowered, shown};

/// Reads a net, checks it, and writes it as a program.
pub(crate) fn import(input: &[u8]) {
    let input = Input {
        path: "fuzz.rpinet".into(),
        kind: Kind::Rpinet,
        bytes: input.to_vec(),
    };
    let Ok(compiled) = compile(&input) else {
        return;
    };
    shown(&compiled.findings, &compiled.sources);
    for net in compiled.nets() {
        assert!(!import::to_program(net).is_empty());
        lowered(net);
    }
}
