//! Unreachable steps of tasks.

use crate::program::{DeclKind, Lookup, ModuleId, Program};
use crate::unused::unreachable_heads;
use rpi_diag::{Code, Diagnostic, Span};
use rpi_syntax::Name;
use rpi_syntax::ast::{Ident, NextStep, ResultPattern, Run, Step, StepKind, TaskDecl};

/// Returns a warning for each unreachable step of a task. A step that only follows another unreachable step is not
/// reported.
pub(super) fn unreached(
    program: &Program<'_>,
    module: ModuleId,
    task: &TaskDecl,
) -> Vec<Diagnostic> {
    let mut steps = Steps {
        program,
        module,
        all: Vec::new(),
    };
    let start = steps.list(&task.steps, None, &[]);
    let leads: Vec<&[usize]> = steps.all.iter().map(|step| &step.leads[..]).collect();
    let heads = unreachable_heads(&leads, start, |at| steps.all[at].place.is_some());
    let places = heads.into_iter().filter_map(|at| steps.all[at].place);
    places.map(diagnostic).collect()
}

/// Step of a task as a vertex of the graph of steps, with the indices of its successors.
#[derive(Default)]
struct StepVertex<'a> {
    /// Label of the step, and location of the command or task that it runs; for `repeat` and `parallel`, those of the
    /// first one. `None` for a step that runs nothing.
    place: Option<(Option<&'a Ident>, Span)>,
    leads: Vec<usize>,
}

/// Graph of the steps of a task. The steps of an inner list come after those of the list that contains it.
struct Steps<'p, 'a> {
    program: &'p Program<'p>,
    module: ModuleId,
    all: Vec<StepVertex<'a>>,
}

impl<'a> Steps<'_, 'a> {
    /// Adds a list of steps to the graph and returns the index of its first step. `behind` is the step after the list,
    /// and `around` are the labels that are visible around the list, those of inner lists last.
    fn list(
        &mut self,
        steps: &'a [Step],
        behind: Option<usize>,
        around: &[(&'a Name, usize)],
    ) -> Option<usize> {
        let first = self.all.len();
        self.all
            .resize_with(first + steps.len(), StepVertex::default);
        let mut names = around.to_vec();
        for (at, step) in (first..).zip(steps) {
            if let StepKind::Run(run) = &step.kind {
                names.extend(run.label.iter().map(|label| (&label.name, at)));
            }
        }
        let mut start = (!steps.is_empty()).then_some(first).or(behind);
        for (at, step) in (first..).zip(steps) {
            let is_last = at + 1 == first + steps.len();
            let next = if is_last { behind } else { Some(at + 1) };
            if let StepKind::Start(label) = &step.kind {
                start = named(&names, &label.name);
            }
            self.all[at] = self.step(step, at, next, &names);
        }
        start
    }

    fn step(
        &mut self,
        step: &'a Step,
        at: usize,
        next: Option<usize>,
        names: &[(&'a Name, usize)],
    ) -> StepVertex<'a> {
        let (place, leads) = match &step.kind {
            StepKind::Run(run) => (place_of(step), self.targets(run, next, names)),
            StepKind::Repeat { count, steps } => {
                let body = self.list(steps, Some(at), names);
                let next = next.filter(|_| count.is_some());
                (place_of(step), body.into_iter().chain(next).collect())
            }
            StepKind::Parallel(strands) => {
                let strands = strands.iter();
                let starts = strands.filter_map(|strand| self.list(&strand.steps, None, &[]));
                let starts: Vec<usize> = starts.collect();
                (place_of(step), starts.into_iter().chain(next).collect())
            }
            StepKind::Start(_) | StepKind::Error(_) => (None, next.into_iter().collect()),
        };
        StepVertex { place, leads }
    }

    /// Returns the indices of the successors of a step: the targets of its branches, and the next step unless the
    /// branches cover all results.
    fn targets(&self, run: &Run, next: Option<usize>, names: &[(&'a Name, usize)]) -> Vec<usize> {
        let branches = run.branches.iter();
        let to = branches.clone().filter_map(|branch| match &branch.next {
            NextStep::Step(label) => named(names, &label.name),
            NextStep::End(_) => None,
        });
        let is_any = |on: &ResultPattern| matches!(on, ResultPattern::Any(_));
        let mut on = branches.flat_map(|branch| &branch.results);
        // A command with branches has one for each result. A task returns no result except `fail`.
        let goes_on = run.branches.is_empty() || self.is_task(run) && !on.any(is_any);
        to.chain(next.filter(|_| goes_on)).collect()
    }

    fn is_task(&self, run: &Run) -> bool {
        match self.program.lookup(self.module, &run.callee.name.name) {
            Lookup::Found(id) => matches!(self.program.decl(id).kind, DeclKind::Task(_)),
            Lookup::Missing => false,
        }
    }
}

fn named(names: &[(&Name, usize)], label: &Name) -> Option<usize> {
    let found = names.iter().rev().find(|(name, _)| *name == label);
    found.map(|(_, at)| *at)
}

/// Returns the label of a step, and the location of the command or task that it runs first; `None` for a step that runs
/// nothing.
fn place_of(step: &Step) -> Option<(Option<&Ident>, Span)> {
    match &step.kind {
        StepKind::Run(run) => Some((run.label.as_ref(), run.callee.span)),
        StepKind::Repeat { steps, .. } => first_in(steps),
        StepKind::Parallel(strands) => strands.iter().find_map(|strand| first_in(&strand.steps)),
        StepKind::Start(_) | StepKind::Error(_) => None,
    }
}

fn first_in(steps: &[Step]) -> Option<(Option<&Ident>, Span)> {
    let (_, span) = steps.iter().find_map(place_of)?;
    Some((None, span))
}

fn diagnostic((label, span): (Option<&Ident>, Span)) -> Diagnostic {
    let (what, help) = match label {
        Some(Ident { name, .. }) => (
            format!("step `{name}`"),
            format!("add a branch to it (`then {name}`), or delete it"),
        ),
        None => (
            "this step".to_owned(),
            "the step before it never continues with the next one: change its branches, or give its `repeat` a number of times; or delete this step".to_owned(),
        ),
    };
    Diagnostic::new(Code::RPI8007, format!("{what} is unreachable"))
        .primary(span, "this step never runs")
        .help(help)
}
