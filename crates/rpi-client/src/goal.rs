//! Commands with the shape of goal, feedback, result, preempt.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::sync::mpsc::{Receiver, channel};

use serde_json::{Value, json};

use crate::connection::Core;
use crate::error::Error;
use crate::task::Task;

/// What becomes of a session's commands when its connection ends.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub enum OnLoss {
    /// They are asked to end, on path.
    #[default]
    Cancel,
    /// They run on.
    RunOn,
    /// They end at once.
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

/// A text with a command in it.
#[derive(Clone, PartialEq, Debug)]
pub struct Program {
    /// The text.
    pub text: String,
    /// `rpi`, or `rpinet` for a net of the reference system.
    pub language: &'static str,
    /// Which command, if there are several.
    pub command: Option<String>,
    /// Its period in s; 0 for the server's tick.
    pub period: f64,
    /// Least time in s between two updates of what it exports.
    pub feedback: f64,
    /// What becomes of it if its cycles take too long: `count`, `abort:N/M` (it ends at the Nth of M cycles) or `stop:N/M`
    /// (everything does); as the server has it unless said.
    pub on_overrun: Option<String>,
}

impl Program {
    /// A program with one command, in the server's tick, told about every 20 ms.
    #[must_use]
    pub fn rpi(text: impl Into<String>) -> Program {
        Program {
            text: text.into(),
            language: "rpi",
            command: None,
            period: 0.0,
            feedback: 0.02,
            on_overrun: None,
        }
    }
}

/// Owns commands.
#[derive(Clone, Debug)]
pub struct Session {
    core: Core,
    name: String,
}

impl Session {
    pub(crate) fn new(core: Core, name: &Value) -> Session {
        let name = name.as_str().unwrap_or_default().to_owned();
        Session { core, name }
    }

    /// Loads a command; it waits to be started.
    ///
    /// # Errors
    /// Every reason why it cannot run.
    pub fn load(&self, program: &Program) -> Result<Goal, Error> {
        let params = json!({
            "session": self.name,
            "text": program.text,
            "language": program.language,
            "command": program.command,
            "period": program.period,
            "on_overrun": program.on_overrun,
        });
        let loaded = self.core.call("command.load", params)?;
        let name = loaded["command"].as_str().unwrap_or_default().to_owned();
        let (listener, updates) = channel();
        self.core.listen(&name, listener)?;
        let params = json!({"command": name, "period": program.feedback});
        self.core.call("watch.command", params)?;
        Ok(Goal {
            core: self.core.clone(),
            name,
            updates,
            end: RefCell::default(),
        })
    }

    /// Loads a task of a program, in [`Program::command`] the name of the task; it waits to be started.
    ///
    /// # Errors
    /// Every reason why it cannot run.
    pub fn load_task(&self, program: &Program) -> Result<Task, Error> {
        let params = json!({
            "session": self.name,
            "text": program.text,
            "task": program.command,
            "period": program.period,
            "on_overrun": program.on_overrun,
        });
        Task::load(&self.core, params)
    }

    /// Ends all its commands by force.
    ///
    /// # Errors
    /// If there is no connection.
    pub fn close(self) -> Result<(), Error> {
        let params = json!({"session": self.name});
        self.core.call("session.close", params).map(drop)
    }
}

/// What a command exports, as texts that keep every bit, and where it is in its life.
#[derive(Clone, PartialEq, Eq, Default, Debug)]
pub struct Feedback {
    /// `ready`, `scheduled`, `running`, `cancelling`, `terminated`; `unloaded` for one that never ran.
    pub state: String,
    /// By key.
    pub values: BTreeMap<String, String>,
    /// By how much its first set-points did not join those of whoever went before, where they did not.
    pub jump: Option<String>,
}

/// How a command has ended. One that lost a choice, or was unloaded before it ran, has not: see [`Goal::result`].
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Ending {
    /// `result`, `terminate`, `fault`, `aborted`, or that a rule stopped it.
    pub cause: String,
    /// The name of its result.
    pub result: Option<String>,
    /// Its error number, 0 for none.
    pub error: i64,
    /// Number of its cycles.
    pub cycles: u64,
    /// What has happened, where it did not end by itself: a fault, or why it was ended by force.
    pub why: Option<String>,
    /// Where in the program the fault is, or the fragment whose cycles took too long, or what set the device that braked.
    pub place: Option<String>,
    /// Where that stands, `line:column`, if it is in the text that the command was loaded from.
    pub at: Option<String>,
    /// The devices that it left moving, which have braked on their own.
    pub braked: Vec<String>,
    /// By how much its first set-points did not join those of whoever went before, where they did not: which actuator and
    /// quantity, value and limit.
    pub jump: Option<String>,
}

/// A loaded command.
#[derive(Debug)]
pub struct Goal {
    core: Core,
    name: String,
    updates: Receiver<Value>,
    /// Its end, once that was told.
    end: RefCell<Option<Result<Ending, Error>>>,
}

impl Goal {
    /// Its name at the server.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    fn ask(&self, method: &str, more: &Value) -> Result<(), Error> {
        let mut params = json!({"command": self.name});
        for (key, value) in more.as_object().into_iter().flatten() {
            params[key] = value.clone();
        }
        self.core.call(method, params).map(drop)
    }

    /// Starts it.
    ///
    /// # Errors
    /// If something that it needs is held by another command.
    pub fn start(&self) -> Result<(), Error> {
        self.ask("command.start", &Value::Null)
    }

    /// Lets it run in the cycle after the last one of `after`: by any regular end, or by one of these results.
    ///
    /// # Errors
    /// If it needs what others hold.
    pub fn follow(&self, after: &Goal, results: &[&str]) -> Result<(), Error> {
        let more = json!({"after": after.name, "results": results});
        self.ask("command.schedule", &more)
    }

    /// Sets an input; the text is a value in the notation of nets.
    ///
    /// # Errors
    /// If there is no such input, or the text is no value of its type.
    pub fn set(&self, key: &str, value: &str) -> Result<(), Error> {
        self.ask("command.set", &json!({"values": {key: value}}))
    }

    /// Asks it to end, in its own way and on its path.
    ///
    /// # Errors
    /// If it does not run.
    pub fn preempt(&self) -> Result<(), Error> {
        self.ask("command.cancel", &Value::Null)
    }

    /// Ends it at once; devices stop on their own limits.
    ///
    /// # Errors
    /// If it does not run.
    pub fn abort(&self) -> Result<(), Error> {
        self.ask("command.abort", &Value::Null)
    }

    /// Its cycles that took too long.
    ///
    /// # Errors
    /// If it is gone, or there is no connection.
    pub fn overruns(&self) -> Result<Overruns, Error> {
        let params = json!({"command": self.name});
        let told = self.core.call("command.describe", params)?;
        Ok(Overruns::of(&told["overruns"]))
    }

    /// Lets go of it: one that runs is unloaded when it has ended.
    ///
    /// # Errors
    /// If there is no connection.
    pub fn unload(self) -> Result<(), Error> {
        self.ask("command.unload", &Value::Null)
    }

    /// What it tells, until it has ended or the connection has.
    pub fn feedback(&self) -> impl Iterator<Item = Feedback> + '_ {
        let mut known = Feedback::default();
        std::iter::from_fn(move || {
            let update = self.next_update()?;
            if let Some(state) = update["state"].as_str() {
                state.clone_into(&mut known.state);
            }
            for (key, value) in update["values"].as_object().into_iter().flatten() {
                let text = value.as_str().unwrap_or_default().to_owned();
                known.values.insert(key.clone(), text);
            }
            if let Some(jump) = update["jump"].as_str() {
                known.jump = Some(jump.to_owned());
            }
            Some(known.clone())
        })
    }

    /// The next thing that it tells, until it has ended.
    fn next_update(&self) -> Option<Value> {
        if self.end.borrow().is_some() {
            return None;
        }
        let update = self.updates.recv().ok()?;
        let unloaded = (update["state"] == "unloaded").then(|| Err(Error::unloaded()));
        let ended = update.get("ending").map(|ending| Ok(Ending::of(ending)));
        *self.end.borrow_mut() = ended.or(unloaded);
        Some(update)
    }

    /// Waits for its end.
    ///
    /// # Errors
    /// If the connection ends before, or it is unloaded without having run: it has lost a choice, say.
    pub fn result(&self) -> Result<Ending, Error> {
        while self.next_update().is_some() {}
        let gone = || Err(Error::connection("the control core is gone"));
        self.end.borrow().clone().unwrap_or_else(gone)
    }
}

/// Ticks of the server that ended too late and in which a command took the longest. All but the number is of the worst.
#[derive(Clone, PartialEq, Default, Debug)]
pub struct Overruns {
    /// How many there were.
    pub count: u64,
    /// How long the command computed, s.
    pub took: f64,
    /// By how much the tick ended too late, s.
    pub late: f64,
    /// The fragment of the command that was at work; empty for the command itself.
    pub fragment: String,
}

impl Overruns {
    /// From what the server tells, if it tells of any.
    fn of(told: &Value) -> Overruns {
        Overruns {
            count: told["count"].as_u64().unwrap_or_default(),
            took: told["took"].as_f64().unwrap_or_default(),
            late: told["late"].as_f64().unwrap_or_default(),
            fragment: told["fragment"].as_str().unwrap_or_default().to_owned(),
        }
    }
}

impl Ending {
    /// From what the server tells.
    pub(crate) fn of(told: &Value) -> Ending {
        let text = |key: &str| told[key].as_str().map(str::to_owned);
        let braked = told["braked"].as_array().into_iter().flatten();
        let braked = braked.filter_map(Value::as_str).map(str::to_owned);
        Ending {
            cause: text("cause").unwrap_or_default(),
            result: text("result"),
            error: told["error"].as_i64().unwrap_or_default(),
            cycles: told["cycles"].as_u64().unwrap_or_default(),
            why: text("why"),
            place: text("place"),
            at: text("at"),
            braked: braked.collect(),
            jump: text("jump"),
        }
    }
}
