//! Sessions and commands, with an interface of goal, feedback, result and preempt as in ROS actions.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use serde_json::{Value, json};

use crate::connection::Client;
use crate::error::Error;
use crate::task::Task;

/// Policy of a session for its commands when the connection of the client ends.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub enum OnLoss {
    /// Running commands are cancelled: each ends as its program defines for `cancel`, and stays on its path meanwhile.
    #[default]
    Cancel,
    /// Running commands continue without the client.
    RunOn,
    /// Running commands are aborted: they end at once, and their devices brake on their own.
    Abort,
}

impl OnLoss {
    pub(crate) const fn name(self) -> &'static str {
        match self {
            OnLoss::Cancel => "cancel",
            OnLoss::RunOn => "run-on",
            OnLoss::Abort => "abort",
        }
    }
}

/// Language of a source text that a client loads.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub enum Language {
    /// The text is a program in RPI.
    #[default]
    Rpi,
    /// The text is a net in the format of the reference system (`.rpinet`).
    Rpinet,
}

impl Language {
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Language::Rpi => "rpi",
            Language::Rpinet => "rpinet",
        }
    }
}

/// Source text of a command or task, with the options for loading it.
#[derive(Clone, PartialEq, Debug)]
pub struct Program {
    /// Source text, in the language that `language` names.
    pub text: String,
    /// Language of the source text.
    pub language: Language,
    /// Name of the command or task within the text; `None` if there is only one.
    pub command: Option<String>,
    /// Period of the command; zero for one tick of the server.
    pub period: Duration,
    /// Minimum time between two updates of exported values that the server sends.
    pub feedback_period: Duration,
    /// Policy for overruns (cycles that take too long): `count`, `abort:N/M` (the command ends at the Nth overrun
    /// within M cycles) or `stop:N/M` (everything is stopped). `None` for the default of the server.
    pub on_overrun: Option<String>,
    /// Flows whose values the feedback has besides the exports: names that begin with the command, such as
    /// `Move.Approach.way.travelled`. A name of a command, call or fragment stands for all flows inside. At most 256 names.
    pub watch: Vec<String>,
}

impl Program {
    /// Creates an RPI program with a single command, the period of one server tick, and updates of exported values
    /// every 20 ms.
    #[must_use]
    pub fn new(text: impl Into<String>) -> Program {
        Program {
            text: text.into(),
            language: Language::Rpi,
            command: None,
            period: Duration::ZERO,
            feedback_period: Duration::from_millis(20),
            on_overrun: None,
            watch: Vec::new(),
        }
    }
}

/// Session of a client on the server. It owns the commands and tasks that are loaded in it.
#[derive(Clone, Debug)]
pub struct Session {
    client: Client,
    name: String,
}

impl Session {
    pub(crate) fn new(client: Client, name: &Value) -> Session {
        let name = name.as_str().unwrap_or_default().to_owned();
        Session { client, name }
    }

    /// Loads a command into the session. The command runs after [`Goal::start`] or as a successor ([`Goal::follow`]).
    ///
    /// # Errors
    /// Returns an error with all reasons why the command cannot be loaded.
    pub fn load(&self, program: &Program) -> Result<Goal, Error> {
        let params = json!({
            "session": self.name,
            "text": program.text,
            "language": program.language.name(),
            "command": program.command,
            "period": program.period.as_secs_f64(),
            "on_overrun": program.on_overrun,
            "watch": program.watch,
        });
        let loaded = self.client.call("command.load", params)?;
        let name = loaded["command"].as_str().unwrap_or_default().to_owned();
        let (listener, updates) = channel();
        // Before `watch.command`: its first update may arrive together with its answer and would be lost.
        self.client.listen(&name, listener)?;
        let params = json!({"command": name, "period": program.feedback_period.as_secs_f64()});
        self.client.call("watch.command", params)?;
        Ok(Goal {
            client: self.client.clone(),
            name,
            updates,
            end: RefCell::default(),
        })
    }

    /// Loads the task that [`Program::command`] names into the session. The task runs after [`Task::start`].
    ///
    /// # Errors
    /// Returns an error with all reasons why the task cannot be loaded.
    pub fn load_task(&self, program: &Program) -> Result<Task, Error> {
        let params = json!({
            "session": self.name,
            "text": program.text,
            "task": program.command,
            "period": program.period.as_secs_f64(),
            "on_overrun": program.on_overrun,
            "watch": program.watch,
        });
        Task::load(&self.client, params)
    }

    /// Adds a rule: as soon as the condition `when` is true, the commands in `stop` are stopped, those in `cancel` are
    /// cancelled, and those in `start` are started, all between the same two cycles. Returns the name of the rule.
    ///
    /// # Errors
    /// Returns an error if the condition cannot be parsed, or if other commands hold resources that the commands in
    /// `start` need.
    pub fn add_rule(
        &self,
        when: &str,
        stop: &[&Goal],
        cancel: &[&Goal],
        start: &[&Goal],
    ) -> Result<String, Error> {
        let names = |goals: &[&Goal]| goals.iter().map(|goal| json!(goal.name)).collect::<Value>();
        let params = json!({
            "when": when,
            "stop": names(stop),
            "cancel": names(cancel),
            "start": names(start),
        });
        let made = self.client.call("rule.make", params)?;
        Ok(made["rule"].as_str().unwrap_or_default().to_owned())
    }

    /// Removes the rule with this name, as returned by [`add_rule`](Self::add_rule).
    ///
    /// # Errors
    /// Returns an error if the rule is unknown or has been applied, or if one of its commands belongs to another
    /// client.
    pub fn withdraw_rule(&self, rule: &str) -> Result<(), Error> {
        let params = json!({"rule": rule});
        self.client.call("rule.withdraw", params).map(drop)
    }

    /// Aborts all commands of the session and closes the session.
    ///
    /// # Errors
    /// Returns an error if the connection is closed.
    pub fn close(self) -> Result<(), Error> {
        let params = json!({"session": self.name});
        self.client.call("session.close", params).map(drop)
    }
}

/// State of a command and its exported values. The values are texts that represent them exactly.
#[derive(Clone, PartialEq, Eq, Default, Debug)]
pub struct Feedback {
    /// State of the command: `ready`, `scheduled`, `running`, `cancelling` or `terminated`; `unloaded` if the command
    /// never ran.
    pub state: String,
    /// Latest values of the exported flows by the key of the export, and of the watched flows by their names without that
    /// of the command.
    pub values: BTreeMap<String, String>,
    /// Description of the discontinuity (jump) between the first set-points of the command and those of its
    /// predecessor; `None` if there was none.
    pub discontinuity: Option<String>,
}

impl Feedback {
    /// Takes over what an update of the server contains.
    fn update(&mut self, update: &Value) {
        if let Some(state) = update["state"].as_str() {
            state.clone_into(&mut self.state);
        }
        for (key, value) in update["values"].as_object().into_iter().flatten() {
            let text = value.as_str().unwrap_or_default().to_owned();
            self.values.insert(key.clone(), text);
        }
        if let Some(jump) = update["jump"].as_str() {
            self.discontinuity = Some(jump.to_owned());
        }
    }
}

/// Way in which a command has ended. A command that was unloaded before it ran has no ending: see [`Goal::result`].
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Ending {
    /// Cause of the end: `result`, `terminate`, `fault`, `aborted` or `stopped by a rule`.
    pub cause: String,
    /// Name of the result of the command, if the cause is `result`; else `None`.
    pub result: Option<String>,
    /// Error number of the command; 0 if there is no error.
    pub error: i64,
    /// Number of cycles that the command has run.
    pub cycles: u64,
    /// Description of the fault, or reason of the abort; `None` for other causes.
    pub why: Option<String>,
    /// Path of the node with the fault, of the fragment whose cycles took too long, or of the node that commanded a
    /// device which had to brake; `None` for a normal end.
    pub location: Option<String>,
    /// Position `line:column` of `location` in the text of the command; `None` if it is elsewhere.
    pub position: Option<String>,
    /// Names of the devices that the command left moving at its end, and that have braked on their own.
    pub braked: Vec<String>,
    /// Description of the discontinuity (jump) between the first set-points of the command and those of its
    /// predecessor: actuator, quantity, value and limit. `None` if there was none.
    pub discontinuity: Option<String>,
}

/// Loaded command of a session, which the client can start, observe and cancel. The name is that of ROS actions.
#[derive(Debug)]
pub struct Goal {
    client: Client,
    name: String,
    updates: Receiver<Value>,
    /// Ending of the command, or the error that prevents waiting for the ending; `None` until one of them is known.
    end: RefCell<Option<Result<Ending, Error>>>,
}

impl Goal {
    /// Returns the name that the server has given to the command.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    fn request(&self, method: &str, more: &Value) -> Result<(), Error> {
        let mut params = json!({"command": self.name});
        for (key, value) in more.as_object().into_iter().flatten() {
            params[key] = value.clone();
        }
        self.client.call(method, params).map(drop)
    }

    /// Starts the command on the server.
    ///
    /// # Errors
    /// Returns an error if another command holds a resource that this command needs.
    pub fn start(&self) -> Result<(), Error> {
        self.request("command.start", &Value::Null)
    }

    /// Schedules the command as the successor of `after`. It starts in the cycle after the last one of `after`, if
    /// `after` ends with one of `results`; an empty list stands for any regular end.
    ///
    /// # Errors
    /// Returns an error if other commands hold resources that this command needs.
    pub fn follow(&self, after: &Goal, results: &[&str]) -> Result<(), Error> {
        let more = json!({"after": after.name, "results": results});
        self.request("command.schedule", &more)
    }

    /// Sets an input of the command. `value` is a literal in the notation of nets, such as `{x:1.0,y:2.0,z:3.0}`.
    ///
    /// # Errors
    /// Returns an error if the input is unknown or the text is not a value of its type.
    pub fn set_input(&self, key: &str, value: &str) -> Result<(), Error> {
        self.request("command.set", &json!({"values": {key: value}}))
    }

    /// Sets several inputs of the command between the same two cycles, each by its key and a literal in the notation of nets.
    ///
    /// # Errors
    /// Returns an error if an input is unknown or a text is not a value of its type.
    pub fn set_inputs<'v>(
        &self,
        values: impl IntoIterator<Item = (&'v str, &'v str)>,
    ) -> Result<(), Error> {
        let values = values
            .into_iter()
            .map(|(key, value)| (key.to_owned(), Value::from(value)));
        let values = Value::Object(values.collect());
        self.request("command.set", &json!({"values": values}))
    }

    /// Returns the present state and exported values of the command, without waiting for an update.
    ///
    /// # Errors
    /// Returns an error if the command is unloaded or the connection is closed.
    pub fn present(&self) -> Result<Feedback, Error> {
        let params = json!({"command": self.name});
        let description = self.client.call("command.describe", params)?;
        let mut present = Feedback::default();
        present.update(&description);
        Ok(present)
    }

    /// Cancels the command: the program decides how the command ends, and the devices stay on their paths.
    ///
    /// # Errors
    /// Returns an error if the command is not running.
    pub fn preempt(&self) -> Result<(), Error> {
        self.request("command.cancel", &Value::Null)
    }

    /// Aborts the command: it ends at once, and its devices stop within their own limits.
    ///
    /// # Errors
    /// Returns an error if the command is not running.
    pub fn abort(&self) -> Result<(), Error> {
        self.request("command.abort", &Value::Null)
    }

    /// Returns the overruns of the command: ticks of the server that ended too late because of the command.
    ///
    /// # Errors
    /// Returns an error if the command is unloaded or the connection is closed.
    pub fn overruns(&self) -> Result<Overruns, Error> {
        let params = json!({"command": self.name});
        let description = self.client.call("command.describe", params)?;
        Ok(Overruns::from_json(&description["overruns"]))
    }

    /// Unloads the command. A running command is unloaded as soon as it has ended.
    ///
    /// # Errors
    /// Returns an error if the connection is closed.
    pub fn unload(self) -> Result<(), Error> {
        self.request("command.unload", &Value::Null)
    }

    /// Returns an iterator over the updates of the command, which waits for each update. The iterator ends when the
    /// command or the connection has ended.
    pub fn feedback(&self) -> impl Iterator<Item = Feedback> + '_ {
        let mut known = Feedback::default();
        std::iter::from_fn(move || {
            known.update(&self.next_update()?);
            Some(known.clone())
        })
    }

    /// Waits for the next update of the command and returns it. Returns `None` as soon as the command or the connection
    /// has ended.
    fn next_update(&self) -> Option<Value> {
        if self.end.borrow().is_some() {
            return None;
        }
        let update = self.updates.recv().ok()?;
        let unloaded = (update["state"] == "unloaded").then(|| Err(Error::unloaded()));
        let ended = update
            .get("ending")
            .map(|ending| Ok(Ending::from_json(ending)));
        *self.end.borrow_mut() = ended.or(unloaded);
        Some(update)
    }

    /// Waits for the end of the command and returns it.
    ///
    /// # Errors
    /// Returns an error if the connection is closed first, or if the command is unloaded without having run, for
    /// example because another branch was taken.
    pub fn result(&self) -> Result<Ending, Error> {
        while self.next_update().is_some() {}
        let gone = || Err(Error::connection("the control core is gone"));
        self.end.borrow().clone().unwrap_or_else(gone)
    }
}

/// Overruns of a command: ticks of the server that ended too late and in which this command took the longest. All
/// fields except `count` describe the worst overrun.
#[derive(Clone, PartialEq, Default, Debug)]
pub struct Overruns {
    /// Number of overruns of the command.
    pub count: u64,
    /// Longest computing time of the command in one cycle.
    pub computing_time: Duration,
    /// Delay of the end of the tick behind its deadline.
    pub lateness: Duration,
    /// Path of the fragment that was being computed; empty for the command itself.
    pub fragment: String,
}

impl Overruns {
    /// Reads the overruns from the response of the server; all fields are zero or empty if there are none.
    fn from_json(overruns: &Value) -> Overruns {
        Overruns {
            count: overruns["count"].as_u64().unwrap_or_default(),
            computing_time: seconds(&overruns["took"]),
            lateness: seconds(&overruns["late"]),
            fragment: overruns["fragment"].as_str().unwrap_or_default().to_owned(),
        }
    }
}

/// Reads a time in seconds from JSON; zero if the value is not a number of at least 0.
fn seconds(value: &Value) -> Duration {
    let seconds = value.as_f64().unwrap_or_default();
    Duration::try_from_secs_f64(seconds).unwrap_or_default()
}

impl Ending {
    /// Reads the ending of a command from an update of the server.
    pub(crate) fn from_json(ending: &Value) -> Ending {
        let text = |key: &str| ending[key].as_str().map(str::to_owned);
        let braked = ending["braked"].as_array().into_iter().flatten();
        let braked = braked.filter_map(Value::as_str).map(str::to_owned);
        Ending {
            cause: text("cause").unwrap_or_default(),
            result: text("result"),
            error: ending["error"].as_i64().unwrap_or_default(),
            cycles: ending["cycles"].as_u64().unwrap_or_default(),
            why: text("why"),
            location: text("place"),
            position: text("at"),
            braked: braked.collect(),
            discontinuity: text("jump"),
        }
    }
}
