//! Loader: loads commands and tasks from texts on its own threads.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use rpi_core::{Command, CommandOverrunPolicy, Continuity};
use rpi_image::Image;
use rpi_net::CommandInput;
use rpi_sim::SimBank;

use super::completion::ResultConditions;
use super::load_queue::LoadQueue;
use crate::compile::{CompileOutput, CompileRequest, CompiledCommand, Compiler, Language};
use crate::fair_share::Client;
use crate::task_bundle::TaskBundle;

/// Job for the loader thread: load a command or task from a text.
pub(crate) struct LoadJob {
    /// Number of the command or task to load.
    pub(crate) number: u64,
    pub(crate) session: u64,
    /// Client whose queue the job is in; `None` for a job that belongs to no session.
    pub(crate) client: Option<Client>,
    pub(crate) request: CompileRequest,
    /// Time for the compilation, if it is shorter than the one of all texts: how long the client waits.
    pub(crate) timeout: Option<Duration>,
    /// Policy for cycles of the command that take too long.
    pub(crate) on_overrun: CommandOverrunPolicy,
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
    /// Inputs whose values the command takes over from its predecessor when it starts (declared after `given`).
    pub(super) takeover_inputs: Vec<CommandInput>,
    /// Generation of the devices for which the device names were resolved; see [`DeviceReplica`]. If the devices have
    /// changed since, the command is loaded again.
    pub(crate) generation: u64,
}

/// Copy of the cycle's devices in the same slots. The loader resolves device names with it outside the cycle thread.
pub(crate) struct DeviceReplica {
    pub(crate) bank: SimBank,
    /// Number of changes of the devices since the server started.
    pub(crate) generation: u64,
}

/// Callback for the result of a load job: the loaded object, or the messages of all errors.
pub(crate) type LoadCallback = Arc<dyn Fn(LoadJob, Result<LoadOutput, Vec<String>>) + Send + Sync>;

/// Shared data of the loader threads.
#[derive(Clone)]
pub(crate) struct Loader {
    pub(super) jobs: Arc<LoadQueue>,
    pub(super) compiler: Arc<Compiler>,
    /// Policy for a takeover with a jump; `None` for the default of the language.
    pub(super) continuity: Option<Continuity>,
    pub(super) replica: Arc<Mutex<DeviceReplica>>,
    pub(super) done: LoadCallback,
}

impl Loader {
    /// Starts a thread for each text that can be compiled at a time. The threads process jobs until the queue is
    /// closed.
    pub(crate) fn start(&self) -> std::io::Result<()> {
        for _ in 0..self.compiler.places() {
            let loader = self.clone();
            std::thread::Builder::new()
                .name("rpi-load".into())
                .spawn(move || loader.work())?;
        }
        Ok(())
    }

    fn work(&self) {
        while let Some((job, cancelled)) = self.jobs.pop() {
            let client = job.client;
            // A crash on one text must not end the loader for all clients.
            let loaded = catch_unwind(AssertUnwindSafe(|| self.load(&job, &cancelled)));
            let loaded = loaded.unwrap_or_else(|_| {
                Err(vec![
                    "internal error: the loader crashed on this text".to_owned(),
                ])
            });
            (self.done)(job, loaded);
            self.jobs.finish(client);
        }
    }

    fn load(&self, job: &LoadJob, cancelled: &AtomicBool) -> Result<LoadOutput, Vec<String>> {
        match self
            .compiler
            .compile(&job.request, job.timeout, cancelled)?
        {
            CompileOutput::Command(command) => {
                self.load_command(job, *command).map(LoadOutput::Command)
            }
            CompileOutput::Task(task) => Ok(LoadOutput::Task(task)),
            CompileOutput::Structure(_) => Err(vec!["internal error: not a command".to_owned()]),
        }
    }

    /// Resolves the names of the devices of a command.
    fn load_command(
        &self,
        job: &LoadJob,
        compiled: CompiledCommand,
    ) -> Result<LoadedCommand, Vec<String>> {
        let image = Arc::new(compiled.image);
        let mut replica = self.replica.lock().unwrap_or_else(PoisonError::into_inner);
        let generation = replica.generation;
        let mut command = Command::load(Arc::clone(&image), &mut replica.bank)
            .map_err(|faults| faults.iter().map(ToString::to_string).collect::<Vec<_>>())?;
        command.set_continuity(
            self.continuity
                .unwrap_or(match job.request.source.language {
                    // Nets of the reference system are written for control cores without this check.
                    Language::Rpinet => Continuity::Allow,
                    Language::Rpi => Continuity::default(),
                }),
        );
        command.set_overrun_policy(job.on_overrun);
        command.set_work_bound(compiled.work);
        Ok(LoadedCommand {
            command: Box::new(command),
            image,
            reasons: compiled.reasons,
            takeover_inputs: compiled.takeover_inputs,
            generation,
        })
    }
}
