//! `rpic fmt`: one style for all programs.

use std::io::Read as _;
use std::path::Path;

use rpi_diag::{Format, SourceMap};
use rpi_syntax::{Mode, format, parse};

use crate::args::FmtArgs;
use crate::check::show;
use crate::outcome::{Exit, Outcome, put};

/// Formats each file, or standard input.
pub(crate) fn fmt(args: &FmtArgs) -> Outcome {
    if args.stdin {
        return stdin();
    }
    let mut exit = Exit::Good;
    for file in &rpi_driver::files_of(&args.files)? {
        let input = rpi_driver::read(file)?;
        let text = input.text()?;
        exit = match formatted(&file.display().to_string(), text)? {
            Some(new) if new == text => exit,
            Some(_) if args.check => not_formatted(file),
            Some(new) => {
                put(Some(file), new.as_bytes())?;
                exit
            }
            None => Exit::Found,
        };
    }
    Ok(exit)
}

fn stdin() -> Outcome {
    let mut text = String::new();
    std::io::stdin().read_to_string(&mut text)?;
    match formatted("<stdin>.rpi", &text)? {
        Some(new) => put(None, new.as_bytes()).map(|()| Exit::Good),
        None => Ok(Exit::Found),
    }
}

fn not_formatted(file: &Path) -> Exit {
    eprintln!("{}: not formatted", file.display());
    Exit::Found
}

/// The text in our style; what keeps it from being formatted is printed.
fn formatted(name: &str, text: &str) -> Result<Option<String>, Box<dyn std::error::Error>> {
    let mode = Mode::of_path(name);
    if let Ok(new) = format(text, mode) {
        return Ok(Some(new));
    }
    let mut sources = SourceMap::new();
    let file = sources.add(name, text);
    show(Format::Human, &parse(file, text, mode).findings, &sources)?;
    Ok(None)
}
