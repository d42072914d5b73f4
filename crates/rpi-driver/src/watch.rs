//! Flows that a user watches: their selection in each command, and names that no flow has.

use std::cell::RefCell;
use std::fmt;

use rpi_diag::suggest;
use rpi_sema::elab::{FlowSelection, name_contains};

/// Name of a watched flow that no command has.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct UnknownFlow {
    /// Name that was to be watched.
    pub name: String,
    /// Most similar name of a flow or command; `None` if there is none.
    pub near: Option<String>,
}

impl fmt::Display for UnknownFlow {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "no flow is called `{}`: ", self.name)?;
        match &self.near {
            Some(near) => write!(f, "did you mean `{near}`?"),
            None => f.write_str(
                "write the command, the calls and fragments around the flow, and its name, such as `Move.Approach.way.travelled`",
            ),
        }
    }
}

impl std::error::Error for UnknownFlow {}

/// Names of watched flows, and the flows of the commands in which they were looked for.
pub(crate) struct Watch<'o> {
    names: &'o [String],
    /// Name of each flow of the commands that some name may select, with the name of the command before it.
    flows: RefCell<Vec<String>>,
    /// Names of all commands.
    commands: RefCell<Vec<String>>,
}

impl<'o> Watch<'o> {
    /// Creates the watch for flows with these names, which begin with the name of a command.
    pub(crate) fn new(names: &'o [String]) -> Watch<'o> {
        Watch {
            names,
            flows: RefCell::default(),
            commands: RefCell::default(),
        }
    }

    /// Returns the selection of flows in a command with these names: its own, and for a step of a task with arguments also that with
    /// them, such as `Count(5)`. The selection is empty if no watched name begins with one of them. The empty watched name stands for all
    /// flows of all commands.
    pub(crate) fn selection_in(&self, commands: &[&str]) -> FlowSelection {
        let known = commands.iter().map(|command| (*command).to_owned());
        self.commands.borrow_mut().extend(known);
        let inside = |name: &String, command: &str| match name.strip_prefix(command) {
            _ if name.is_empty() => Some(String::new()),
            Some("") => Some(String::new()),
            rest => rest?.strip_prefix('.').map(str::to_owned),
        };
        let selected = |name: &String| commands.iter().find_map(|command| inside(name, command));
        FlowSelection::new(self.names.iter().filter_map(selected).collect())
    }

    /// Records the names of all flows of a command with these names.
    pub(crate) fn record(&self, commands: &[&str], flows: &[String]) {
        let mut known = self.flows.borrow_mut();
        for command in commands {
            known.extend(flows.iter().map(|flow| format!("{command}.{flow}")));
        }
    }

    /// Returns the watched names that no flow of any command has.
    pub(crate) fn unknown_names(&self) -> Vec<UnknownFlow> {
        let (flows, commands) = (self.flows.borrow(), self.commands.borrow());
        let is_known =
            |name: &str| name.is_empty() || flows.iter().any(|flow| name_contains(name, flow));
        let unknown = self.names.iter().filter(|name| !is_known(name));
        let all = || flows.iter().chain(commands.iter()).map(String::as_str);
        let unknown = unknown.map(|name| UnknownFlow {
            name: name.clone(),
            near: suggest(name, all()),
        });
        unknown.collect()
    }
}
