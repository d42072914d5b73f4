//! Commands that were loaded, and the request that is to start them: at once, or by a rule.

use rpi_core::{CommandId, Ending, Notice, Outcome, Refused, RuleId};

use super::super::walk::Cursor;
use super::workshop::NotStarted;
use crate::control::{Event, Ticket};

/// A command of a task.
#[derive(Clone, Debug)]
pub(super) struct Slot {
    pub(super) id: CommandId,
    pub(super) cursor: Cursor,
    /// Its index in the plan's list.
    pub(super) index: usize,
    pub(super) first_tick: Option<u64>,
    pub(super) ending: Option<Ending>,
}

impl Slot {
    pub(super) fn hear(&mut self, event: &Event) {
        match *event {
            Event::Notice(Notice::Started { command, tick }) if command == self.id => {
                self.first_tick = Some(tick);
            }
            Event::Notice(Notice::Ended {
                command, ending, ..
            }) if command == self.id => self.ending = Some(ending),
            _ => {}
        }
    }
}

/// A request that is to start commands.
#[derive(Clone, Debug)]
pub(super) struct Request {
    pub(super) ticket: Ticket,
    pub(super) rule: Option<RuleId>,
    /// Why it was not carried out.
    refused: Option<Refused>,
    /// Its rule is dropped or has failed.
    dropped: bool,
}

impl Request {
    pub(super) fn new(ticket: Ticket, rule: Option<RuleId>) -> Request {
        Request {
            ticket,
            rule,
            refused: None,
            dropped: false,
        }
    }

    pub(super) fn hear(&mut self, event: &Event) {
        match *event {
            Event::Answer {
                ticket, refused, ..
            } if ticket == self.ticket => self.refused = refused,
            Event::Notice(Notice::Rule { rule, outcome })
                if Some(rule) == self.rule && outcome != Outcome::Fired =>
            {
                self.dropped = true;
                if let Outcome::Failed(why) = outcome {
                    self.refused = Some(why);
                }
            }
            _ => {}
        }
    }

    /// Why it will start nothing, if it will not.
    pub(super) fn refusal(&self) -> Option<NotStarted> {
        let dropped = self.dropped.then_some(NotStarted::Dropped);
        self.refused.map(NotStarted::Refused).or(dropped)
    }

    /// True if it did not even become a rule: what it was to start is still loaded.
    pub(super) fn was_refused(&self) -> bool {
        self.refused.is_some() && !self.dropped
    }
}

/// Commands that do not run, and why: one, or those that were to start together.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct Trouble {
    pub(super) indices: Vec<usize>,
    pub(super) why: NotStarted,
}
