//! Loading of commands and tasks: from the request of a client over the loader thread to the core.

use std::sync::Arc;

use rpi_core::CommandOverrunPolicy;
use rpi_runtime::control::CommandState;

use super::ServerState;
use super::core_link::CoreLink;
use super::defaults::CommandDefaults;
use super::devices::Devices;
use super::eval::{Eval, EvalCallback};
use super::event_log::EventLog;
use super::load_queue::LoadQueue;
use super::loader::{LoadJob, LoadOutput, LoadedCommand};
use super::objects::Objects;
use super::quota::NO_SESSION;
use super::record::CommandRecord;
use super::statistics::Statistics;
use super::tasks::TaskRecord;
use super::types::{ApiError, Phase, Reply, truncated};
use crate::compile::{CompileKind, CompileRequest, Language, Source};
use crate::limits::Limits;
use crate::task_bundle::TaskBundle;

/// Request of a client to load a command or task.
pub(crate) struct LoadRequest<'a> {
    pub(crate) session: &'a str,
    pub(crate) title: &'a str,
    pub(crate) language: Language,
    pub(crate) text: &'a str,
    /// Name of the command or task within the text; `None` if there is only one.
    pub(crate) command: Option<&'a str>,
    /// Period of the command's cycles in nanoseconds; 0 for one tick.
    pub(crate) period_ns: u64,
    /// Policy for cycles that take too long; `None` for the default of the server.
    pub(crate) on_overrun: Option<CommandOverrunPolicy>,
    /// Names of flows that the commands export besides those of the text.
    pub(crate) watch: Vec<&'a str>,
}

impl LoadRequest<'_> {
    /// Returns the number of bytes of text that the server stores for the request.
    fn bytes(&self) -> usize {
        let watched: usize = self.watch.iter().map(|name| name.len()).sum();
        self.text.len() + self.command.map_or(0, str::len) + watched
    }
}

/// Mutable view of the parts of the server state that loading needs.
pub(super) struct Loading<'s> {
    pub(super) objects: &'s mut Objects,
    pub(super) core: &'s mut CoreLink,
    pub(super) jobs: &'s LoadQueue,
    pub(super) devices: &'s Devices,
    pub(super) defaults: &'s CommandDefaults,
    pub(super) log: &'s mut EventLog,
    pub(super) statistics: &'s mut Statistics,
    pub(super) limits: &'s Limits,
}

impl ServerState {
    /// Loads a command on the loader thread. `reply` receives the name of the command.
    pub(crate) fn load(&mut self, load: &LoadRequest<'_>, reply: Reply) {
        match self.objects.sessions.number(load.session) {
            Ok(session) => self.loading().load(session, load, None, reply),
            Err(why) => reply(Err(why)),
        }
    }

    /// Loads a task on the loader thread. `reply` receives the name of the task.
    pub(crate) fn load_task(&mut self, load: &LoadRequest<'_>, reply: Reply) {
        match self.objects.sessions.number(load.session) {
            Ok(session) => self.loading().load_task(session, load, reply),
            Err(why) => reply(Err(why)),
        }
    }

    /// Runs a net, given as `.rpinet` text, for a single cycle and calls `take` with its exports; `reply` receives an
    /// error. The net must not need an actuator that another command holds.
    pub(crate) fn eval(&mut self, text: &str, take: EvalCallback, reply: Reply) {
        let load = LoadRequest {
            session: "",
            title: "eval",
            language: Language::Rpinet,
            text,
            command: None,
            period_ns: 0,
            on_overrun: None,
            watch: Vec::new(),
        };
        let eval = Eval {
            reply,
            callback: take,
        };
        let nobody: Reply = Box::new(|_| ());
        self.loading().load(NO_SESSION, &load, Some(eval), nobody);
    }

    /// Returns the parts of the state that loading needs.
    pub(super) fn loading(&mut self) -> Loading<'_> {
        Loading {
            objects: &mut self.objects,
            core: &mut self.core,
            jobs: &self.jobs,
            devices: &self.devices,
            defaults: &self.defaults,
            log: &mut self.log,
            statistics: &mut self.statistics,
            limits: &self.limits,
        }
    }
}

impl Loading<'_> {
    fn load(&mut self, session: u64, load: &LoadRequest<'_>, eval: Option<Eval>, reply: Reply) {
        let room = self.objects.make_room(session, load.bytes(), self.core);
        if let Err(why) = room {
            return reply(Err(why));
        }
        let number = self.objects.number();
        let title = truncated(load.title, self.limits.name_bytes);
        let mut job = self.job(CompileKind::Command, (number, session), load);
        // Nobody waits for an evaluation any longer.
        job.timeout = eval.is_some().then_some(self.limits.request_timeout);
        let source = &job.request.source;
        let record = CommandRecord {
            origin: Some(source.clone()),
            text: Some(Arc::clone(&source.text)),
            loading: Some(reply),
            eval,
            bytes: load.bytes(),
            ..CommandRecord::new(session, &title, Phase::Core(CommandState::Loading))
        };
        self.objects.commands.insert(number, record);
        self.send(job);
    }

    fn load_task(&mut self, session: u64, load: &LoadRequest<'_>, reply: Reply) {
        let room = self.objects.make_room(session, load.bytes(), self.core);
        if let Err(why) = room {
            return reply(Err(why));
        }
        let number = self.objects.number();
        let title = truncated(load.title, self.limits.name_bytes);
        let job = self.job(CompileKind::Task, (number, session), load);
        let text = (Arc::clone(&job.request.source.text), load.bytes());
        let record = TaskRecord::new(session, title, text, job.on_overrun, reply);
        self.objects.tasks.insert(number, record);
        self.send(job);
    }

    fn job(
        &self,
        kind: CompileKind,
        (number, session): (u64, u64),
        load: &LoadRequest<'_>,
    ) -> LoadJob {
        LoadJob {
            number,
            session,
            client: self.objects.sessions.client_of(session),
            request: CompileRequest {
                kind,
                source: Source {
                    language: load.language,
                    text: load.text.into(),
                    command: load.command.map(str::to_owned),
                    arm_axes: self.defaults.arm_axes,
                    watch: load.watch.iter().map(|name| (*name).to_owned()).collect(),
                },
                period_ns: self.defaults.round_period(load.period_ns),
                tick_ns: self.defaults.tick_ns,
            },
            timeout: None,
            on_overrun: load.on_overrun.unwrap_or(self.defaults.on_overrun),
        }
    }

    fn send(&mut self, job: LoadJob) {
        let number = job.number;
        if !self.jobs.push(job) {
            self.reject(number, ApiError::Limit("queued loads of one client"));
        }
    }

    /// Removes a command or task whose loading failed and reports the error to its client.
    fn reject(&mut self, number: u64, why: ApiError) {
        self.statistics.loads_rejected += 1;
        self.objects.reject(number, why, self.log);
    }

    /// Handles the result of a load job: sends the command to the core or makes the task ready, or reports why loading
    /// failed.
    pub(super) fn loaded(&mut self, job: LoadJob, loaded: Result<LoadOutput, Vec<String>>) {
        match loaded {
            Err(reasons) => self.reject(job.number, ApiError::Rejected(reasons)),
            Ok(LoadOutput::Task(script)) => self.on_task_loaded(job.number, script),
            // Devices were added or removed meanwhile, so the device names must be resolved again.
            Ok(LoadOutput::Command(loaded)) if loaded.generation != self.devices.generation() => {
                self.send(job);
            }
            Ok(LoadOutput::Command(loaded)) => self.insert(job.number, loaded),
        }
    }

    fn insert(&mut self, number: u64, loaded: LoadedCommand) {
        // The command may have been removed with its session while it was being compiled.
        if self.objects.commands.get(number).is_none() {
            return;
        }
        let bytes = loaded.command.instance().footprint();
        let room = self.core.ensure_queue_space();
        let room = room.and_then(|()| self.objects.ensure_memory(number, bytes, self.core));
        if let Err(why) = room {
            return self.reject(number, why);
        }
        let commands = &mut self.objects.commands;
        if let Some(record) = commands.get_mut(number) {
            if record.title.is_empty() {
                record.title.clone_from(&loaded.image.name);
            }
            record.completion.reasons = loaded.reasons;
            record.given = loaded.takeover_inputs;
        }
        match self.core.control.adopt_with_snapshot(loaded.command) {
            Ok(adopted) => {
                self.statistics.loads_accepted += 1;
                commands.register_adopted(number, adopted, loaded.image, bytes, self.core);
            }
            Err(why) => self.reject(number, why.into()),
        }
    }

    fn on_task_loaded(&mut self, number: u64, script: TaskBundle) {
        let bytes = script.images.iter().map(|image| image.memory_bytes()).sum();
        let room = self.objects.ensure_memory(number, bytes, self.core);
        if let Err(why) = room {
            return self.reject(number, why);
        }
        self.statistics.loads_accepted += 1;
        self.objects.tasks.loaded(number, script, bytes);
        self.objects.remove_task_if_abandoned(number);
    }
}
