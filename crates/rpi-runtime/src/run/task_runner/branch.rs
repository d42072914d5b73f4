//! A running part of a task: a command, or parallel branches.

use std::collections::BTreeSet;

use rpi_core::{CommandId, Ending};
use rpi_image::Image;

use super::super::end_text;
use super::super::plan_cursor::{BranchExit, NextStep, PlanCursor};
use super::lookahead::{Planner, Successor};
use super::start_request::{StartError, StartRequest, TaskCommand};
use super::task_core::TaskCore;
use crate::control::Event;

/// What a branch of a running task executes at present: a single command, or parallel branches.
#[derive(Debug)]
pub(super) enum BranchState {
    /// The branch executes a single command.
    Command(TaskCommand),
    /// The branch executes parallel branches.
    Parallel {
        at: PlanCursor,
        branches: Vec<Branch>,
        /// Exit through which the parallel branches are left after an error in one of them; `None` without an error.
        leaving: Option<BranchExit>,
        /// Commands that were last in the branches when their common successor was last scheduled.
        scheduled_for: Vec<CommandId>,
    },
    /// The branch has no command.
    Empty,
}

/// Branch of a running task: the command or the parallel branches that it executes, with their scheduled successors.
#[derive(Debug)]
pub(super) struct Branch {
    pub(super) state: BranchState,
    /// Request that starts the commands of the branch; `None` for a parallel branch, which is started together with its
    /// siblings.
    pub(super) request: Option<StartRequest>,
    /// Scheduled possible successors of the branch; `None` until they are scheduled.
    pub(super) successors: Option<Vec<Successor>>,
    /// Whether the branch was requested to end, so that it has no successor.
    ending: bool,
    /// Whether the branch has ended and waits for its siblings.
    has_ended: bool,
}

/// Progress of a branch of a task after a step.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum BranchProgress {
    /// The branch still runs, and no error has left it.
    Running,
    /// The branch has ended without an unhandled error.
    Ended,
    /// The branch has failed and is left through this exit, but parts of it still run.
    Failing(BranchExit),
    /// The branch has failed and is left through this exit, and no part of it runs.
    Failed(BranchExit),
}

impl Branch {
    pub(super) fn new(spot: BranchState, request: Option<StartRequest>) -> Branch {
        Branch {
            has_ended: matches!(spot, BranchState::Empty),
            state: spot,
            request,
            successors: None,
            ending: false,
        }
    }

    /// Returns the current or, if they have ended, the last commands of the branch.
    pub(super) fn commands(&self) -> Vec<&TaskCommand> {
        match &self.state {
            BranchState::Command(slot) => vec![slot],
            BranchState::Parallel { branches, .. } => {
                branches.iter().flat_map(Branch::commands).collect()
            }
            BranchState::Empty => Vec::new(),
        }
    }

    /// Returns the indices of the branch's commands in the list of images, without duplicates.
    pub(super) fn indices(&self) -> Vec<usize> {
        let indices = self.commands().into_iter().map(|slot| slot.index);
        let unique: BTreeSet<usize> = indices.collect();
        unique.into_iter().collect()
    }

    pub(super) fn handle_event(&mut self, event: &Event) {
        self.request.iter_mut().for_each(|r| r.handle_event(event));
        let ahead = self.successors.iter_mut().flatten();
        ahead.for_each(|successor| successor.branch.handle_event(event));
        match &mut self.state {
            BranchState::Command(slot) => slot.handle_event(event),
            BranchState::Parallel { branches, .. } => {
                branches.iter_mut().for_each(|s| s.handle_event(event))
            }
            BranchState::Empty => {}
        }
    }

    /// Returns true once a command of the branch was started.
    pub(super) fn has_started(&self) -> bool {
        self.commands().iter().any(|slot| slot.first_tick.is_some())
    }

    /// Returns true while the branch has not started and its start request was not refused or dropped.
    pub(super) fn is_pending(&self) -> bool {
        let refused = self.request.as_ref().is_some_and(|r| r.refusal().is_some());
        !self.has_started() && !refused
    }

    /// Requests the branch to end: unloads its successors, then cancels its running commands (rule M11.7 of the
    /// semantics).
    pub(super) fn request_end(&mut self, core: &mut dyn TaskCore) {
        if std::mem::replace(&mut self.ending, true) {
            return;
        }
        for successor in self.successors.iter().flatten() {
            let waiting = successor.branch.commands().into_iter();
            waiting.for_each(|slot| core.unload(slot.id));
        }
        match &mut self.state {
            BranchState::Command(slot) if slot.ending.is_some() => {}
            BranchState::Command(slot) if slot.first_tick.is_some() => core.cancel(slot.id),
            // The start may be pending: the command is cancelled if it runs by then and unloaded otherwise. One of the
            // two requests is refused.
            BranchState::Command(slot) => {
                core.cancel(slot.id);
                core.unload(slot.id);
            }
            BranchState::Parallel { branches, .. } => {
                branches.iter_mut().for_each(|s| s.request_end(core))
            }
            BranchState::Empty => {}
        }
    }

    /// Performs all actions of the branch that are possible now, and returns its progress.
    ///
    /// # Errors
    ///
    /// Returns the commands that could not be started, with the reason.
    pub(super) fn step(&mut self, site: &mut Planner<'_>) -> Result<BranchProgress, StartError> {
        if self.has_ended {
            return Ok(BranchProgress::Ended);
        }
        if let Some(why) = self.refusal() {
            return match self.ending {
                true => self.finish(),
                false => Err(why),
            };
        }
        let waits = self.needs_successors();
        match &self.state {
            BranchState::Command(slot) => match slot.ending {
                None => self.schedule_successors(site),
                // The successors are not loaded yet, as long as the simulated planning time has not passed.
                Some(_) if !site.core.can_plan(slot.first_tick) && waits => {
                    Ok(BranchProgress::Running)
                }
                Some(ending) => self.continue_after(ending, site),
            },
            BranchState::Parallel { .. } => self.step_branches(site),
            BranchState::Empty => self.finish(),
        }
    }

    /// Returns the commands of the branch and the reason for which they were not started and will not be; `None` if
    /// they were started or may still be.
    fn refusal(&self) -> Option<StartError> {
        let why = self.request.as_ref()?.refusal();
        let why = why.filter(|_| !self.has_started())?;
        let indices = self.indices();
        Some(StartError { indices, why })
    }

    /// Returns true if the successors of the branch must be scheduled and are not scheduled yet.
    fn needs_successors(&self) -> bool {
        self.successors.is_none() && !self.ending
    }

    fn finish(&mut self) -> Result<BranchProgress, StartError> {
        self.has_ended = true;
        Ok(BranchProgress::Ended)
    }

    /// Loads and schedules the possible successors of the branch once they are known. Returns that the branch still
    /// runs.
    fn schedule_successors(
        &mut self,
        site: &mut Planner<'_>,
    ) -> Result<BranchProgress, StartError> {
        self.discard_stale_successors(site);
        if self.successors.is_none() && !self.ending {
            self.successors = site.schedule_successors(self)?;
        }
        Ok(BranchProgress::Running)
    }

    /// Discards the scheduled successors of parallel branches if they can no longer start because a branch has moved on
    /// to another command, so that successors are scheduled again.
    fn discard_stale_successors(&mut self, site: &mut Planner<'_>) {
        let now: Vec<CommandId> = self.commands().iter().map(|slot| slot.id).collect();
        let BranchState::Parallel {
            scheduled_for: met, ..
        } = &mut self.state
        else {
            return;
        };
        if *met == now {
            return;
        }
        let ahead = self.successors.as_deref().unwrap_or_default();
        if ahead.iter().all(|successor| successor.is_dropped()) {
            site.unload_refused(ahead);
            self.successors = None;
            *met = now;
        }
    }

    fn continue_after(
        &mut self,
        ending: Ending,
        site: &mut Planner<'_>,
    ) -> Result<BranchProgress, StartError> {
        let BranchState::Command(slot) = &self.state else {
            return Ok(BranchProgress::Running);
        };
        let ahead = self.successors.as_deref().unwrap_or_default();
        if ahead.iter().any(|successor| successor.branch.is_pending()) {
            return Ok(BranchProgress::Running);
        }
        let (id, image) = (slot.id, site.core.image(slot.index));
        let has_next = ahead.iter().any(|successor| successor.branch.has_started());
        let place = match self.ending || has_next {
            true => NextStep::Joined,
            false => next_place(slot, ending, &image, site),
        };
        let fails = place == NextStep::Error;
        if ending.error > 0 && !fails && !self.ending {
            site.core.report_handled(id);
        }
        match place {
            NextStep::Error => {
                self.has_ended = true;
                Ok(BranchProgress::Failed(BranchExit::Error))
            }
            place => self.continue_at(place, site),
        }
    }

    /// Advances the parallel branches in this branch. If one of them fails, the others are requested to end.
    fn step_branches(&mut self, site: &mut Planner<'_>) -> Result<BranchProgress, StartError> {
        let winding = self.ending;
        let BranchState::Parallel {
            at,
            branches,
            leaving,
            ..
        } = &mut self.state
        else {
            return Ok(BranchProgress::Running);
        };
        let mut going = false;
        for branch in branches.iter_mut() {
            match branch.step(site)? {
                BranchProgress::Running => going = true,
                BranchProgress::Ended => {}
                BranchProgress::Failing(exit) => {
                    going = true;
                    leaving.get_or_insert(exit);
                }
                BranchProgress::Failed(exit) => {
                    leaving.get_or_insert(exit);
                }
            }
        }
        let exit = leaving.filter(|_| !winding);
        if exit.is_some() {
            branches.iter_mut().for_each(|s| s.request_end(site.core));
        }
        let out = exit.and_then(|exit| site.plan.after_exit(at, exit));
        let behind = site.plan.after_join(at);
        match (going, exit, out) {
            // An error that leaves this node as well is passed on to the enclosing branch.
            (true, Some(exit), None) => Ok(BranchProgress::Failing(exit)),
            (true, Some(_), Some(_)) => Ok(BranchProgress::Running),
            (true, None, _) => self.schedule_successors(site),
            (false, _, Some(place)) => self.continue_at(place, site),
            (false, Some(exit), None) => {
                self.has_ended = true;
                Ok(BranchProgress::Failed(exit))
            }
            (false, None, None) => match winding {
                true => self.continue_at(NextStep::Joined, site),
                false => self.continue_at(behind, site),
            },
        }
    }

    /// Continues the plan at the step `place` after the current command or branches have ended: with the successor that
    /// the core has started, or by starting the step now.
    fn continue_at(
        &mut self,
        place: NextStep,
        site: &mut Planner<'_>,
    ) -> Result<BranchProgress, StartError> {
        let ahead = self.successors.as_deref().unwrap_or_default();
        if ahead.iter().any(|successor| successor.branch.is_pending()) {
            return Ok(BranchProgress::Running);
        }
        site.unload_refused(ahead);
        let mut ahead = self.successors.take().unwrap_or_default().into_iter();
        let next = match ahead.find(|successor| successor.branch.has_started()) {
            Some(started) => started.branch,
            None => match place {
                NextStep::Run(_) | NextStep::Parallel { .. } => site.start_late(self, place)?,
                NextStep::Exited(exit) => {
                    self.has_ended = true;
                    return Ok(BranchProgress::Failed(exit));
                }
                NextStep::Joined | NextStep::Done | NextStep::Error => return self.finish(),
            },
        };
        let ended = std::mem::replace(self, next);
        ended
            .commands()
            .iter()
            .for_each(|slot| site.core.unload(slot.id));
        if ended.ending {
            self.request_end(site.core);
            return Ok(BranchProgress::Running);
        }
        self.schedule_successors(site)
    }
}

/// Returns the step of the plan that follows a command with this ending: by its result, or an error if the command was
/// cancelled or ended without a result.
fn next_place(slot: &TaskCommand, ending: Ending, image: &Image, site: &Planner<'_>) -> NextStep {
    if ending.cancelled {
        return NextStep::Error;
    }
    match end_text::result_of(image, ending) {
        Some(result) => {
            let named = Some((result.name.as_str(), result.kind));
            site.plan.next_after(&slot.cursor, named)
        }
        None if ending.is_regular() => site.plan.next_after(&slot.cursor, None),
        None => NextStep::Error,
    }
}
