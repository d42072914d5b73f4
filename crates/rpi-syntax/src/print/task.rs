//! Printing of tasks, with their steps in columns.

use super::Printer;
use super::body::{block, one_line_body};
use super::call;
use super::decl;
use super::expr;
use super::layout::{Doc, concat, empty, group, indent, text, word};
use super::list;
use super::ty;
use crate::ast::*;

/// Widths of the columns in which labels, calls and branches of adjacent steps of a task are aligned.
#[derive(Clone, Copy, Default)]
struct Columns {
    /// Width in characters of the widest label, with `:` and a space. The calls of all steps begin after it.
    label: usize,
    /// Width in characters of the widest call, after which the branches begin; 0 if they are not aligned.
    call: usize,
}

pub(super) fn print_task(printer: &Printer<'_>, task: &TaskDecl) -> Doc {
    let name = ty::print_name(printer, &task.name);
    let statics = ty::static_params(printer, &task.statics);
    let params = decl::print_params(printer, &task.params);
    let head = group(concat([word("task "), name, statics, indent(params)]));
    let steps = print_steps(printer, &task.steps);
    concat([head, Doc::HardLine, block("let", steps, "tel")])
}

fn print_steps(printer: &Printer<'_>, steps: &[Step]) -> Doc {
    let columns = print_columns(printer, steps);
    list::print_lines(
        printer,
        steps,
        |step| step.span,
        |p, i, step| {
            let doc = list::doc_lines(p, step.doc.as_ref());
            (concat([doc, print_step(p, &step.kind, columns[i])]), false)
        },
    )
}

fn print_step(printer: &Printer<'_>, kind: &StepKind, columns: Columns) -> Doc {
    match kind {
        StepKind::Run(run) => print_run(printer, run, columns),
        StepKind::Start(label) => text(format!("start {};", label.name)),
        StepKind::Repeat { count, steps } => {
            let head = match count {
                Some(count) => concat([
                    word("repeat "),
                    expr::print_expr(printer, count),
                    word(" times"),
                ]),
                None => word("repeat"),
            };
            repeat(printer, head, steps)
        }
        StepKind::Parallel(strands) => parallel(printer, strands),
        StepKind::Error(_) => empty(),
    }
}

/// Prints a repetition, whose header is `head`, with its steps on one line if they are few and simple.
fn repeat(printer: &Printer<'_>, head: Doc, steps: &[Step]) -> Doc {
    let simple = |step: &Step| matches!(step.kind, StepKind::Run(_)) && step.doc.is_none();
    if steps.len() > 2 || !steps.iter().all(simple) {
        let steps = print_steps(printer, steps);
        return concat([head, Doc::HardLine, block("let", steps, "tel")]);
    }
    let steps = steps.iter().flat_map(|step| {
        [
            Doc::Line,
            print_step(printer, &step.kind, Columns::default()),
        ]
    });
    let body = one_line_body(concat(steps.collect::<Vec<_>>()));
    group(concat([head, Doc::Line, body]))
}

/// Prints `parallel` with the bodies of its branches one below the other.
fn parallel(printer: &Printer<'_>, strands: &[ParallelBranch]) -> Doc {
    let mut parts = vec![word("parallel")];
    for strand in strands {
        let steps = print_steps(printer, &strand.steps);
        parts.extend([Doc::HardLine, block("let", steps, "tel")]);
    }
    concat(parts)
}

fn print_run(printer: &Printer<'_>, run: &Run, columns: Columns) -> Doc {
    let label = print_label(run, columns);
    let call = run_call(printer, run);
    if run.branches.is_empty() {
        return concat([label, call, word(";")]);
    }
    let width = call.flat_width().unwrap_or(columns.call);
    let gap = " ".repeat(columns.call.saturating_sub(width) + 1);
    let branches = print_branches(printer, &run.branches);
    group(concat([
        label,
        call,
        text(gap),
        indent(concat([Doc::Line, branches])),
        word(";"),
    ]))
}

fn print_label(run: &Run, columns: Columns) -> Doc {
    match &run.label {
        Some(label) => text(format!("{:1$}", format!("{}: ", label.name), columns.label)),
        None => empty(),
    }
}

fn run_call(printer: &Printer<'_>, run: &Run) -> Doc {
    concat([
        call::print_callee(printer, &run.callee),
        call::print_args(printer, &run.args),
    ])
}

fn print_branches(printer: &Printer<'_>, branches: &[Branch]) -> Doc {
    let branches = list::print_phrase_parts(printer, branches, |_, i, branch| {
        let bar = if i == 0 { "" } else { "| " };
        let on: Vec<&str> = branch.results.iter().map(on_result).collect();
        let (on, then) = (on.join(", "), next(&branch.next));
        text(format!("{bar}on {on} then {then}"))
    });
    concat(branches)
}

/// Returns the columns of each step. Adjacent steps with labels have the same columns.
fn print_columns(printer: &Printer<'_>, steps: &[Step]) -> Vec<Columns> {
    let labelled = |step: &Step| matches!(&step.kind, StepKind::Run(run) if run.label.is_some());
    let runs = steps.chunk_by(|a, b| labelled(a) && labelled(b));
    let columns = runs.flat_map(|run| std::iter::repeat_n(shared_columns(printer, run), run.len()));
    columns.collect()
}

fn shared_columns(printer: &Printer<'_>, steps: &[Step]) -> Columns {
    let runs = || {
        steps.iter().filter_map(|step| match &step.kind {
            StepKind::Run(run) => Some(run),
            _ => None,
        })
    };
    let labels = runs().filter_map(|run| run.label.as_ref());
    let label = labels.map(|label| label.name.chars().count() + 2).max();
    let label = label.unwrap_or(0);
    let calls = runs().filter_map(|run| width_in_column(printer, run, label));
    Columns {
        label,
        call: calls.max().unwrap_or(0),
    }
}

/// Returns the width in characters of a call if the step with its label (`label` characters) and branches fits on one
/// line; `None` otherwise.
fn width_in_column(printer: &Printer<'_>, run: &Run, label: usize) -> Option<usize> {
    if run.branches.is_empty() {
        return None;
    }
    let plain = Printer {
        mode: printer.mode,
        source: None,
    };
    let call = run_call(&plain, run).flat_width()?;
    let branches = group(print_branches(&plain, &run.branches)).flat_width()?;
    (label + call + branches <= MAX_STEP_WIDTH).then_some(call)
}

/// Maximum width in characters of a step on one line. The rest of the line is left for indentation.
const MAX_STEP_WIDTH: usize = super::layout::MAX_WIDTH - 10;

fn on_result(result: &ResultPattern) -> &str {
    match result {
        ResultPattern::Named(name) => &name.name,
        ResultPattern::Fail(_) => "fail",
        ResultPattern::Any(_) => "any",
    }
}

fn next(next: &NextStep) -> &str {
    match next {
        NextStep::Step(label) => &label.name,
        NextStep::End(_) => "end",
    }
}
