//! `rpic check` and `rpic explain`.

use std::io::IsTerminal;

use rpi_diag::{Code, Format, Style, render_as};

use crate::Outcome;
use crate::args::CheckArgs;

/// Shows what there is against each file.
pub(crate) fn check(args: &CheckArgs) -> Outcome {
    if args.explain_analysis {
        for pass in rpi_net::passes::PASSES {
            println!("{:<12} {}", pass.name, pass.about);
        }
    }
    let mut well = true;
    for path in &args.files {
        let compiled = rpi_driver::compile(&rpi_driver::read(path)?)?;
        let text = render_as(args.format, &compiled.findings, &compiled.sources, style());
        print!("{text}");
        if args.format == Format::Human
            && compiled.findings.is_empty()
            && std::io::stdout().is_terminal()
        {
            println!("{}: nothing found", path.display());
        }
        well &= !compiled.has_errors();
    }
    Ok(well)
}

/// Prints the page of a code.
pub(crate) fn explain(name: &str) -> Outcome {
    let Some(code) = Code::parse(name) else {
        let known = Code::ALL.iter().map(|code| code.as_str());
        let meant = rpi_diag::suggest(name, known);
        let meant = meant
            .map(|m| format!("; did you mean {m}?"))
            .unwrap_or_default();
        return Err(format!("there is no code {name}{meant}").into());
    };
    println!("{}", code.page().trim_end());
    Ok(true)
}

pub(crate) fn style() -> Style {
    Style::of(&std::io::stdout())
}
