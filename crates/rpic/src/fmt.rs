//! `rpic fmt`: formats programs.

use std::io::Read as _;
use std::path::Path;

use rpi_diag::{Format, SourceMap};
use rpi_syntax::{Mode, format, parse};
use similar::TextDiff;

use crate::args::FmtArgs;
use crate::check::show;
use crate::outcome::{Exit, Outcome, holds, put};

/// Formats each file, or standard input.
pub(crate) fn fmt(args: &FmtArgs) -> Outcome {
    if args.stdin {
        return stdin(&args.stdin_name);
    }
    let mut exit = Exit::Good;
    for file in &rpi_driver::files_of(&args.files)? {
        let input = rpi_driver::read(file)?;
        let text = input.text()?;
        if !args.check {
            is_written_back_the_same(file, text)?;
        }
        exit = match formatted(&file.display().to_string(), text)? {
            Some(new) if new == text => exit,
            Some(new) if args.check => not_formatted(file, text, &new)?,
            Some(new) => {
                put(Some(file), new.as_bytes())?;
                exit
            }
            None => Exit::Found,
        };
    }
    Ok(exit)
}

/// Rejects a compressed file and a file in another encoding, because writing it as plain UTF-8 would change more than
/// its formatting.
fn is_written_back_the_same(file: &Path, text: &str) -> Result<(), String> {
    match holds(file, text) {
        true => Ok(()),
        false => Err(format!(
            "{}: cannot format in place: not plain UTF-8; decompress it, or convert it with `iconv -f ISO-8859-1 -t UTF-8`",
            file.display()
        )),
    }
}

fn stdin(name: &str) -> Outcome {
    let mut text = String::new();
    std::io::stdin().read_to_string(&mut text)?;
    match formatted(name, &text)? {
        Some(new) => put(None, new.as_bytes()).map(|()| Exit::Good),
        None => Ok(Exit::Found),
    }
}

/// Prints the differences that formatting would make.
fn not_formatted(file: &Path, old: &str, new: &str) -> Outcome {
    rpi_diag::tell_line!("{}: not formatted", file.display());
    let name = file.display().to_string();
    let changes = TextDiff::from_lines(old, new);
    let changes = changes.unified_diff().header(&name, &name).to_string();
    put(None, changes.as_bytes())?;
    Ok(Exit::Found)
}

/// Returns the formatted text. Returns `None` and prints the diagnostics if the text cannot be parsed.
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
