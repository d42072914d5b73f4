//! Elaboration of programs with errors.

use rpi_diag::{Code, FileId};
use rpi_sema::elab::{ClaimPolicy, elaborate_node};
use rpi_sema::program::{Program, Source};
use rpi_sema::typed::UnitId;
use rpi_syntax::{Dialect, parse};

#[test]
fn a_fault_that_was_not_told_is_one_of_the_compiler() {
    let text = "node N (x: int) returns (y: int) let y = z + x; tel";
    let file = parse(FileId(0), text, Dialect::Rpi).file;
    let (program, _) = Program::collect(&[Source {
        name: "Test".into(),
        mode: Dialect::Rpi,
        files: vec![&file],
        implicit: false,
    }]);
    let units = rpi_sema::check(&program).units;
    let facts = rpi_sema::facts::analyse(&units, &[true]).0;
    let made = elaborate_node(&units, &facts, UnitId(0), ClaimPolicy::Report, false);
    let codes: Vec<Code> = made
        .diagnostics
        .iter()
        .map(|diagnostic| diagnostic.code)
        .collect();
    assert_eq!(codes, [Code::RPI9901]);
}
