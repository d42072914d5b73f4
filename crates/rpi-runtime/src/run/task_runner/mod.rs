//! A running task. It plans ahead of its running commands, using only the public interface of the control core.
//!
//! All commands that may follow the running ones are loaded and scheduled by rules on their results. The task continues
//! with the command that the core starts; the core drops the other rules. A command that was not scheduled in time is
//! started when it is ready and counted as late.
//!
//! | file | idea |
//! |---|---|
//! | `task_core.rs` | the interface that a task needs from its environment |
//! | `start_request.rs` | loaded commands and the request that starts them |
//! | `branch.rs` | a running command or parallel branches |
//! | `lookahead.rs` | loading and scheduling of successors |
//!
//! A task is a tree of branches. A branch is at a command or at a parallel node, which has branches of its own.

mod branch;
mod lookahead;
mod start_request;
mod task_core;

use std::borrow::Borrow;

use rpi_core::CommandId;

use super::plan::ExecutablePlan;
use super::plan_cursor::NextStep;
use crate::control::Event;
use branch::{Branch, BranchProgress};
use lookahead::Planner;
use start_request::StartError;

pub use task_core::{NotStartedError, TaskCore};

/// How a task has ended.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum TaskEnd {
    /// The last command of the plan has finished, without an unhandled error.
    Done,
    /// A command ended with an unhandled error or could not be started, or all commands were aborted.
    Failed,
    /// The task was cancelled.
    Cancelled,
}

/// A running task: its plan, owned or borrowed, and the branch that is executed.
#[derive(Debug)]
pub struct Task<P> {
    plan: P,
    root: Option<Branch>,
    cancelled: bool,
    failed: bool,
    end: Option<TaskEnd>,
}

impl<P: Borrow<ExecutablePlan>> Task<P> {
    /// Creates a task with this plan that has not started yet.
    pub fn new(plan: P) -> Task<P> {
        Task {
            plan,
            root: None,
            cancelled: false,
            failed: false,
            end: None,
        }
    }

    /// Returns how the task ended; `None` while it runs. A task that has ended runs no commands.
    pub fn end(&self) -> Option<TaskEnd> {
        self.end
    }

    /// Returns the commands of the task that have not ended: those that run or wait for their immediate start.
    pub fn running(&self) -> Vec<CommandId> {
        let root = self.root.iter();
        let slots = root.flat_map(|branch| branch.commands());
        slots
            .filter(|slot| slot.ending.is_none())
            .map(|slot| slot.id)
            .collect()
    }

    /// Updates the state of the task's commands and rules from an event of the core.
    pub fn handle_event(&mut self, event: &Event) {
        self.root
            .iter_mut()
            .for_each(|root| root.handle_event(event));
    }

    /// Cancels the task: no further command is started, and the running commands are requested to end.
    pub fn cancel(&mut self, core: &mut dyn TaskCore) {
        self.cancelled = true;
        self.request_end(core);
    }

    /// Handles an abort of all commands, such as an emergency stop: no further command is started, and the task has
    /// failed.
    pub fn abort(&mut self, core: &mut dyn TaskCore) {
        self.failed = true;
        self.request_end(core);
    }

    /// Performs all actions of the task that are possible now, such as scheduling successors. Never blocks.
    pub fn advance(&mut self, core: &mut dyn TaskCore) {
        if self.end.is_some() {
            return;
        }
        let mut site = Planner {
            plan: self.plan.borrow(),
            core: &mut *core,
        };
        let step = match &mut self.root {
            Some(root) => root.step(&mut site),
            None => match site.plan.first() {
                NextStep::Run(_) | NextStep::Parallel { .. } => {
                    let begun = site.start_first(site.plan.first());
                    begun.map(|branch| {
                        self.root = Some(branch);
                        BranchProgress::Running
                    })
                }
                _ => Ok(BranchProgress::Ended),
            },
        };
        match step {
            Ok(BranchProgress::Running | BranchProgress::Failing(_)) => {}
            Ok(BranchProgress::Ended) => self.finish(core),
            Ok(BranchProgress::Failed(_)) => {
                self.failed = true;
                self.finish(core);
            }
            Err(error) => self.handle_start_error(error, core),
        }
    }

    /// Reports commands that could not be started, and requests the running commands of the task to end. The task has
    /// failed.
    fn handle_start_error(&mut self, error: StartError, core: &mut dyn TaskCore) {
        core.report_not_started(&error.indices, error.why);
        self.failed = true;
        self.request_end(core);
    }

    fn request_end(&mut self, core: &mut dyn TaskCore) {
        match &mut self.root {
            Some(root) => root.request_end(core),
            None if self.end.is_none() => self.finish(core),
            None => {}
        }
    }

    /// Ends the task after its last command has ended, and unloads its commands.
    fn finish(&mut self, core: &mut dyn TaskCore) {
        self.end = Some(match (self.cancelled, self.failed) {
            (true, _) => TaskEnd::Cancelled,
            (false, true) => TaskEnd::Failed,
            (false, false) => TaskEnd::Done,
        });
        if let Some(root) = &mut self.root {
            root.request_end(core);
            root.commands().iter().for_each(|slot| core.unload(slot.id));
        }
    }
}
