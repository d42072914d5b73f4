//! Loading of the commands that may follow, and scheduling them by rules on the results of the running ones.

use rpi_core::{CommandId, Condition, Fact, Rule};
use rpi_image::Image;
use rpi_image::image::{CommandEnd, CommandEndKind};

use super::super::plan::ExecutablePlan;
use super::super::plan_cursor::{NextStep, PlanCursor, ResultSet};
use super::branch::{Branch, BranchState};
use super::start_request::{StartError, StartRequest, TaskCommand};
use super::task_core::{NotStartedError, TaskCore};
use crate::control::RequestError;

/// Planner of a running task: the plan, and the control core in which it loads and schedules commands.
pub(super) struct Planner<'s> {
    pub(super) plan: &'s ExecutablePlan,
    pub(super) core: &'s mut dyn TaskCore,
}

/// A successor whose commands are loaded, with the rule that starts them.
#[derive(Debug)]
pub(super) struct Successor {
    pub(super) branch: Branch,
}

impl Successor {
    /// Returns true if the successor was not started and its rule can no longer start it.
    pub(super) fn is_dropped(&self) -> bool {
        !self.branch.is_pending() && !self.branch.has_started()
    }
}

/// Condition under which a successor starts, and the commands that it follows and takes values from.
struct StartCondition {
    after: Vec<TaskCommand>,
    condition: Condition,
}

impl StartCondition {
    fn and(mut self, other: StartCondition) -> StartCondition {
        self.after.extend(other.after);
        self.condition = self.condition & other.condition;
        self
    }
}

impl Planner<'_> {
    /// Loads the commands of a step without predecessors and requests their start. Returns the branch with the
    /// commands.
    ///
    /// # Errors
    ///
    /// Returns the commands that could not be started, with the reason.
    pub(super) fn start_first(&mut self, place: NextStep) -> Result<Branch, StartError> {
        let mut branch = self.load(place)?;
        let commands: Vec<CommandId> = branch.commands().iter().map(|s| s.id).collect();
        let request = match commands.as_slice() {
            [only] => self
                .core
                .start(*only)
                .map(|ticket| StartRequest::new(ticket, None)),
            all => {
                let rule = Rule::when(Condition::always());
                let rule = all.iter().copied().fold(rule, Rule::start);
                self.core
                    .schedule(rule)
                    .map(|(rule, ticket)| StartRequest::new(ticket, Some(rule)))
            }
        };
        branch.request = Some(request.map_err(|why| start_error(branch.indices(), why))?);
        Ok(branch)
    }

    /// Loads and schedules all possible successors of a branch. Returns `None` as long as the successors are not known,
    /// or the simulated planning time has not passed.
    ///
    /// # Errors
    /// Returns the commands that could not be loaded, with the reason.
    pub(super) fn schedule_successors(
        &mut self,
        branch: &Branch,
    ) -> Result<Option<Vec<Successor>>, StartError> {
        let planned = |slot: &&TaskCommand| self.core.can_plan(slot.first_tick);
        if !branch.commands().iter().all(planned) {
            return Ok(None);
        }
        let Some(successors) = self.successor_conditions(branch) else {
            return Ok(None);
        };
        let mut ahead = Vec::new();
        for (place, cause) in successors {
            ahead.push(self.launch(place, cause)?);
        }
        Ok(Some(ahead))
    }

    /// Returns the steps that may follow a branch, with the conditions of their starts; `None` as long as parallel
    /// branches have more commands to run before they join.
    fn successor_conditions(&self, branch: &Branch) -> Option<Vec<(NextStep, StartCondition)>> {
        match &branch.state {
            BranchState::Command(slot) => {
                let image = self.core.image(slot.index);
                let successors = self.plan.possible_next(&slot.cursor, &image).into_iter();
                let goes_on = |place: &NextStep| {
                    matches!(place, NextStep::Run(_) | NextStep::Parallel { .. })
                };
                let successors = successors.filter(|(place, _)| goes_on(place));
                Some(
                    successors
                        .map(|(place, by)| (place, start_condition(slot, &by)))
                        .collect(),
                )
            }
            BranchState::Parallel { at, .. } => match self.plan.after_join(at) {
                NextStep::Joined | NextStep::Done => Some(Vec::new()),
                place => Some(vec![(place, self.end_condition(branch)?)]),
            },
            BranchState::Empty => Some(Vec::new()),
        }
    }

    /// Returns the condition under which a branch has ended; `None` if it has more commands to run before its end.
    fn end_condition(&self, branch: &Branch) -> Option<StartCondition> {
        match &branch.state {
            BranchState::Command(slot) => {
                let image = self.core.image(slot.index);
                let successors = self.plan.possible_next(&slot.cursor, &image).into_iter();
                let by = successors.filter(|(place, _)| *place == NextStep::Joined);
                by.map(|(_, by)| start_condition(slot, &by)).next()
            }
            BranchState::Parallel { branches, .. } => {
                let busy = branches
                    .iter()
                    .filter(|s| !matches!(s.state, BranchState::Empty));
                let mut all = None;
                for branch in busy {
                    let is_split = matches!(&branch.state, BranchState::Parallel { at, .. } if self.plan.after_join(at) != NextStep::Joined);
                    let own = self.end_condition(branch).filter(|_| !is_split)?;
                    all = Some(match all {
                        Some(all) => StartCondition::and(all, own),
                        None => own,
                    });
                }
                all
            }
            BranchState::Empty => None,
        }
    }

    /// Starts a step that was not scheduled in time, after the branch `ended`. The command is started by a rule as
    /// well, so that it takes over in the same way and has the same predecessors. Returns the branch with the new
    /// commands.
    ///
    /// # Errors
    ///
    /// Returns the commands that could not be loaded, with the reason.
    pub(super) fn start_late(
        &mut self,
        ended: &Branch,
        place: NextStep,
    ) -> Result<Branch, StartError> {
        let mut successors = self
            .successor_conditions(ended)
            .unwrap_or_default()
            .into_iter();
        let cause = match successors.find(|(known, _)| *known == place) {
            Some((_, cause)) => {
                let slots = ended.commands().into_iter();
                let yields = slots.map(|s| has_yield(&self.core.image(s.index)));
                let in_motion = yields.fold(false, |all, one| all | one);
                self.core.report_late(in_motion);
                cause
            }
            // The branches were left because of an error, so the next place could not be known in advance.
            None => StartCondition {
                after: ended.commands().into_iter().cloned().collect(),
                condition: Condition::always(),
            },
        };
        Ok(self.launch(place, cause)?.branch)
    }

    /// Unloads the successors in `ahead` whose rule the core refused. The core itself unloads those whose rule it
    /// drops.
    pub(super) fn unload_refused(&mut self, ahead: &[Successor]) {
        let refused = |successor: &&Successor| {
            let request = successor.branch.request.as_ref();
            request.is_some_and(StartRequest::was_refused)
        };
        for successor in ahead.iter().filter(refused) {
            let slots = successor.branch.commands().into_iter();
            slots.for_each(|slot| self.core.unload(slot.id));
        }
    }

    /// Loads the commands of a step and adds the rule that starts them under the condition `cause` and passes values to
    /// their inputs.
    fn launch(&mut self, place: NextStep, cause: StartCondition) -> Result<Successor, StartError> {
        let mut branch = self.load(place)?;
        let mut rule = Rule::when(cause.condition);
        for slot in branch.commands() {
            rule = rule.start(slot.id);
            let image = self.core.image(slot.index);
            for (from, export, input) in self.passed_values(&cause.after, &image) {
                rule = rule.transfer((from, export), (slot.id, input));
            }
        }
        let scheduled = self.core.schedule(rule);
        let (rule, ticket) = scheduled.map_err(|why| start_error(branch.indices(), why))?;
        branch.request = Some(StartRequest::new(ticket, Some(rule)));
        Ok(Successor { branch })
    }

    /// Loads the commands of a step and returns them as a branch. If one cannot be loaded, the others are unloaded.
    fn load(&mut self, place: NextStep) -> Result<Branch, StartError> {
        match place {
            NextStep::Run(cursor) => Ok(Branch::new(
                BranchState::Command(self.load_command(cursor)?),
                None,
            )),
            NextStep::Parallel { at, branches } => {
                let mut loaded: Vec<Branch> = Vec::new();
                for branch in branches {
                    match self.load(branch) {
                        Ok(branch) => loaded.push(branch),
                        Err(why) => {
                            let slots = loaded.iter().flat_map(Branch::commands);
                            slots.for_each(|slot| self.core.unload(slot.id));
                            return Err(why);
                        }
                    }
                }
                let spot = BranchState::Parallel {
                    at,
                    branches: loaded,
                    leaving: None,
                    scheduled_for: Vec::new(),
                };
                Ok(Branch::new(spot, None))
            }
            _ => Ok(Branch::new(BranchState::Empty, None)),
        }
    }

    fn load_command(&mut self, cursor: PlanCursor) -> Result<TaskCommand, StartError> {
        let index = self.plan.command(&cursor);
        let loaded = self.core.load(index);
        let id = loaded.map_err(|why| start_error(vec![index], why))?;
        Ok(TaskCommand {
            id,
            cursor,
            index,
            first_tick: None,
            ending: None,
        })
    }

    /// Returns which exports of the predecessors `from` are passed to inputs of the successor `to`: those with the same
    /// key and type, from the first predecessor with such an export. Each entry is predecessor, export index, input
    /// index.
    fn passed_values(&self, from: &[TaskCommand], to: &Image) -> Vec<(CommandId, u32, u32)> {
        let inputs = to.inputs.iter().zip(0u32..);
        let found = inputs.filter_map(|(input, k)| {
            from.iter().find_map(|slot| {
                let image = self.core.image(slot.index);
                let same = |e: &rpi_image::image::Export| {
                    e.key == input.key && e.value.ty == input.value.ty
                };
                let export = image.exports.iter().position(same)?;
                Some((slot.id, u32::try_from(export).ok()?, k))
            })
        });
        found.collect()
    }
}

fn start_error(indices: Vec<usize>, why: RequestError) -> StartError {
    StartError {
        indices,
        why: NotStartedError::Rejected(why),
    }
}

fn has_yield(image: &Image) -> bool {
    match &image.end {
        CommandEnd::Results(results) => results.iter().any(|r| r.kind == CommandEndKind::Yield),
        CommandEnd::Ports { .. } => false,
    }
}

/// Returns the condition that the command has ended with one of the results in `by`, or without error if it has no
/// named results.
fn start_condition(slot: &TaskCommand, by: &ResultSet) -> StartCondition {
    let fact = |fact: Fact| Condition::from_fact(slot.id, fact);
    let any = |results: &[u32]| {
        let one = results.iter().map(|k| fact(Fact::Result(*k)));
        one.reduce(|a, b| a | b)
    };
    let regular = any(&by.regular).map(|r| fact(Fact::Regular) & r);
    let condition = match (regular, any(&by.failing)) {
        (Some(a), Some(b)) => a | b,
        (Some(one), None) | (None, Some(one)) => one,
        (None, None) => fact(Fact::Regular),
    };
    StartCondition {
        after: vec![slot.clone()],
        condition,
    }
}
