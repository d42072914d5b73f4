//! Loading beside the cycle: from a text to a command, on threads of its own.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use rpi_core::{Command, Continuity};
use rpi_driver::{Compiled, Input, Program};
use rpi_image::Image;
use rpi_net::Net;
use rpi_sim::SimBank;

use super::completion::Reasons;
use super::queue::Queue;

/// What a text is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Language {
    /// A net of the reference system.
    Rpinet,
    /// A program.
    Rpi,
}

/// Something to load.
pub(crate) struct Job {
    /// The command's number.
    pub(crate) number: u64,
    /// Whose turn it takes.
    pub(crate) session: u64,
    pub(crate) origin: Origin,
    pub(crate) period_ns: u64,
}

/// What a command is loaded from.
#[derive(Clone)]
pub(crate) struct Origin {
    pub(crate) language: Language,
    pub(crate) text: Arc<str>,
    /// Which command of the text, if there are several.
    pub(crate) command: Option<String>,
}

/// What loading has given.
pub(crate) struct Loaded {
    pub(crate) command: Box<Command>,
    pub(crate) image: Arc<Image>,
    pub(super) reasons: Reasons,
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
pub(crate) type Done = Box<dyn Fn(Job, Result<Loaded, Vec<String>>) + Send>;

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
        let loaded = catch_unwind(AssertUnwindSafe(|| load(&job, continuity, twin)));
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
    let (image, reasons) = image(job)?;
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
    Ok(Loaded {
        command: Box::new(command),
        image,
        reasons,
        generation,
    })
}

fn image(job: &Job) -> Result<(Image, Reasons), Vec<String>> {
    job.origin.net(|net| {
        let image = rpi_driver::lower_to_run(net, job.period_ns).map_err(|e| vec![e])?;
        Ok((image, Reasons::of(net)))
    })
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
        let (name, kind) = match self.language {
            Language::Rpinet => ("from a client/net.rpinet", rpi_driver::Kind::Rpinet),
            Language::Rpi => ("from a client/program.rpi", rpi_driver::Kind::Rpi),
        };
        let input = Input {
            path: PathBuf::from(name),
            kind,
            bytes: self.text.as_bytes().to_vec(),
        };
        let compiled = rpi_driver::compile(&input).map_err(|e| vec![e.to_string()])?;
        then(choose(&compiled, self.command.as_deref())?)
    }
}

fn choose<'a>(compiled: &'a Compiled, name: Option<&str>) -> Result<&'a Net, Vec<String>> {
    if compiled.has_errors() {
        return Err(reasons(compiled));
    }
    let Program::Nets(nets) = &compiled.program else {
        return Err(vec!["an image is not taken from outside".to_owned()]);
    };
    let found = match (nets.as_slice(), name) {
        ([only], None) => Some(only),
        (all, Some(name)) => all.iter().find(|net| net.name == name),
        (_, None) => None,
    };
    found.ok_or_else(|| {
        let known: Vec<&str> = nets.iter().map(|net| net.name.as_str()).collect();
        vec![format!("which command? There are: {}", known.join(", "))]
    })
}

/// Every finding that is an error: where, what.
fn reasons(compiled: &Compiled) -> Vec<String> {
    let errors = compiled
        .findings
        .iter()
        .filter(|f| f.severity() == rpi_diag::Severity::Error);
    errors.map(|f| describe(compiled, f)).collect()
}

fn describe(compiled: &Compiled, finding: &rpi_diag::Finding) -> String {
    let at = compiled.sources.line_col(finding.span());
    let (line, col) = (at.line, at.col);
    format!("{line}:{col} {}: {}", finding.code, finding.message)
}
