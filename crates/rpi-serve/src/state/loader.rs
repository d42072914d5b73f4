//! Loader: compiles texts to commands and tasks on its own thread.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use rpi_core::{Command, CommandOverrunPolicy, Continuity};
use rpi_driver::{AnalysedNet, Compiled, Input, Program};
use rpi_image::Image;
use rpi_net::{CommandInput, Net};
use rpi_sim::SimBank;

use super::completion::ResultConditions;
use super::load_queue::LoadQueue;
use crate::fair_share::Client;
use crate::task_bundle::TaskBundle;

/// Language of the text of a command or task.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Language {
    /// Net in the text format of the reference system (`.rpinet`).
    Rpinet,
    /// Program in RPI.
    Rpi,
}

/// Kind of object to load from a text.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum JobKind {
    /// The text contains a command to load.
    Command,
    /// The text contains a task to load.
    Task,
}

/// Job for the loader thread: load a command or task from a text.
pub(crate) struct LoadJob {
    pub(crate) kind: JobKind,
    /// Number of the command or task.
    pub(crate) number: u64,
    pub(crate) session: u64,
    /// Client to which the job counts in the queue.
    pub(crate) client: Option<Client>,
    pub(crate) origin: Source,
    pub(crate) period_ns: u64,
    pub(crate) tick_ns: u64,
    /// Policy for cycles that take too long.
    pub(crate) on_overrun: CommandOverrunPolicy,
}

/// Text of a command or task with the name and the period to load.
#[derive(Clone)]
pub(crate) struct Source {
    pub(crate) language: Language,
    pub(crate) text: Arc<str>,
    /// Name of the command or task within the text; `None` if there is only one.
    pub(crate) command: Option<String>,
}

/// Result of a load job.
pub(crate) enum LoadOutput {
    /// Command that is ready to run.
    Command(LoadedCommand),
    /// Task that is ready to run.
    Task(TaskBundle),
}

/// Command that has been loaded, with the analysis results that the server needs.
pub(crate) struct LoadedCommand {
    pub(crate) command: Box<Command>,
    pub(crate) image: Arc<Image>,
    pub(super) reasons: ResultConditions,
    /// Inputs that are taken over when the command starts (after `given`).
    pub(super) takeover_inputs: Vec<CommandInput>,
    /// Generation of the devices for which the names were resolved; see [`DeviceReplica`].
    pub(crate) generation: u64,
}

/// Copy of the cycle's devices in the same slots, with which names are resolved outside the cycle thread.
pub(crate) struct DeviceReplica {
    pub(crate) bank: SimBank,
    /// Number of changes of the devices.
    pub(crate) generation: u64,
}

/// Callback for the result of a load job, or for all errors.
pub(crate) type LoadCallback = Box<dyn Fn(LoadJob, Result<LoadOutput, Vec<String>>) + Send>;

/// Starts a thread that processes the jobs one by one until the queue is closed. `continuity` is the policy for a
/// takeover with a jump; `None` for the default of the language.
pub(crate) fn start(
    jobs: Arc<LoadQueue>,
    continuity: Option<Continuity>,
    replica: Arc<Mutex<DeviceReplica>>,
    done: LoadCallback,
) -> std::io::Result<()> {
    let work = move || work(&jobs, continuity, &replica, &done);
    std::thread::Builder::new()
        .name("rpi-load".into())
        .spawn(work)?;
    Ok(())
}

fn work(
    jobs: &LoadQueue,
    continuity: Option<Continuity>,
    replica: &Mutex<DeviceReplica>,
    done: &LoadCallback,
) {
    while let Some(job) = jobs.pop() {
        // A crash of the compiler on one text must not end the loader for all clients.
        let loaded = catch_unwind(AssertUnwindSafe(|| match job.kind {
            JobKind::Command => load_command(&job, continuity, replica).map(LoadOutput::Command),
            JobKind::Task => load_task(&job).map(LoadOutput::Task),
        }));
        let loaded = loaded.unwrap_or_else(|_| {
            Err(vec![
                "internal error: the compiler crashed on this text".to_owned(),
            ])
        });
        done(job, loaded);
    }
}

fn load_command(
    job: &LoadJob,
    continuity: Option<Continuity>,
    replica: &Mutex<DeviceReplica>,
) -> Result<LoadedCommand, Vec<String>> {
    let (image, work, reasons, given) = lower_command(job)?;
    let image = Arc::new(image);
    let mut replica = replica.lock().unwrap_or_else(PoisonError::into_inner);
    let generation = replica.generation;
    let mut command = Command::load(Arc::clone(&image), &mut replica.bank)
        .map_err(|faults| faults.iter().map(ToString::to_string).collect::<Vec<_>>())?;
    command.set_continuity(continuity.unwrap_or(match job.origin.language {
        // Nets of the reference system are written for control cores without this check.
        Language::Rpinet => Continuity::Allow,
        Language::Rpi => Continuity::default(),
    }));
    command.set_overrun_policy(job.on_overrun);
    command.set_work_bound(work);
    Ok(LoadedCommand {
        command: Box::new(command),
        image,
        reasons,
        takeover_inputs: given,
        generation,
    })
}

/// Image of a command, bound on the work of its primitives per cycle, conditions of its Booleans, and inputs to take
/// over.
type LoweredCommand = (Image, u64, ResultConditions, Vec<CommandInput>);

fn lower_command(job: &LoadJob) -> Result<LoweredCommand, Vec<String>> {
    let compiled = job.origin.compiled()?;
    let net = select_net(&compiled, job.origin.command.as_deref())?;
    let lowered = rpi_driver::lower_for_tick(net, job.period_ns, job.tick_ns);
    let (image, work) = lowered.map_err(|e| vec![e.to_string()])?;
    Ok((
        image,
        work,
        ResultConditions::from_net(net),
        net.command_inputs.clone(),
    ))
}

/// Returns the requested task of a program, or its only one.
fn load_task(job: &LoadJob) -> Result<TaskBundle, Vec<String>> {
    let compiled = job.origin.compiled()?;
    let tasks = &compiled.tasks;
    let task = match job.origin.command.as_deref() {
        Some(name) => tasks.iter().find(|task| task.name == name),
        None => tasks.first().filter(|_| tasks.len() == 1),
    };
    let known = || tasks.iter().map(|task| task.name.as_str());
    let task = task.ok_or_else(|| match (tasks.as_slice(), compiled.nets()) {
        ([], [command, ..]) => vec![format!(
            "the text has no task; use `command.load` to load its command {}",
            command.name
        )],
        _ => choice_error("task", job.origin.command.as_deref(), known().collect()),
    })?;
    let lower = |net: &AnalysedNet| {
        let lowered = rpi_driver::lower_for_tick(net, job.period_ns, job.tick_ns);
        lowered.map(|(image, work)| (image, Some(work)))
    };
    TaskBundle::from_task(task, compiled.nets(), lower).map_err(|error| vec![error.to_string()])
}

impl Source {
    /// Calls `then` with the net of the text.
    ///
    /// # Errors
    /// All reasons why the text has no such net.
    pub(crate) fn net<T>(
        &self,
        then: impl FnOnce(&Net) -> Result<T, Vec<String>>,
    ) -> Result<T, Vec<String>> {
        then(select_net(&self.compiled()?, self.command.as_deref())?)
    }

    /// Compiles the text. Returns all errors if there are any.
    fn compiled(&self) -> Result<Compiled, Vec<String>> {
        let (name, kind) = match self.language {
            Language::Rpinet => ("from a client/net.rpinet", rpi_driver::InputKind::Rpinet),
            Language::Rpi => ("from a client/program.rpi", rpi_driver::InputKind::Rpi),
        };
        let input = Input {
            path: PathBuf::from(name),
            kind,
            bytes: self.text.as_bytes().to_vec(),
        };
        let options = rpi_driver::CompileOptions {
            claims: rpi_driver::ClaimPolicy::Off,
            // The text has no file, so it must not load modules from the server's folders.
            no_files: true,
            ..Default::default()
        };
        let compiled = rpi_driver::compile_with(&input, options);
        let compiled = compiled.map_err(|e| vec![e.to_string()])?;
        match compiled.has_errors() {
            true => Err(error_texts(&compiled)),
            false => Ok(compiled),
        }
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
