//! Printing of tasks, with their steps in columns.

use super::Printer;
use super::body::{block, one_line_body};
use super::layout::{Doc, concat, group, indent, nothing, text, word};
use crate::ast::*;

/// Column widths of adjacent steps.
#[derive(Clone, Copy, Default)]
struct Columns {
    /// Width of the labels, with `:` and a space.
    label: usize,
    /// Width of the calls; 0 if the branches after them are not aligned.
    call: usize,
}

impl Printer<'_> {
    pub(super) fn task(&mut self, task: &TaskDecl) -> Doc {
        let name = self.name(&task.name);
        let statics = self.static_params(&task.statics);
        let params = self.params(&task.params);
        let head = group(concat([word("task "), name, statics, indent(params)]));
        let steps = self.steps(&task.steps);
        concat([head, Doc::Hard, block("let", steps, "tel")])
    }

    fn steps(&mut self, steps: &[Step]) -> Doc {
        let columns = self.columns(steps);
        self.lines(
            steps,
            |step| step.span,
            |p, i, step| {
                let doc = p.doc_lines(step.doc.as_ref());
                (concat([doc, p.step(&step.kind, columns[i])]), false)
            },
        )
    }

    fn step(&mut self, kind: &StepKind, columns: Columns) -> Doc {
        match kind {
            StepKind::Run(run) => self.run(run, columns),
            StepKind::Start(label) => text(format!("start {};", label.name)),
            StepKind::Repeat { count, steps } => {
                let head = match count {
                    Some(count) => concat([word("repeat "), self.expr(count), word(" times")]),
                    None => word("repeat"),
                };
                self.repeat(head, steps)
            }
            StepKind::Parallel(strands) => self.parallel(strands),
            StepKind::Broken(_) => nothing(),
        }
    }

    /// Prints `repeat` with its body, on one line if it is short enough.
    fn repeat(&mut self, head: Doc, steps: &[Step]) -> Doc {
        let simple = |step: &Step| matches!(step.kind, StepKind::Run(_)) && step.doc.is_none();
        if steps.len() > 2 || !steps.iter().all(simple) {
            let steps = self.steps(steps);
            return concat([head, Doc::Hard, block("let", steps, "tel")]);
        }
        let steps = steps
            .iter()
            .flat_map(|step| [Doc::Line, self.step(&step.kind, Columns::default())]);
        let body = one_line_body(concat(steps.collect::<Vec<_>>()));
        group(concat([head, Doc::Line, body]))
    }

    /// Prints `parallel` with one block below the other.
    fn parallel(&mut self, strands: &[Strand]) -> Doc {
        let mut parts = vec![word("parallel")];
        for strand in strands {
            let steps = self.steps(&strand.steps);
            parts.extend([Doc::Hard, block("let", steps, "tel")]);
        }
        concat(parts)
    }

    fn run(&mut self, run: &Run, columns: Columns) -> Doc {
        let label = self.label(run, columns);
        let call = self.run_call(run);
        if run.branches.is_empty() {
            return concat([label, call, word(";")]);
        }
        let width = call.flat_width().unwrap_or(columns.call);
        let gap = " ".repeat(columns.call.saturating_sub(width) + 1);
        let branches = self.branches(&run.branches);
        group(concat([
            label,
            call,
            text(gap),
            indent(concat([Doc::Line, branches])),
            word(";"),
        ]))
    }

    fn label(&self, run: &Run, columns: Columns) -> Doc {
        match &run.label {
            Some(label) => text(format!("{:1$}", format!("{}: ", label.name), columns.label)),
            None => nothing(),
        }
    }

    fn run_call(&mut self, run: &Run) -> Doc {
        concat([self.callee(&run.callee), self.args(&run.args)])
    }

    fn branches(&mut self, branches: &[Branch]) -> Doc {
        let branches = self.phrase_parts(branches, |_, i, branch| {
            let bar = if i == 0 { "" } else { "| " };
            let on: Vec<&str> = branch.on.iter().map(on_result).collect();
            let (on, then) = (on.join(", "), next(&branch.then));
            text(format!("{bar}on {on} then {then}"))
        });
        concat(branches)
    }

    /// Returns the columns of each step. Adjacent steps with labels share their columns.
    fn columns(&self, steps: &[Step]) -> Vec<Columns> {
        let labelled =
            |step: &Step| matches!(&step.kind, StepKind::Run(run) if run.label.is_some());
        let runs = steps.chunk_by(|a, b| labelled(a) && labelled(b));
        let columns = runs.flat_map(|run| std::iter::repeat_n(self.shared_columns(run), run.len()));
        columns.collect()
    }

    fn shared_columns(&self, steps: &[Step]) -> Columns {
        let runs = || {
            steps.iter().filter_map(|step| match &step.kind {
                StepKind::Run(run) => Some(run),
                _ => None,
            })
        };
        let labels = runs().filter_map(|run| run.label.as_ref());
        let label = labels.map(|label| label.name.chars().count() + 2).max();
        let label = label.unwrap_or(0);
        let calls = runs().filter_map(|run| self.width_in_column(run, label));
        Columns {
            label,
            call: calls.max().unwrap_or(0),
        }
    }

    /// Returns the width of a call, if its branches fit on the same line.
    fn width_in_column(&self, run: &Run, label: usize) -> Option<usize> {
        if run.branches.is_empty() {
            return None;
        }
        let mut plain = Printer {
            mode: self.mode,
            source: None,
        };
        let call = plain.run_call(run).flat_width()?;
        let branches = group(plain.branches(&run.branches)).flat_width()?;
        (label + call + branches <= ROOM).then_some(call)
    }
}

/// Maximum width of a step on one line. The rest of the line is left for indentation.
const ROOM: usize = super::layout::WIDTH - 10;

fn on_result(result: &OnResult) -> &str {
    match result {
        OnResult::Named(name) => &name.name,
        OnResult::Fail(_) => "fail",
        OnResult::Any(_) => "any",
    }
}

fn next(next: &Next) -> &str {
    match next {
        Next::Step(label) => &label.name,
        Next::End(_) => "end",
    }
}
