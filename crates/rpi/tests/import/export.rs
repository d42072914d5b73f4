//! Programs exported as nets and imported again.

use std::path::{Path, PathBuf};

use rpi_driver::{AnalysedNet, Input, InputKind, compile, emit, import, read};

use crate::round_trip::program;
use crate::run::compare_nets;

/// Period of the examples in ns.
const PERIOD_NS: u64 = 1_000_000;

/// Each command of an example behaves as the exported net and as the program imported from it.
pub(crate) fn come_back(path: &Path) -> Result<(), String> {
    let compiled = read(path).and_then(|input| compile(&input));
    let compiled = compiled.map_err(|e| e.to_string())?;
    if compiled.nets().is_empty() {
        return Err("there is no command".to_owned());
    }
    let cell = std::fs::read_to_string(path.with_file_name("cell.toml")).unwrap_or_default();
    for net in compiled.nets() {
        let (text, diagnostics) = emit::rpinet(net);
        if !diagnostics.is_empty() {
            return Err(format!("{diagnostics:?}"));
        }
        let read = as_read(&text)?;
        let imported = program(import::to_program(&read));
        let imported = imported.map_err(|e| format!("{} as a program: {e}", net.name))?;
        for other in [read, imported] {
            let moves = compare_nets(net, &other, &cell, PERIOD_NS);
            match moves.map_err(|e| format!("{}: {e}", net.name))? {
                true => {}
                false => return Err(format!("{} moves nothing", net.name)),
            }
        }
    }
    Ok(())
}

fn as_read(text: &str) -> Result<AnalysedNet, String> {
    let input = Input {
        path: PathBuf::from("written.rpinet"),
        kind: InputKind::Rpinet,
        bytes: text.as_bytes().to_vec(),
    };
    let compiled = compile(&input).map_err(|e| e.to_string())?;
    match compiled.nets() {
        [net] => Ok(net.clone()),
        _ => Err(format!("{:?}", compiled.diagnostics)),
    }
}

#[test]
fn what_a_net_cannot_hold_is_told() {
    let page = rpi_diag::Code::RPI9102.page();
    for (fence, expected) in [
        ("```rpi-wrong emit-rpinet", 1),
        ("```rpi-right emit-rpinet", 0),
    ] {
        let text = page
            .split(fence)
            .nth(1)
            .and_then(|rest| rest.split("```").next());
        let input = Input {
            path: PathBuf::from("page.rpi"),
            kind: InputKind::Rpi,
            bytes: text.expect("the page has both").as_bytes().to_vec(),
        };
        let compiled = compile(&input).expect("a program is text");
        let [net] = compiled.nets() else {
            panic!("{:?}", compiled.diagnostics)
        };
        let (text, diagnostics) = emit::rpinet(net);
        assert_eq!(diagnostics.len(), expected, "{diagnostics:?}");
        assert!(text.contains("outTerminate=") && text.contains("Key='done'"));
    }
}
