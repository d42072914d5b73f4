//! Compiles the program of the command line and selects a command.

use std::fmt;
use std::path::Path;

use rpi_diag::{Style, render};
use rpi_driver::{AnalysedNet, CompileOptions, Compiled, Input, Task, UnboundCommand};

/// Compiles a file and prints its diagnostics. Returns an error if the file cannot be read or does not compile.
pub(crate) fn load(
    path: &Path,
    options: impl Into<CompileOptions>,
) -> Result<Compiled, Box<dyn std::error::Error>> {
    compile(&rpi_driver::read(path)?, options.into())
}

/// Compiles the content of a file and prints its diagnostics. Returns an error if it does not compile, or if a flow that is to be
/// watched does not exist.
fn compile(input: &Input, options: CompileOptions) -> Result<Compiled, Box<dyn std::error::Error>> {
    let compiled = rpi_driver::compile_with(input, options)?;
    print_diagnostics(&compiled);
    usable(compiled, input)
}

/// Returns an error, and prints diagnostics, if commands call external functions, which only C computes.
pub(crate) fn ensure_linked(compiled: &Compiled) -> Result<(), Box<dyn std::error::Error>> {
    let nets = compiled.nets().iter();
    let unlinked: Vec<_> = nets.flat_map(rpi_driver::unlinked_functions).collect();
    if unlinked.is_empty() {
        return Ok(());
    }
    let style = Style::for_stream(&std::io::stderr());
    rpi_diag::print_stderr!("{}", render(&unlinked, &compiled.sources, style));
    Err("a command with external functions cannot run in the control core".into())
}

fn print_diagnostics(compiled: &Compiled) {
    let style = Style::for_stream(&std::io::stderr());
    rpi_diag::print_stderr!(
        "{}",
        render(&compiled.diagnostics, &compiled.sources, style)
    );
}

fn usable(compiled: Compiled, input: &Input) -> Result<Compiled, Box<dyn std::error::Error>> {
    if compiled.has_errors() {
        return Err(format!("{} does not compile", input.path.display()).into());
    }
    match compiled.unknown_flows.first() {
        Some(unknown) => Err(unknown.clone().into()),
        None => Ok(compiled),
    }
}

/// Returns the net of the command called `name`, or of the only command if `name` is `None`. `tasks` gives further
/// valid names for the error message.
pub(crate) fn select_command<'a>(
    compiled: &'a Compiled,
    tasks: &[Task],
    name: Option<&str>,
) -> Result<&'a AnalysedNet, SelectionError> {
    let nets = compiled.nets();
    let unset = compiled.unbound.iter().find(|unset| match name {
        Some(name) => unset.command == name,
        None => nets.is_empty(),
    });
    if let Some(unset) = unset {
        return Err(SelectionError::OpenParameters(unset.clone()));
    }
    let commands = nets.iter().map(|net| &net.name);
    let names = || {
        let all = commands.clone().chain(tasks.iter().map(|task| &task.name));
        all.cloned().collect()
    };
    match (nets, name) {
        ([], _) => Err(SelectionError::NoCommand),
        ([only], None) => Ok(only),
        (_, None) => Err(SelectionError::Ambiguous(names())),
        (_, Some(name)) => nets.iter().find(|n| n.name == name).ok_or_else(|| {
            let (name, known) = (name.to_owned(), names());
            SelectionError::Unknown { name, known }
        }),
    }
}

/// Reason why no command of a program can be selected.
#[derive(Clone, Debug)]
pub(crate) enum SelectionError {
    /// The program has no command.
    NoCommand,
    /// The program has several commands and the user names none. The field holds the names of all commands and tasks.
    Ambiguous(Vec<String>),
    /// The program has no command or task called `name`.
    Unknown {
        name: String,
        /// Names of all commands and tasks of the program.
        known: Vec<String>,
    },
    /// The command has parameters without a value, so that it cannot run alone.
    OpenParameters(UnboundCommand),
}

impl fmt::Display for SelectionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SelectionError::NoCommand => f.write_str(
                "the file has no command; run a node with --node NAME, tests with `rpic test`",
            ),
            SelectionError::Ambiguous(known) => write!(
                f,
                "the file has several commands: {}; choose one with --command NAME",
                known.join(", ")
            ),
            SelectionError::Unknown { name, known } => {
                let known_list = known.join(", ");
                write!(
                    f,
                    "unknown command or task {name}, expected one of {known_list}"
                )?;
                match rpi_diag::suggest(name, known.iter().map(String::as_str)) {
                    Some(similar) => write!(f, "; did you mean {similar}?"),
                    None => Ok(()),
                }
            }
            SelectionError::OpenParameters(command) => f.write_str(&missing_arguments(command)),
        }
    }
}

impl std::error::Error for SelectionError {}

/// Returns the error message for a command that has parameters without a value, with the declarations that are missing.
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
