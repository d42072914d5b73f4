//! Entry point for nets in the text format of the reference system: the importer.

use rpi_driver::{Input, InputKind, compile, import};

use crate::texts::{check_lowering, check_rendering};

/// Entry point of the fuzzer for nets: imports a net, checks it, writes it as a program, and lowers it to an image.
pub(crate) fn import(input: &[u8]) {
    let input = Input {
        path: "fuzz.rpinet".into(),
        kind: InputKind::Rpinet,
        bytes: input.to_vec(),
    };
    let Ok(compiled) = compile(&input) else {
        return;
    };
    check_rendering(&compiled.diagnostics, &compiled.sources);
    for net in compiled.nets() {
        assert!(!import::to_program(net).is_empty());
        check_lowering(net);
    }
}
