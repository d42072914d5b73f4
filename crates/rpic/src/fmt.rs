//! `rpic fmt`.

use std::io::Read;
use std::path::Path;

use rpi_syntax::{Mode, format};

use crate::Outcome;
use crate::args::FmtArgs;

/// Formats files in place, or standard input to standard output.
pub(crate) fn fmt(args: &FmtArgs) -> Outcome {
    if args.stdin {
        let mut text = String::new();
        std::io::stdin().read_to_string(&mut text)?;
        let set = formatted("standard input", &text, Mode::Rpi)?;
        print!("{set}");
        return Ok(true);
    }
    let mut well = true;
    for path in &args.files {
        well &= file(path, args.check)?;
    }
    Ok(well)
}

fn file(path: &Path, check: bool) -> Outcome {
    let name = path.display().to_string();
    let text = rpi_driver::read(path)?.text()?.to_owned();
    let set = formatted(&name, &text, Mode::of_path(&name))?;
    if set == text {
        return Ok(true);
    }
    if check {
        println!("{name} would change");
        return Ok(false);
    }
    std::fs::write(path, set)?;
    Ok(true)
}

fn formatted(name: &str, text: &str, mode: Mode) -> Result<String, String> {
    format(text, mode).map_err(|findings| {
        let messages: Vec<&str> = findings.iter().map(|f| f.message.as_str()).collect();
        format!("{name} has faults: {}", messages.join("; "))
    })
}
