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

    /// Returns the selection of flows in a command; an empty one if no name begins with its name.
    pub(crate) fn selection_in(&self, command: &str) -> FlowSelection {
        self.commands.borrow_mut().push(command.to_owned());
        let inside = |name: &String| match name.strip_prefix(command)? {
            "" => Some(String::new()),
            rest => rest.strip_prefix('.').map(str::to_owned),
        };
        FlowSelection::new(self.names.iter().filter_map(inside).collect())
    }

    /// Records the names of all flows of a command.
    pub(crate) fn record(&self, command: &str, flows: Vec<String>) {
        let named = flows.into_iter().map(|flow| format!("{command}.{flow}"));
        self.flows.borrow_mut().extend(named);
    }

    /// Returns the watched names that no flow of any command has.
    pub(crate) fn unknown_names(&self) -> Vec<UnknownFlow> {
        let (flows, commands) = (self.flows.borrow(), self.commands.borrow());
        let is_known = |name: &str| flows.iter().any(|flow| name_contains(name, flow));
        let unknown = self.names.iter().filter(|name| !is_known(name));
        let all = || flows.iter().chain(commands.iter()).map(String::as_str);
        let unknown = unknown.map(|name| UnknownFlow {
            name: name.clone(),
            near: suggest(name, all()),
        });
        unknown.collect()
    }
}
