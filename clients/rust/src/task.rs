//! Tasks of programs, executed by the server.

use std::cell::RefCell;
use std::sync::mpsc::{Receiver, channel};

use serde_json::{Value, json};

use crate::connection::Client;
use crate::error::Error;
use crate::goal::Ending;

/// Way in which a task has ended, with its commands.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct TaskEnd {
    /// Final state of the task: `done`, `failed` or `cancelled`.
    pub state: String,
    /// Names of the commands that could not be started, and the reason; `None` if all could.
    pub start_error: Option<String>,
    /// Commands of the task that have ended, the latest ones only.
    pub steps: Vec<Step>,
}

/// Command of a task that has ended.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Step {
    /// Name of the command in the program.
    pub command: String,
    /// Way in which the command has ended: cause, result and error.
    pub ending: Ending,
    /// True if a branch of the task handles the error of the command.
    pub handled: bool,
}

/// Loaded task of a session: a program of commands that the server executes by itself.
#[derive(Debug)]
pub struct Task {
    client: Client,
    name: String,
    updates: Receiver<Value>,
    /// Ending of the task, or the error that prevents waiting for the ending; `None` until one of them is known.
    end: RefCell<Option<Result<TaskEnd, Error>>>,
}

impl Task {
    pub(crate) fn load(client: &Client, params: Value) -> Result<Task, Error> {
        let loaded = client.call("task.load", params)?;
        let name = loaded["task"].as_str().unwrap_or_default().to_owned();
        let (listener, updates) = channel();
        // Before `watch.task`: its first update may arrive together with its answer and would be lost.
        client.listen(&name, listener)?;
        client.call("watch.task", json!({"task": name}))?;
        Ok(Task {
            client: client.clone(),
            name,
            updates,
            end: RefCell::default(),
        })
    }

    /// Returns the name that the server has given to the task.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    fn request(&self, method: &str) -> Result<(), Error> {
        let params = json!({"task": self.name});
        self.client.call(method, params).map(drop)
    }

    /// Starts the task.
    ///
    /// # Errors
    /// Returns an error if the task was started before, or if an emergency stop is in force.
    pub fn start(&self) -> Result<(), Error> {
        self.request("task.start")
    }

    /// Cancels the task: no further command starts, and running commands are cancelled.
    ///
    /// # Errors
    /// Returns an error if the task is not running.
    pub fn preempt(&self) -> Result<(), Error> {
        self.request("task.cancel")
    }

    /// Unloads the task. A running task is unloaded as soon as it has ended.
    ///
    /// # Errors
    /// Returns an error if the connection is closed.
    pub fn unload(self) -> Result<(), Error> {
        self.request("task.unload")
    }

    /// Waits for the end of the task and returns it.
    ///
    /// # Errors
    /// Returns an error if the connection is closed first, or if the task is unloaded without having run.
    pub fn result(&self) -> Result<TaskEnd, Error> {
        while self.end.borrow().is_none() {
            let update = self.updates.recv();
            let update = update.map_err(|_| Error::connection("the control core is gone"))?;
            *self.end.borrow_mut() = match update["state"].as_str() {
                Some("done" | "failed" | "cancelled") => Some(Ok(TaskEnd::from_json(&update))),
                Some("unloaded") => Some(Err(Error::unloaded())),
                _ => None,
            };
        }
        let gone = || Err(Error::unloaded());
        self.end.borrow().clone().unwrap_or_else(gone)
    }
}

impl TaskEnd {
    fn from_json(update: &Value) -> TaskEnd {
        let text = |value: &Value| value.as_str().map(str::to_owned);
        let steps = update["ended"].as_array().into_iter().flatten();
        let steps = steps.map(|step| Step {
            command: text(&step["command"]).unwrap_or_default(),
            ending: Ending::from_json(step),
            handled: step["handled"] == true,
        });
        TaskEnd {
            state: text(&update["state"]).unwrap_or_default(),
            start_error: text(&update["trouble"]),
            steps: steps.collect(),
        }
    }
}
