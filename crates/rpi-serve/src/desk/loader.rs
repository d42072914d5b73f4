//! Loading beside the cycle: from a text to a command, on threads of its own.

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

/// What a text is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Language {
    /// A net of the reference system.
    Rpinet,
    /// A program.
    Rpi,
}

/// What is made of a text.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum What {
    /// One of its commands.
    Command,
    /// One of its tasks.
    Task,
}

/// Something to load.
pub(crate) struct Job {
    pub(crate) what: What,
    /// The command's or task's number.
    pub(crate) number: u64,
    pub(crate) session: u64,
    /// Whose turn it takes.
    pub(crate) client: Option<Client>,
    pub(crate) origin: Origin,
    pub(crate) period_ns: u64,
    pub(crate) tick_ns: u64,
    /// What becomes of it if its cycles take too long.
    pub(crate) on_overrun: OnOverrun,
}

/// What a command is loaded from.
#[derive(Clone)]
pub(crate) struct Origin {
    pub(crate) language: Language,
    pub(crate) text: Arc<str>,
    /// Which command or task of the text, if there are several.
    pub(crate) command: Option<String>,
}

/// What was made.
pub(crate) enum Made {
    /// A command that can run.
    Command(Loaded),
    /// What a task needs to run.
    Task(Script),
}

/// What loading has given.
pub(crate) struct Loaded {
    pub(crate) command: Box<Command>,
    pub(crate) image: Arc<Image>,
    pub(super) reasons: Reasons,
    /// Its inputs that stand after `given`.
    pub(super) given: Vec<Given>,
    /// Of which devices the names were resolved: see [`Twin`].
    pub(crate) generation: u64,
}

/// A bank with the same devices in the same places as the cycle's: resolves names beside the cycle.
pub(crate) struct Twin {
    pub(crate) bank: SimBank,
    /// Counts the changes of its devices.
    pub(crate) generation: u64,
}

/// Takes what was loaded, or every reason why not.
pub(crate) type Done = Box<dyn Fn(Job, Result<Made, Vec<String>>) + Send>;

/// Starts a thread that loads one job after the other; it ends when the queue is closed. `continuity` is what happens to
/// commands that take over with a jump, where it is not as usual for their language.
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
        let loaded = catch_unwind(AssertUnwindSafe(|| match job.what {
            What::Command => load(&job, continuity, twin).map(Made::Command),
            What::Task => script(&job).map(Made::Task),
        }));
        let loaded =
            loaded.unwrap_or_else(|_| Err(vec!["the compiler broke down at this text".to_owned()]));
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
        // Nets of the authors' systems are written for control cores without this guard.
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

/// The image of a command, the bound on what its primitives do, why its Booleans can be true, and what it takes over.
type Lowered = (Image, u64, Reasons, Vec<Given>);

fn image(job: &Job) -> Result<Lowered, Vec<String>> {
    let compiled = job.origin.compiled()?;
    let net = choose(&compiled, job.origin.command.as_deref())?;
    let lowered = rpi_driver::lower_for_tick(net, job.period_ns, job.tick_ns);
    let (image, work) = lowered.map_err(|e| vec![e])?;
    Ok((image, work, Reasons::of(net), net.given.clone()))
}

/// The task of a program that was asked for, or its only one.
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
            "there is no task in the text; `command.load` loads its command {}",
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
    /// Hands the net that the text describes to `then`.
    ///
    /// # Errors
    /// Every reason why it describes none.
    pub(crate) fn net<T>(
        &self,
        then: impl FnOnce(&Net) -> Result<T, Vec<String>>,
    ) -> Result<T, Vec<String>> {
        then(choose(&self.compiled()?, self.command.as_deref())?)
    }

    /// The text, compiled without an error.
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
        return Err(vec!["an image is not taken from outside".to_owned()]);
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

/// Asks which one is meant, or tells that there is none of the name that was said.
fn which(what: &str, name: Option<&str>, known: Vec<&str>) -> Vec<String> {
    let there = known.join(", ");
    vec![match known.is_empty() {
        true if what == "task" => "there is no task in the text".to_owned(),
        true => "there is no command in the text that can run as it stands; one whose parameters have no value is run by a task: `Name(3)`".to_owned(),
        false => match name {
            Some(name) => {
                let meant = rpi_diag::suggest(name, known.into_iter());
                let meant = meant.map_or_else(String::new, |m| format!("; did you mean {m}?"));
                format!("there is no {what} {name} in the text, there are: {there}{meant}")
            }
            None => format!("which {what}? There are: {there}"),
        },
    }]
}

/// Findings that a client is told at most: a text of megabytes can hold tens of thousands.
const TOLD: usize = 100;

/// The findings that are errors: where, what.
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
