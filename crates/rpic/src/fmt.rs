//! `rpic fmt`: formats programs.

use std::path::Path;

use rpi_diag::{Format, SourceMap};
use rpi_syntax::{Dialect, format, parse};
use similar::TextDiff;

use crate::args::FmtArgs;
use crate::check::print_diagnostics;
use crate::outcome::{CommandResult, Exit, file_equals, write_output};

/// Carries out `rpic fmt`: formats each file in place, or formats standard input. With `--check`, prints the
/// differences and changes no file.
pub(crate) fn fmt(args: &FmtArgs) -> CommandResult {
    if args.stdin {
        return stdin(&args.stdin_name);
    }
    let mut exit = Exit::Success;
    for file in &rpi_driver::files_of(&args.files)? {
        let input = rpi_driver::read(file)?;
        let text = input.text()?;
        if !args.check {
            check_plain_utf8(file, text)?;
        }
        exit = match format_or_report(&file.display().to_string(), text)? {
            Some(new) if new == text => exit,
            Some(new) if args.check => print_diff(file, text, &new)?,
            Some(new) => {
                write_output(Some(file), new.as_bytes())?;
                exit
            }
            None => Exit::ErrorsReported,
        };
    }
    Ok(exit)
}

/// Returns an error for a compressed file and for a file in another encoding than UTF-8, because writing its formatted
/// text as plain UTF-8 would change more than the formatting.
fn check_plain_utf8(file: &Path, text: &str) -> Result<(), String> {
    match file_equals(file, text) {
        true => Ok(()),
        false => Err(format!(
            "{}: cannot format in place: not plain UTF-8; decompress it, or convert it with `iconv -f ISO-8859-1 -t UTF-8`",
            file.display()
        )),
    }
}

fn stdin(name: &str) -> CommandResult {
    let text = rpi_files::text_from(std::io::stdin().lock(), rpi_files::MAX_PROGRAM)?;
    match format_or_report(name, &text)? {
        Some(new) => write_output(None, new.as_bytes()).map(|()| Exit::Success),
        None => Ok(Exit::ErrorsReported),
    }
}

/// Prints the differences between the text of a file and its formatted text, in unified format.
fn print_diff(file: &Path, old: &str, new: &str) -> CommandResult {
    rpi_diag::println_stderr!("{}: not formatted", file.display());
    let name = file.display().to_string();
    let changes = TextDiff::from_lines(old, new);
    let changes = changes.unified_diff().header(&name, &name).to_string();
    write_output(None, changes.as_bytes())?;
    Ok(Exit::ErrorsReported)
}

/// Returns the formatted text of a program. If the text cannot be parsed, prints the syntax errors and returns `None`.
/// `name` is the file name, which decides the language.
fn format_or_report(name: &str, text: &str) -> Result<Option<String>, Box<dyn std::error::Error>> {
    let mode = Dialect::from_path(name);
    if let Ok(new) = format(text, mode) {
        return Ok(Some(new));
    }
    let mut sources = SourceMap::new();
    let file = sources.add(name, text);
    print_diagnostics(
        Format::Human,
        &parse(file, text, mode).diagnostics,
        &sources,
    )?;
    Ok(None)
}
