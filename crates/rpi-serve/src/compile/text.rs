//! Compilation of a text in this process.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;

use rpi_driver::{AnalysedNet, Compiled, Input, Program};
use rpi_image::Image;
use rpi_net::CommandInput;

use super::request::{CompileKind, CompileRequest, Language, Source};
use crate::state::ResultConditions;
use crate::task_bundle::TaskBundle;

/// Result of a compilation.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum CompileOutput {
    /// Command, before the names of its devices are resolved.
    Command(Box<CompiledCommand>),
    /// Task, before the names of the devices of its commands are resolved.
    Task(TaskBundle),
    /// Structure of the net of a command, as XML.
    Structure(String),
}

/// Image of a command with the analysis results that the server needs.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct CompiledCommand {
    pub(crate) image: Image,
    /// Upper bound on the work of its primitives in a cycle, in elementary operations.
    pub(crate) work: u64,
    pub(crate) reasons: ResultConditions,
    /// Inputs that are taken over when the command starts (after `given`).
    pub(crate) takeover_inputs: Vec<CommandInput>,
}

/// Compiles a text. A crash of the compiler is an error of the text.
///
/// # Errors
/// All errors of the text.
pub(super) fn compile_guarded(request: &CompileRequest) -> Result<CompileOutput, Vec<String>> {
    let compiled = catch_unwind(AssertUnwindSafe(|| compile(request)));
    compiled.unwrap_or_else(|_| {
        Err(vec![
            "internal error: the compiler crashed on this text".to_owned(),
        ])
    })
}

fn compile(request: &CompileRequest) -> Result<CompileOutput, Vec<String>> {
    let compiled = compiled(&request.source)?;
    let name = request.source.command.as_deref();
    match request.kind {
        CompileKind::Command => {
            let command = lower_command(request, select_net(&compiled, name)?)?;
            Ok(CompileOutput::Command(Box::new(command)))
        }
        CompileKind::Task => lower_task(request, &compiled).map(CompileOutput::Task),
        CompileKind::Structure => {
            let net = select_net(&compiled, name)?;
            Ok(CompileOutput::Structure(crate::web::structure_page(net)))
        }
    }
}

fn lower_command(
    request: &CompileRequest,
    net: &AnalysedNet,
) -> Result<CompiledCommand, Vec<String>> {
    let lowered = rpi_driver::lower_for_tick(net, request.period_ns, request.tick_ns);
    let (image, work) = lowered.map_err(|e| vec![e.to_string()])?;
    Ok(CompiledCommand {
        image,
        work,
        reasons: ResultConditions::from_net(net),
        takeover_inputs: net.command_inputs.clone(),
    })
}

/// Returns the requested task of a program, or its only one.
fn lower_task(request: &CompileRequest, compiled: &Compiled) -> Result<TaskBundle, Vec<String>> {
    let (tasks, wanted) = (&compiled.tasks, request.source.command.as_deref());
    let task = match wanted {
        Some(name) => tasks.iter().find(|task| task.name == name),
        None => tasks.first().filter(|_| tasks.len() == 1),
    };
    let known = || tasks.iter().map(|task| task.name.as_str());
    let task = task.ok_or_else(|| match (tasks.as_slice(), compiled.nets()) {
        ([], [command, ..]) => vec![format!(
            "the text has no task; use `command.load` to load its command {}",
            command.name
        )],
        _ => choice_error("task", wanted, known().collect()),
    })?;
    let lower = |net: &AnalysedNet| {
        let lowered = rpi_driver::lower_for_tick(net, request.period_ns, request.tick_ns);
        lowered.map(|(image, work)| (image, Some(work)))
    };
    TaskBundle::from_task(task, compiled.nets(), lower).map_err(|error| vec![error.to_string()])
}

/// Compiles the text. Returns all errors if there are any.
fn compiled(source: &Source) -> Result<Compiled, Vec<String>> {
    let (name, kind) = match source.language {
        Language::Rpinet => ("from a client/net.rpinet", rpi_driver::InputKind::Rpinet),
        Language::Rpi => ("from a client/program.rpi", rpi_driver::InputKind::Rpi),
    };
    let input = Input {
        path: PathBuf::from(name),
        kind,
        bytes: source.text.as_bytes().to_vec(),
    };
    let options = rpi_driver::CompileOptions {
        claims: rpi_driver::ClaimPolicy::Off,
        // The text has no file, so it must not load modules from the server's folders.
        no_files: true,
        arm_axes: source.arm_axes.into(),
        watch: source.watch.clone(),
        ..Default::default()
    };
    let compiled = rpi_driver::compile_with(&input, options);
    let compiled = compiled.map_err(|e| vec![e.to_string()])?;
    if compiled.has_errors() {
        return Err(error_texts(&compiled));
    }
    let unknown = compiled.unknown_flows.iter().map(ToString::to_string);
    let unknown: Vec<String> = unknown.take(MAX_ERRORS).collect();
    match unknown.is_empty() {
        true => Ok(compiled),
        false => Err(unknown),
    }
}

fn select_net<'a>(
    compiled: &'a Compiled,
    name: Option<&str>,
) -> Result<&'a AnalysedNet, Vec<String>> {
    let Program::Nets(nets) = &compiled.program else {
        return Err(vec!["images cannot be loaded from a client".to_owned()]);
    };
    let found = match (nets.as_slice(), name) {
        ([only], None) => Some(only),
        (all, Some(name)) => all.iter().find(|net| net.name == name),
        (_, None) => None,
    };
    found.ok_or_else(|| {
        choice_error(
            "command",
            name,
            nets.iter().map(|net| net.name.as_str()).collect(),
        )
    })
}

/// Returns the message for a command or task that is ambiguous or unknown.
fn choice_error(what: &str, name: Option<&str>, known: Vec<&str>) -> Vec<String> {
    let there = known.join(", ");
    vec![match known.is_empty() {
        true if what == "task" => "the text has no task".to_owned(),
        true => "the text has no command without open parameters; start one with parameters from a task: `Name(3)`".to_owned(),
        false => match name {
            Some(name) => {
                let meant = rpi_diag::suggest(name, known.into_iter());
                let meant = meant.map_or_else(String::new, |m| format!("; did you mean {m}?"));
                format!("unknown {what} {name} in the text, expected one of: {there}{meant}")
            }
            None => format!("the text has several {what}s; choose one of: {there}"),
        },
    }]
}

/// Maximum number of errors reported to a client: a text of megabytes can have tens of thousands.
const MAX_ERRORS: usize = 100;

/// Returns the errors with position, code and message.
fn error_texts(compiled: &Compiled) -> Vec<String> {
    let errors = compiled
        .diagnostics
        .iter()
        .filter(|f| f.severity() == rpi_diag::Severity::Error);
    let count = errors.clone().count();
    let listed = errors.take(MAX_ERRORS).map(|f| describe(compiled, f));
    let more = (count > MAX_ERRORS).then(|| format!("and {} more", count - MAX_ERRORS));
    listed.chain(more).collect()
}

fn describe(compiled: &Compiled, diagnostic: &rpi_diag::Diagnostic) -> String {
    let at = compiled.sources.line_col(diagnostic.span());
    let (line, col) = (at.line, at.col);
    format!("{line}:{col} {}: {}", diagnostic.code, diagnostic.message)
}
