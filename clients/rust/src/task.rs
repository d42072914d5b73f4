//! Tasks of programs, executed by the server.

use std::cell::RefCell;
use std::sync::mpsc::{Receiver, channel};

use serde_json::{Value, json};

use crate::connection::Client;
use crate::error::Error;
use crate::goal::Ending;

/// How a task has ended.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct TaskEnd {
    /// Final state: `done`, `failed` or `cancelled`.
    pub state: String,
    /// Commands that could not be started, and the reason.
    pub start_error: Option<String>,
    /// The latest ended commands of the task.
    pub steps: Vec<Step>,
}

/// An ended command of a task.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Step {
    /// Name of the command in the program.
    pub command: String,
    /// Ending of the command: cause, result and error.
    pub ending: Ending,
    /// Whether a branch of the task handles its error.
    pub handled: bool,
}

/// Loaded task of a session: a sequence of commands that the core runs by itself.
#[derive(Debug)]
pub struct Task {
    client: Client,
    name: String,
    updates: Receiver<Value>,
    /// Ending of the task, or the error that prevents waiting for it; `None` until one of them is known.
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

    /// Returns the name of the task at the server.
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
    /// If the task was started before or an emergency stop is in force.
    pub fn start(&self) -> Result<(), Error> {
        self.request("task.start")
    }

    /// Cancels the task: no further command starts, and running ones are cancelled.
    ///
    /// # Errors
    /// If the task is not running.
    pub fn preempt(&self) -> Result<(), Error> {
        self.request("task.cancel")
    }

    /// Unloads the task. A running one is unloaded when it has ended.
    ///
    /// # Errors
    /// If the connection is closed.
    pub fn unload(self) -> Result<(), Error> {
        self.request("task.unload")
    }

    /// Waits for the end of the task.
    ///
    /// # Errors
    /// If the connection is closed first, or if the task is unloaded without having run.
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
