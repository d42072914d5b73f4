//! Entry point for nets in the text format of the reference system: the importer.

use rpi_driver::{Input, Kind, compile, import};

use crate::texts::{lowered, shown};

/// Imports a net, checks it, writes it as a program, and lowers it.
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
