//! Generates the parser from `grammar/rpi.lalrpop` with LALRPOP.

use std::path::PathBuf;
use std::process::ExitCode;

fn main() -> ExitCode {
    let here = std::env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default();
    let grammar = PathBuf::from(here).join("../../grammar");
    println!(
        "cargo::rerun-if-changed={}",
        grammar.join("rpi.lalrpop").display()
    );
    let made = lalrpop::Configuration::new()
        .set_in_dir(&grammar)
        .set_out_dir(std::env::var_os("OUT_DIR").unwrap_or_default())
        .emit_whitespace(false)
        .process();
    match made {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}
