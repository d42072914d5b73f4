//! Conversion of the steps of a task to the nodes of a plan.

use rpi_diag::Span;
use rpi_image::plan::Target;
use rpi_sema::elab::{self, Argument, MAX_STEPS, MAX_TASK_DEPTH};
use rpi_sema::program::{DeclId, DeclKind};
use rpi_sema::typed::{TaskStep, Unit, UnitId, UnitKind};
use rpi_syntax::ast::{Branch, NextStep, ParallelBranch, ResultPattern, Run, Step, StepKind};

use super::instance::{self, Instances, TaskArgument};
use super::{TaskNode, TaskPlan};
use crate::program::AnalysedProgram;

/// Reason why no plan of a task can be made.
#[derive(Debug)]
pub(super) enum PlanError {
    /// The task cannot be run, for this reason, which is shown when the task is to be run.
    Message(String),
    /// The plan of the task would be too large, because it contains those of all called tasks.
    TooLarge,
}

impl From<String> for PlanError {
    fn from(output: String) -> Self {
        PlanError::Message(output)
    }
}

impl From<&str> for PlanError {
    fn from(output: &str) -> Self {
        PlanError::Message(output.to_owned())
    }
}

/// Returns the plan of the task with this declaration and unit, run on its own with its default arguments.
///
/// # Errors
/// The reason why the task has no plan.
pub(super) fn plan(
    front: &AnalysedProgram<'_>,
    decl: DeclId,
    unit: UnitId,
    instances: &mut Instances,
) -> Result<TaskPlan, PlanError> {
    let mut builder = Builder {
        front,
        nodes: Vec::new(),
        depth: 0,
        instances,
        unit: front.checked.unit(unit),
        known: instance::default_arguments(front, front.checked.unit(unit)),
    };
    let start = builder.task(decl, None, None)?;
    let nodes = builder.nodes;
    instances.planned += nodes.len();
    Ok(TaskPlan { nodes, start })
}

struct Builder<'f> {
    front: &'f AnalysedProgram<'f>,
    nodes: Vec<TaskNode>,
    /// Number of called tasks around the step that is being planned; 0 for the steps of the task itself.
    depth: usize,
    instances: &'f mut Instances,
    /// Task whose steps are being planned: the task itself, or a called one.
    unit: &'f Unit,
    /// Arguments for the parameters of the task in `unit`.
    known: Vec<TaskArgument>,
}

/// Nodes at which the plan continues after the steps of a task or branch.
#[derive(Clone)]
struct Scope {
    /// Node that follows after the last step of the task or branch; `None` for the end of the plan.
    exit: Target,
    /// Node that follows a `fail` result that no branch of a step handles; `None` ends the task with the error.
    fail: Option<Target>,
    /// Label of each labelled step in scope, with the index of its plan node.
    labels: Vec<(String, usize)>,
}

impl<'f> Builder<'f> {
    /// Adds the plan nodes of a task, which continue at `exit`, or at `fail` after an unhandled `fail` result. Returns
    /// the first node. Recursion was excluded by the checker.
    fn task(
        &mut self,
        decl: DeclId,
        exit: Target,
        fail: Option<Target>,
    ) -> Result<Target, PlanError> {
        let DeclKind::Task(task) = self.front.program.decl(decl).kind else {
            return Ok(exit);
        };
        let scope = Scope {
            exit,
            fail,
            labels: Vec::new(),
        };
        self.steps(&task.steps, exit, scope)
    }

    /// Adds the plan nodes of consecutive steps; after the last step the plan continues at `behind`. Returns the first
    /// node.
    fn steps(
        &mut self,
        steps: &[Step],
        behind: Target,
        mut scope: Scope,
    ) -> Result<Target, PlanError> {
        let first = self.nodes.len();
        if self.instances.planned + first + steps.len() > MAX_STEPS || self.depth > MAX_TASK_DEPTH {
            return Err(PlanError::TooLarge);
        }
        self.nodes.resize(first + steps.len(), TaskNode::Goto(None));
        for (at, step) in (first..).zip(steps) {
            if let StepKind::Run(run) = &step.kind
                && let Some(label) = &run.label
            {
                scope.labels.push((label.name.to_string(), at));
            }
        }
        for (at, step) in (first..).zip(steps) {
            let last = at + 1 == first + steps.len();
            let next = if last { behind } else { Some(at + 1) };
            self.nodes[at] = self.step(step, next, &scope)?;
        }
        let start = match steps.is_empty() {
            true => behind,
            false => Some(first),
        };
        Ok(declared_start(steps, &scope)?.or(start))
    }

    fn step(&mut self, step: &Step, next: Target, scope: &Scope) -> Result<TaskNode, PlanError> {
        match &step.kind {
            StepKind::Run(run) => self.run(run, next, scope),
            StepKind::Repeat { count, steps } => {
                let times = count
                    .as_ref()
                    .map(|count| self.times(count.span))
                    .transpose()?;
                self.repeat(times, steps, next, scope)
            }
            StepKind::Parallel(strands) => self.parallel(strands, next, scope),
            StepKind::Start(_) => Ok(TaskNode::Goto(next)),
            StepKind::Error(_) => Err("a step that cannot be read".into()),
        }
    }

    fn repeat(
        &mut self,
        times: Option<u64>,
        steps: &[Step],
        then: Target,
        scope: &Scope,
    ) -> Result<TaskNode, PlanError> {
        let at = self.nodes.len();
        self.nodes.push(TaskNode::Goto(None));
        let body = self.steps(steps, Some(at), scope.clone())?;
        self.nodes[at] = TaskNode::Repeat {
            count: times,
            body,
            next: then,
        };
        Ok(TaskNode::EnterLoop(at))
    }

    /// Adds the plan nodes of parallel branches and returns the node that leads to them. Each branch ends at a node
    /// that waits for the others. A branch left by an error goes through a node that ends the other branches.
    fn parallel(
        &mut self,
        strands: &[ParallelBranch],
        then: Target,
        scope: &Scope,
    ) -> Result<TaskNode, PlanError> {
        let at = self.nodes.len();
        self.nodes.push(TaskNode::Goto(None));
        self.nodes.push(TaskNode::Join);
        let fail = scope.fail.map(|then| {
            self.nodes
                .push(TaskNode::CancelBranches { parallel: at, then });
            Some(self.nodes.len() - 1)
        });
        let join = Some(at + 1);
        let mut begins = Vec::new();
        for strand in strands {
            let inside = Scope {
                exit: join,
                fail,
                labels: Vec::new(),
            };
            begins.push(self.steps(&strand.steps, join, inside)?);
        }
        self.nodes[at] = TaskNode::Parallel {
            branches: begins,
            then,
        };
        Ok(TaskNode::Goto(Some(at)))
    }

    fn run(&mut self, run: &Run, next: Target, scope: &Scope) -> Result<TaskNode, PlanError> {
        let branches = branches(&run.branches, scope)?;
        let otherwise = branches.any.or(run.branches.is_empty().then_some(next));
        let on_fail = branches.fail.or(branches.any).or(scope.fail);
        let is_meant = |step: &&TaskStep| step.span == run.callee.span;
        let step = self.unit.steps.iter().find(is_meant);
        let step = step.ok_or("a step that cannot be read")?;
        let given = instance::step_arguments(self.front, self.unit, &self.known, (step, run))?;
        let callee = self.front.checked.unit(step.unit);
        if callee.kind == UnitKind::Task {
            let unit = std::mem::replace(&mut self.unit, callee);
            let known = std::mem::replace(&mut self.known, given);
            self.depth += 1;
            let start = self.task(step.decl, otherwise.unwrap_or(next), on_fail)?;
            self.depth -= 1;
            (self.unit, self.known) = (unit, known);
            return Ok(TaskNode::Goto(start));
        }
        Ok(TaskNode::Run {
            command: self.instances.name(self.front, step, given),
            on_result: branches.named,
            on_fail,
            default: otherwise,
        })
    }

    /// Returns the number of repetitions that the expression at the location `count` denotes, or an error if it has no
    /// valid value before the task runs.
    fn times(&self, count: Span) -> Result<u64, PlanError> {
        let mut counts = self.unit.repeat_counts.iter();
        let (_, id) = counts
            .find(|(span, _)| *span == count)
            .ok_or("a number of repetitions that cannot be read")?;
        let known: Vec<Argument> = self.known.iter().map(|given| given.value.clone()).collect();
        match elab::evaluate_argument(&self.front.checked.units, self.unit, *id, &known) {
            Argument::Value(leaves) => {
                let times = leaves.first().and_then(|leaf| leaf.as_int()).unwrap_or(0);
                u64::try_from(times)
                    .map_err(|_| format!("{times} repetitions, which is not a valid number").into())
            }
            _ => Err("a number of repetitions that has no value before the task runs".into()),
        }
    }
}

#[derive(Default)]
struct Branches {
    named: Vec<(String, Target)>,
    fail: Option<Target>,
    any: Option<Target>,
}

/// Returns the nodes that follow the results of a step, as its branches say. Of two branches for the same result the
/// first counts.
fn branches(all: &[Branch], scope: &Scope) -> Result<Branches, String> {
    let mut found = Branches::default();
    for branch in all {
        let then = match &branch.next {
            NextStep::End(_) => scope.exit,
            NextStep::Step(label) => Some(labelled(scope, &label.name.to_string())?),
        };
        for on in &branch.results {
            match on {
                ResultPattern::Named(result) => found.named.push((result.name.to_string(), then)),
                ResultPattern::Fail(_) => found.fail = found.fail.or(Some(then)),
                ResultPattern::Any(_) => found.any = found.any.or(Some(then)),
            }
        }
    }
    Ok(found)
}

/// Returns the plan node of the step that a `start` names; `None` if there is no `start`. Of several, the last one
/// counts.
fn declared_start(steps: &[Step], scope: &Scope) -> Result<Target, PlanError> {
    let mut start = None;
    for step in steps {
        if let StepKind::Start(label) = &step.kind {
            start = Some(labelled(scope, &label.name.to_string())?);
        }
    }
    Ok(start)
}

fn labelled(scope: &Scope, label: &str) -> Result<usize, String> {
    let found = scope.labels.iter().rev().find(|(name, _)| name == label);
    found
        .map(|(_, at)| *at)
        .ok_or_else(|| format!("the step {label}, which does not exist"))
}
