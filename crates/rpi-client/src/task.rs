//! Tasks of programs, which the server carries out.

use std::cell::RefCell;
use std::sync::mpsc::{Receiver, channel};

use serde_json::{Value, json};

use crate::connection::Core;
use crate::error::Error;
use crate::goal::Ending;

/// How a task has ended.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct TaskEnd {
    /// `done`, `failed` or `cancelled`.
    pub state: String,
    /// What could not be started, and why.
    pub trouble: Option<String>,
    /// The latest of its commands that have ended.
    pub steps: Vec<Step>,
}

/// A command of a task that has ended.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Step {
    /// Its name in the program.
    pub command: String,
    /// How it has ended.
    pub ending: Ending,
    /// A branch of the task was for its error.
    pub handled: bool,
}

/// A loaded task.
#[derive(Debug)]
pub struct Task {
    core: Core,
    name: String,
    updates: Receiver<Value>,
    /// Its end, once that was told.
    end: RefCell<Option<Result<TaskEnd, Error>>>,
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
            end: RefCell::default(),
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
    /// If the connection ends before, or it is unloaded without having run.
    pub fn result(&self) -> Result<TaskEnd, Error> {
        while self.end.borrow().is_none() {
            let told = self.updates.recv();
            let told = told.map_err(|_| Error::connection("the control core is gone"))?;
            *self.end.borrow_mut() = match told["state"].as_str() {
                Some("done" | "failed" | "cancelled") => Some(Ok(TaskEnd::of(&told))),
                Some("unloaded") => Some(Err(Error::unloaded())),
                _ => None,
            };
        }
        let gone = || Err(Error::unloaded());
        self.end.borrow().clone().unwrap_or_else(gone)
    }
}

impl TaskEnd {
    fn of(told: &Value) -> TaskEnd {
        let text = |value: &Value| value.as_str().map(str::to_owned);
        let steps = told["ended"].as_array().into_iter().flatten();
        let steps = steps.map(|step| Step {
            command: text(&step["command"]).unwrap_or_default(),
            ending: Ending::of(step),
            handled: step["handled"] == true,
        });
        TaskEnd {
            state: text(&told["state"]).unwrap_or_default(),
            trouble: text(&told["trouble"]),
            steps: steps.collect(),
        }
    }
}
