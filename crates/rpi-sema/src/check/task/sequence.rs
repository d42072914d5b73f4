//! First and last steps of a list of steps.

use rpi_syntax::ast::{NextStep, Run, Step, StepKind};

/// Returns the command or task, with its arguments, that a step runs; `None` for other steps such as `repeat`.
pub(super) fn run_of(step: &Step) -> Option<&Run> {
    match &step.kind {
        StepKind::Run(run) => Some(run),
        _ => None,
    }
}

/// Returns the steps with which a list of steps can begin; several if it begins with parallel branches.
pub(super) fn first_steps(steps: &[Step]) -> Vec<&Run> {
    let start = steps.iter().find_map(|step| match &step.kind {
        StepKind::Start(label) => Some(&label.name),
        _ => None,
    });
    let is_start = |run: &&Run| {
        let label = run.label.as_ref().map(|label| &label.name);
        label.is_some() && label == start
    };
    match start {
        None => steps.first().map(entry_steps).unwrap_or_default(),
        Some(_) => {
            let found = steps.iter().filter_map(run_of).find(is_start);
            found.into_iter().collect()
        }
    }
}

/// Returns the commands or tasks that a step runs first. A `parallel` has several.
pub(super) fn entry_steps(step: &Step) -> Vec<&Run> {
    match &step.kind {
        StepKind::Repeat { steps, .. } => first_steps(steps),
        StepKind::Parallel(strands) => strands.iter().flat_map(|s| first_steps(&s.steps)).collect(),
        _ => run_of(step).into_iter().collect(),
    }
}

/// Returns the steps with which a list of steps can end: the last step, and those with a branch to `end`.
pub(super) fn last_steps(steps: &[Step]) -> Vec<&Run> {
    let ends = |run: &&Run| {
        run.branches
            .iter()
            .any(|b| matches!(b.next, NextStep::End(_)))
    };
    let mut all: Vec<&Run> = steps.iter().filter_map(run_of).filter(ends).collect();
    match steps.last().map(|step| &step.kind) {
        Some(StepKind::Run(run)) if run.branches.is_empty() => all.push(run),
        Some(StepKind::Repeat {
            count: Some(_),
            steps,
        }) => all.extend(last_steps(steps)),
        Some(StepKind::Parallel(strands)) => {
            all.extend(strands.iter().flat_map(|s| last_steps(&s.steps)));
        }
        _ => {}
    }
    all
}
