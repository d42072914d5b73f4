//! Loader: compiles texts to commands and tasks on its own thread.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use rpi_core::{Command, Continuity, OnOverrun};
use rpi_driver::{Compiled, Input, Program};
use rpi_image::Image;
use rpi_net::{Given, Net};
use rpi_sim::SimBank;

use super::completion::Reasons;
use super::queue::Queue;
use crate::fair::Client;
use crate::script::Script;

/// Language of a text.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Language {
    /// A net of the reference system.
    Rpinet,
    /// An RPI program.
    Rpi,
}

/// Kind of object to load from a text.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum What {
    /// One of its commands.
    Command,
    /// One of its tasks.
    Task,
}

/// A load job.
pub(crate) struct Job {
    pub(crate) what: What,
    /// Number of the command or task.
    pub(crate) number: u64,
    pub(crate) session: u64,
    /// Client whose turn the job takes in the queue.
    pub(crate) client: Option<Client>,
    pub(crate) origin: Origin,
    pub(crate) period_ns: u64,
    pub(crate) tick_ns: u64,
    /// Policy for cycles that take too long.
    pub(crate) on_overrun: OnOverrun,
}

/// Source of a command or task.
#[derive(Clone)]
pub(crate) struct Origin {
    pub(crate) language: Language,
    pub(crate) text: Arc<str>,
    /// Name of the command or task within the text; `None` if there is only one.
    pub(crate) command: Option<String>,
}

/// Result of a load job.
pub(crate) enum Made {
    /// A command, ready to run.
    Command(Loaded),
    /// A task, ready to run.
    Task(Script),
}

/// A loaded command with its analysis results.
pub(crate) struct Loaded {
    pub(crate) command: Box<Command>,
    pub(crate) image: Arc<Image>,
    pub(super) reasons: Reasons,
    /// Inputs that are taken over when the command starts (after `given`).
    pub(super) given: Vec<Given>,
    /// Generation of the devices for which the names were resolved: see [`Twin`].
    pub(crate) generation: u64,
}

/// A copy of the cycle's devices in the same slots, for resolving names outside the cycle thread.
pub(crate) struct Twin {
    pub(crate) bank: SimBank,
    /// Number of changes of the devices.
    pub(crate) generation: u64,
}

/// Callback for the result of a load job, or for all errors.
pub(crate) type Done = Box<dyn Fn(Job, Result<Made, Vec<String>>) + Send>;

/// Starts a thread that processes the jobs one by one until the queue is closed. `continuity` is the policy for a
/// takeover with a jump; `None` for the default of the language.
pub(crate) fn start(
    jobs: Arc<Queue>,
    continuity: Option<Continuity>,
    twin: Arc<Mutex<Twin>>,
    done: Done,
) -> std::io::Result<()> {
    let work = move || work(&jobs, continuity, &twin, &done);
    std::thread::Builder::new()
        .name("rpi-load".into())
        .spawn(work)?;
    Ok(())
}

fn work(jobs: &Queue, continuity: Option<Continuity>, twin: &Mutex<Twin>, done: &Done) {
    while let Some(job) = jobs.pop() {
        // A crash of the compiler on one text must not end the loader for all clients.
        let loaded = catch_unwind(AssertUnwindSafe(|| match job.what {
            What::Command => load(&job, continuity, twin).map(Made::Command),
            What::Task => script(&job).map(Made::Task),
        }));
        let loaded = loaded.unwrap_or_else(|_| {
            Err(vec![
                "internal error: the compiler crashed on this text".to_owned(),
            ])
        });
        done(job, loaded);
    }
}

fn load(
    job: &Job,
    continuity: Option<Continuity>,
    twin: &Mutex<Twin>,
) -> Result<Loaded, Vec<String>> {
    let (image, work, reasons, given) = image(job)?;
    let image = Arc::new(image);
    let mut twin = twin.lock().unwrap_or_else(PoisonError::into_inner);
    let generation = twin.generation;
    let mut command = Command::load(Arc::clone(&image), &mut twin.bank)
        .map_err(|faults| faults.iter().map(ToString::to_string).collect::<Vec<_>>())?;
    command.guard(continuity.unwrap_or(match job.origin.language {
        // Nets of the reference system are written for control cores without this check.
        Language::Rpinet => Continuity::Allow,
        Language::Rpi => Continuity::default(),
    }));
    command.bound_overruns(job.on_overrun);
    command.bound_work(work);
    Ok(Loaded {
        command: Box::new(command),
        image,
        reasons,
        given,
        generation,
    })
}

/// Image of a command, bound on the work of its primitives per cycle, conditions of its Booleans, and inputs to take
/// over.
type Lowered = (Image, u64, Reasons, Vec<Given>);

fn image(job: &Job) -> Result<Lowered, Vec<String>> {
    let compiled = job.origin.compiled()?;
    let net = choose(&compiled, job.origin.command.as_deref())?;
    let lowered = rpi_driver::lower_for_tick(net, job.period_ns, job.tick_ns);
    let (image, work) = lowered.map_err(|e| vec![e])?;
    Ok((image, work, Reasons::of(net), net.given.clone()))
}

/// Returns the requested task of a program, or its only one.
fn script(job: &Job) -> Result<Script, Vec<String>> {
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
        _ => which("task", job.origin.command.as_deref(), known().collect()),
    })?;
    let lower = |net: &Net| {
        let (image, work) = rpi_driver::lower_for_tick(net, job.period_ns, job.tick_ns)?;
        Ok((image, Some(work)))
    };
    Script::of_task(task, compiled.nets(), lower).map_err(|why| vec![why])
}

impl Origin {
    /// Calls `then` with the net of the text.
    ///
    /// # Errors
    /// All reasons why the text has no such net.
    pub(crate) fn net<T>(
        &self,
        then: impl FnOnce(&Net) -> Result<T, Vec<String>>,
    ) -> Result<T, Vec<String>> {
        then(choose(&self.compiled()?, self.command.as_deref())?)
    }

    /// Compiles the text. Returns all errors if there are any.
    fn compiled(&self) -> Result<Compiled, Vec<String>> {
        let (name, kind) = match self.language {
            Language::Rpinet => ("from a client/net.rpinet", rpi_driver::Kind::Rpinet),
            Language::Rpi => ("from a client/program.rpi", rpi_driver::Kind::Rpi),
        };
        let input = Input {
            path: PathBuf::from(name),
            kind,
            bytes: self.text.as_bytes().to_vec(),
        };
        let asked = rpi_driver::Asked {
            claims: rpi_driver::Claims::Off,
            // The text has no file, so it must not load modules from the server's folders.
            alone: true,
            ..Default::default()
        };
        let compiled = rpi_driver::compile_with(&input, asked);
        let compiled = compiled.map_err(|e| vec![e.to_string()])?;
        match compiled.has_errors() {
            true => Err(reasons(&compiled)),
            false => Ok(compiled),
        }
    }
}

fn choose<'a>(compiled: &'a Compiled, name: Option<&str>) -> Result<&'a Net, Vec<String>> {
    let Program::Nets(nets) = &compiled.program else {
        return Err(vec!["images cannot be loaded from a client".to_owned()]);
    };
    let found = match (nets.as_slice(), name) {
        ([only], None) => Some(only),
        (all, Some(name)) => all.iter().find(|net| net.name == name),
        (_, None) => None,
    };
    found.ok_or_else(|| {
        which(
            "command",
            name,
            nets.iter().map(|net| net.name.as_str()).collect(),
        )
    })
}

/// Returns the message for a command or task that is ambiguous or unknown.
fn which(what: &str, name: Option<&str>, known: Vec<&str>) -> Vec<String> {
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
const TOLD: usize = 100;

/// Returns the errors with position, code and message.
fn reasons(compiled: &Compiled) -> Vec<String> {
    let errors = compiled
        .findings
        .iter()
        .filter(|f| f.severity() == rpi_diag::Severity::Error);
    let count = errors.clone().count();
    let told = errors.take(TOLD).map(|f| describe(compiled, f));
    let more = (count > TOLD).then(|| format!("and {} more", count - TOLD));
    told.chain(more).collect()
}

fn describe(compiled: &Compiled, finding: &rpi_diag::Finding) -> String {
    let at = compiled.sources.line_col(finding.span());
    let (line, col) = (at.line, at.col);
    format!("{line}:{col} {}: {}", finding.code, finding.message)
}
