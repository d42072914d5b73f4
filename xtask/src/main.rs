//! Chores of the repository: `cargo xtask CHORE`.

use std::process::ExitCode;

/// The chores: name, what it does, and how.
type Chore = (&'static str, &'static str, fn() -> Result<(), String>);

const CHORES: &[Chore] = &[(
    "gen",
    "write the files that are made from the project's tables",
    generate,
)];

fn main() -> ExitCode {
    let wanted = std::env::args().nth(1).unwrap_or_default();
    let Some((_, _, run)) = CHORES.iter().find(|(name, _, _)| *name == wanted) else {
        eprintln!("usage: cargo xtask CHORE");
        for (name, what, _) in CHORES {
            eprintln!("  {name:<12} {what}");
        }
        return ExitCode::from(2);
    };
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(reason) => {
            eprintln!("{reason}");
            ExitCode::FAILURE
        }
    }
}

fn generate() -> Result<(), String> {
    for file in rpi_house::generated()
        .iter()
        .filter(|file| !file.is_current())
    {
        file.write()
            .map_err(|error| format!("{}: {error}", file.path))?;
        println!("{}", file.path);
    }
    Ok(())
}
