//! Compiles the program of the command line and selects a command.

use std::path::Path;

use rpi_diag::{Style, render};
use rpi_driver::{AnalysedNet, CompileOptions, Compiled, Task, UnboundCommand};

/// Compiles a file and prints its diagnostics. Returns an error if there are errors.
pub(crate) fn load(
    path: &Path,
    asked: impl Into<CompileOptions>,
) -> Result<Compiled, Box<dyn std::error::Error>> {
    let compiled = rpi_driver::compile_with(&rpi_driver::read(path)?, asked)?;
    let style = Style::for_stream(&std::io::stderr());
    rpi_diag::print_stderr!(
        "{}",
        render(&compiled.diagnostics, &compiled.sources, style)
    );
    if compiled.has_errors() {
        return Err(format!("{} does not compile", path.display()).into());
    }
    Ok(compiled)
}

/// Returns the command with this name, or the only command. `tasks` are other valid names for the error message.
pub(crate) fn select_command<'a>(
    compiled: &'a Compiled,
    tasks: &[Task],
    name: Option<&str>,
) -> Result<&'a AnalysedNet, String> {
    let nets = compiled.nets();
    let unset = compiled.unbound.iter().find(|unset| match name {
        Some(name) => unset.command == name,
        None => nets.is_empty(),
    });
    if let Some(unset) = unset {
        return Err(missing_arguments(unset));
    }
    let commands = nets.iter().map(|n| n.name.as_str());
    let names = || {
        commands
            .clone()
            .chain(tasks.iter().map(|t| t.name.as_str()))
    };
    match (nets, name) {
        ([], _) => Err(
            "the file has no command; run a node with --node NAME, tests with `rpic test`"
                .to_owned(),
        ),
        ([only], None) => Ok(only),
        (_, None) => Err(format!(
            "the file has several commands: {}; choose one with --command NAME",
            list(names())
        )),
        (_, Some(name)) => nets.iter().find(|n| n.name == name).ok_or_else(|| {
            let meant = rpi_diag::suggest(name, names());
            let meant = meant
                .map(|m| format!("; did you mean {m}?"))
                .unwrap_or_default();
            format!(
                "unknown command or task {name}, expected one of {}{meant}",
                list(names())
            )
        }),
    }
}

/// Returns the error message for a command with open parameters.
fn missing_arguments(unset: &UnboundCommand) -> String {
    let params = unset.params.iter();
    let [quoted, declared] = [("`", "`"), ("const ", " = ...;")].map(|(before, after)| {
        let each = params
            .clone()
            .map(|param| format!("{before}{param}{after}"));
        each.collect::<Vec<_>>()
    });
    format!(
        "{} cannot run alone: {} has no value; declare `{}`, or run a task that passes it",
        unset.command,
        quoted.join(" and "),
        declared.join(" ")
    )
}

fn list<'a>(names: impl Iterator<Item = &'a str>) -> String {
    names.collect::<Vec<_>>().join(", ")
}
