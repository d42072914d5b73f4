//! Loaded commands and the request that starts them, immediately or by a rule.

use rpi_core::{CommandError, CommandId, Ending, Notice, RuleId, RuleOutcome};

use super::super::plan_cursor::PlanCursor;
use super::task_core::NotStartedError;
use crate::control::{Event, Ticket};

/// A loaded command of a running task, with its position in the plan.
#[derive(Clone, Debug)]
pub(super) struct TaskCommand {
    pub(super) id: CommandId,
    pub(super) cursor: PlanCursor,
    /// Index of the command in the list of images.
    pub(super) index: usize,
    pub(super) first_tick: Option<u64>,
    pub(super) ending: Option<Ending>,
}

impl TaskCommand {
    pub(super) fn handle_event(&mut self, event: &Event) {
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

/// Request to the core that starts commands, directly or by a rule, with the core's answer.
#[derive(Clone, Debug)]
pub(super) struct StartRequest {
    pub(super) ticket: Ticket,
    pub(super) rule: Option<RuleId>,
    /// Reason for which the core refused the request, or the rule failed; `None` if neither happened.
    refused: Option<CommandError>,
    /// Whether the rule that starts the commands was dropped or has failed.
    dropped: bool,
}

impl StartRequest {
    pub(super) fn new(ticket: Ticket, rule: Option<RuleId>) -> StartRequest {
        StartRequest {
            ticket,
            rule,
            refused: None,
            dropped: false,
        }
    }

    pub(super) fn handle_event(&mut self, event: &Event) {
        match *event {
            Event::Answer {
                ticket, refused, ..
            } if ticket == self.ticket => self.refused = refused,
            Event::Notice(Notice::Rule { rule, outcome })
                if Some(rule) == self.rule && outcome != RuleOutcome::Fired =>
            {
                self.dropped = true;
                if let RuleOutcome::Failed(why) = outcome {
                    self.refused = Some(why);
                }
            }
            _ => {}
        }
    }

    /// Returns the reason for which the request starts no command: it was refused, or its rule was dropped. Returns
    /// `None` if the commands were started or may still be started.
    pub(super) fn refusal(&self) -> Option<NotStartedError> {
        let dropped = self.dropped.then_some(NotStartedError::Dropped);
        self.refused.map(NotStartedError::Refused).or(dropped)
    }

    /// Returns true if the core refused the request itself, so that there is no rule. The commands are then still
    /// loaded.
    pub(super) fn was_refused(&self) -> bool {
        self.refused.is_some() && !self.dropped
    }
}

/// Error: one or more commands that were to start together could not be started.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct StartError {
    pub(super) indices: Vec<usize>,
    pub(super) why: NotStartedError,
}
