//! A second implementation of the control core as the manual describes it, as simple as possible.
//!
//! It shares only type names with the core. Numbers in comments are the rules of the manual's chapter.

mod conditions;
mod cycle;
mod decision;
mod requests;
mod resources;

use std::collections::{BTreeMap, BTreeSet};

use rpi_core::{
    AbortReason, Cause, CommandError, CommandId, CommandState, Continuity, Fact, RuleId,
};

use crate::cell::{Axes, KINDS};
use crate::expr::Expr;

/// The end of a command.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct End {
    pub(crate) cause: EndCause,
    pub(crate) error: i64,
    pub(crate) cancelled: bool,
    pub(crate) cycles: u64,
    pub(crate) left_moving: bool,
}

/// A cause without the details of a fault.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) enum EndCause {
    Result(usize),
    Fault,
    Aborted(AbortReason),
    Stopped(RuleId),
}

impl From<Cause> for EndCause {
    fn from(cause: Cause) -> EndCause {
        match cause {
            Cause::Result(k) => EndCause::Result(k),
            Cause::Terminate => EndCause::Result(usize::MAX),
            Cause::Fault(_) => EndCause::Fault,
            Cause::Aborted(why) => EndCause::Aborted(why),
            Cause::Stopped(rule) => EndCause::Stopped(rule),
        }
    }
}

#[derive(Clone, Debug)]
pub(crate) struct ModelCommand {
    pub(crate) kind: usize,
    pub(crate) guard: Continuity,
    /// The command was started by a rule.
    pub(crate) joins: bool,
    pub(crate) state: CommandState,
    pub(crate) holds: BTreeSet<u32>,
    pub(crate) kept: bool,
    pub(crate) cycles: u64,
    pub(crate) due: u64,
    pub(crate) first: Option<u64>,
    pub(crate) end: Option<End>,
    /// Inputs.
    pub(crate) how: i64,
    pub(crate) flag: bool,
    pub(crate) speed: f64,
    /// Export after the latest cycle.
    pub(crate) shown: Option<bool>,
    pub(crate) covered: bool,
    pub(crate) leaving: bool,
    pub(crate) live: bool,
}

impl ModelCommand {
    pub(crate) fn needs(&self) -> &'static [u32] {
        KINDS[self.kind].0
    }

    pub(crate) fn runs(&self) -> bool {
        matches!(self.state, CommandState::Running | CommandState::Cancelling)
    }
}

#[derive(Clone, Debug)]
pub(crate) struct ModelRule {
    pub(crate) condition: Expr,
    pub(crate) stop: Vec<CommandId>,
    pub(crate) cancel: Vec<CommandId>,
    pub(crate) start: Vec<CommandId>,
    pub(crate) kept: bool,
}

impl ModelRule {
    /// R3: predecessors of the rule.
    pub(crate) fn predecessors(&self) -> Vec<CommandId> {
        let names = self.condition.mentioned_commands().into_iter();
        let required = names.filter(|id| self.condition.requires(*id));
        required.chain(self.stop.iter().copied()).collect()
    }
}

pub(crate) struct Model {
    pub(crate) commands: BTreeMap<CommandId, ModelCommand>,
    pub(crate) rules: Vec<(RuleId, ModelRule, Vec<CommandId>)>,
    pub(crate) axes: Axes,
    pub(crate) tick: u64,
    /// A discontinuity in this tick stops all commands.
    pub(crate) stops: bool,
    pub(crate) room: usize,
    /// Orphaned commands that wait to be taken out.
    pub(crate) gone: BTreeSet<CommandId>,
}

pub(crate) type Answer = Result<(), CommandError>;

impl Model {
    pub(crate) fn new(room: usize) -> Model {
        Model {
            commands: BTreeMap::new(),
            rules: Vec::new(),
            axes: Axes::new(),
            tick: 0,
            stops: false,
            room,
            gone: BTreeSet::new(),
        }
    }

    pub(crate) fn insert(&mut self, id: CommandId, kind: usize, guard: Continuity) {
        let cmd = ModelCommand {
            kind,
            guard,
            joins: false,
            state: CommandState::Ready,
            holds: BTreeSet::new(),
            kept: false,
            cycles: 0,
            due: 0,
            first: None,
            end: None,
            how: 0,
            flag: false,
            speed: 0.0,
            shown: None,
            covered: false,
            leaving: false,
            live: true,
        };
        self.commands.insert(id, cmd);
    }

    pub(crate) fn cmd(&self, id: CommandId) -> Result<&ModelCommand, CommandError> {
        self.commands.get(&id).ok_or(CommandError::Unknown)
    }

    pub(crate) fn holders(&self, resource: u32) -> Vec<CommandId> {
        let holds = self
            .commands
            .iter()
            .filter(|(_, c)| c.holds.contains(&resource));
        // Same order as the table of the core.
        let mut all: Vec<_> = holds.map(|(id, _)| *id).collect();
        all.sort_by_key(|id| id.slot());
        all
    }

    pub(crate) fn change(&mut self, id: CommandId, change: impl FnOnce(&mut ModelCommand)) {
        if let Some(cmd) = self.commands.get_mut(&id) {
            change(cmd);
        }
    }

    pub(crate) fn running(&self) -> Vec<CommandId> {
        let mut all: Vec<_> = self.commands.keys().copied().collect();
        all.retain(|id| self.commands[id].runs());
        all.sort_by_key(|id| id.slot());
        all
    }
}

/// Stops an axis as its device would.
pub(crate) fn brake(axes: &mut Axes, resource: u32) {
    axes.moving[resource as usize] = false;
    axes.steps[resource as usize] = 0.0;
    axes.stops[resource as usize] += 1;
}

/// C2 and L6: whether a fact is true of an ended command.
pub(crate) fn fact_holds(fact: Fact, end: &End) -> bool {
    let by_result = matches!(end.cause, EndCause::Result(_));
    match fact {
        Fact::Export(_) => false,
        Fact::Ended => true,
        Fact::Regular => by_result && end.error == 0 && !end.cancelled,
        Fact::Failed => end.error != 0,
        Fact::Result(k) => end.cause == EndCause::Result(k as usize),
        Fact::Error(number) => end.error == number,
    }
}
