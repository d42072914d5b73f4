//! Tasks of programs, which the server carries out.

use std::sync::mpsc::{Receiver, channel};

use serde_json::{Value, json};

use crate::connection::Core;
use crate::error::Error;

/// How a task has ended.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct TaskEnd {
    /// `done`, `failed` or `cancelled`.
    pub state: String,
    /// What could not be started, and why.
    pub trouble: Option<String>,
    /// The latest of its commands, with the results by which they have ended.
    pub commands: Vec<(String, Option<String>)>,
}

/// A loaded task.
#[derive(Debug)]
pub struct Task {
    core: Core,
    name: String,
    updates: Receiver<Value>,
}

impl Task {
    pub(crate) fn load(core: &Core, params: Value) -> Result<Task, Error> {
        let loaded = core.call("task.load", params)?;
        let name = loaded["task"].as_str().unwrap_or_default().to_owned();
        let (listener, updates) = channel();
        core.listen(&name, listener)?;
        core.call("watch.task", json!({"task": name}))?;
        Ok(Task {
            core: core.clone(),
            name,
            updates,
        })
    }

    /// Its name at the server.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    fn ask(&self, method: &str) -> Result<(), Error> {
        let params = json!({"task": self.name});
        self.core.call(method, params).map(drop)
    }

    /// Starts it.
    ///
    /// # Errors
    /// If it was started before, or everything is stopped.
    pub fn start(&self) -> Result<(), Error> {
        self.ask("task.start")
    }

    /// Asks it to end: nothing follows, and what runs is asked to end.
    ///
    /// # Errors
    /// If it does not run.
    pub fn preempt(&self) -> Result<(), Error> {
        self.ask("task.cancel")
    }

    /// Lets go of it: one that runs is unloaded when it has ended.
    ///
    /// # Errors
    /// If there is no connection.
    pub fn unload(self) -> Result<(), Error> {
        self.ask("task.unload")
    }

    /// Waits for its end.
    ///
    /// # Errors
    /// If the connection ends before.
    pub fn result(&self) -> Result<TaskEnd, Error> {
        loop {
            let told = self
                .core
                .call("task.describe", json!({"task": self.name}))?;
            let state = told["state"].as_str().unwrap_or_default();
            if ["done", "failed", "cancelled"].contains(&state) {
                return Ok(TaskEnd::of(&told));
            }
            let next = self.updates.recv();
            next.map_err(|_| Error::connection("the control core is gone"))?;
        }
    }
}

impl TaskEnd {
    fn of(told: &Value) -> TaskEnd {
        let text = |value: &Value| value.as_str().map(str::to_owned);
        let commands = told["ended"].as_array().into_iter().flatten();
        let commands = commands.map(|step| {
            let title = text(&step["command"]).unwrap_or_default();
            (title, text(&step["result"]))
        });
        TaskEnd {
            state: text(&told["state"]).unwrap_or_default(),
            trouble: text(&told["trouble"]),
            commands: commands.collect(),
        }
    }
}
