//! Runs inputs through an entry point in a normal build, each within its budget: `rpi-fuzz-again ENTRY FILE...`.

use std::process::ExitCode;

fn main() -> ExitCode {
    let mut args = std::env::args().skip(1);
    let Some(entry) = args.next().filter(|name| rpi_fuzz::entry(name).is_some()) else {
        eprintln!("usage: rpi-fuzz-again ENTRY FILE...");
        return ExitCode::from(2);
    };
    for path in args {
        match std::fs::read(&path) {
            Ok(input) => {
                println!("{path}");
                rpi_fuzz::run(&entry, &input);
            }
            Err(error) => {
                eprintln!("{path}: {error}");
                return ExitCode::FAILURE;
            }
        }
    }
    ExitCode::SUCCESS
}
