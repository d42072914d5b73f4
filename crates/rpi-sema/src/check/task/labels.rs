//! Labels that a branch cannot reach because they are in another list of steps.

use rpi_diag::{Code, Diagnostic};
use rpi_syntax::ast::{Ident, NextStep, Step, StepKind};

/// Labels of a task in all of its lists, and the labels to which its branches lead.
#[derive(Default)]
struct TaskLabels<'a> {
    declared: Vec<&'a Ident>,
    used: Vec<&'a Ident>,
}

impl<'a> TaskLabels<'a> {
    fn add(&mut self, steps: &'a [Step]) {
        for step in steps {
            match &step.kind {
                StepKind::Run(run) => {
                    self.declared.extend(&run.label);
                    self.used
                        .extend(run.branches.iter().filter_map(|branch| match &branch.next {
                            NextStep::Step(label) => Some(label),
                            NextStep::End(_) => None,
                        }));
                }
                StepKind::Repeat { steps, .. } => self.add(steps),
                StepKind::Parallel(branches) => {
                    branches.iter().for_each(|branch| self.add(&branch.steps));
                }
                StepKind::Start(label) => self.used.push(label),
                StepKind::Error(_) => {}
            }
        }
    }
}

/// Adds to the diagnostics about undefined steps where another list of the task has a step of that name.
pub(super) fn hint_labels_elsewhere(diagnostics: &mut [Diagnostic], steps: &[Step]) {
    if diagnostics.is_empty() {
        return;
    }
    let mut labels = TaskLabels::default();
    labels.add(steps);
    for diagnostic in diagnostics {
        let place = diagnostic.span();
        let used = labels.used.iter().find(|label| label.span == place);
        let Some(used) = used.filter(|_| diagnostic.code == Code::RPI1001) else {
            continue;
        };
        let mut declared = labels.declared.iter();
        let Some(declared) = declared.find(|label| label.name == used.name) else {
            continue;
        };
        diagnostic.message = format!("the step `{}` cannot be reached from here", used.name);
        diagnostic.labels[0].text = "a branch to another list of steps".to_owned();
        diagnostic.add_secondary(declared.span, "declared in this list");
    }
}
