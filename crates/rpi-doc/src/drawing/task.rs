//! Conversion of a task to a scene: steps become boxes, and the successor of each result a line.

use rpi_sema::query::DefId;
use rpi_syntax::ast::{Branch, NextStep, ResultPattern, Run, Step, StepKind, TaskDecl};

use super::body_scene::truncated;
use super::scene::{Drawing, End, Link, Role, SceneId, Shape, ShapeId};
use crate::declaration::PageContext;
use crate::members::one_line;

/// Returns the drawing of a task: a box for each step, and a line for each result to the step that follows it.
pub(super) fn drawing(shown: &PageContext<'_>, _id: DefId, task: &TaskDecl) -> Drawing {
    let mut drawing = Drawing::default();
    let root = drawing.scene(None);
    steps(shown, &mut drawing, root, &task.steps);
    drawing
}

/// Step of a task with its box in the drawing.
struct StepBox<'s> {
    run: Option<&'s Run>,
    shape: ShapeId,
}

fn steps(shown: &PageContext<'_>, drawing: &mut Drawing, scene: SceneId, steps: &[Step]) {
    let begin = drawing.shape(scene, Shape::new(Role::Dot, "start")).1;
    let placed: Vec<StepBox<'_>> = steps
        .iter()
        .filter_map(|step| add_step_box(shown, drawing, scene, step))
        .collect();
    let end = drawing.shape(scene, Shape::new(Role::Dot, "end")).1;
    let labelled = |name: &str| {
        let is_meant = |p: &&StepBox<'_>| p.run.is_some_and(|run| label(run) == Some(name));
        placed.iter().find(is_meant).map(|p| p.shape)
    };
    let start = steps.iter().find_map(|step| match &step.kind {
        StepKind::Start(name) => labelled(&name.name),
        _ => None,
    });
    let first = start.or(placed.first().map(|p| p.shape)).unwrap_or(end);
    drawing.link(scene, line(begin, first, String::new()));
    for (k, one) in placed.iter().enumerate() {
        let next = placed.get(k + 1).map_or(end, |p| p.shape);
        let branches = one.run.map_or(&[][..], |run| &run.branches[..]);
        if branches.is_empty() {
            drawing.link(scene, line(one.shape, next, String::new()));
        }
        for branch in branches {
            let to = match &branch.next {
                NextStep::Step(name) => labelled(&name.name).unwrap_or(end),
                NextStep::End(_) => end,
            };
            drawing.link(scene, line(one.shape, to, results(branch)));
        }
    }
}

fn add_step_box<'s>(
    shown: &PageContext<'_>,
    drawing: &mut Drawing,
    scene: SceneId,
    step: &'s Step,
) -> Option<StepBox<'s>> {
    match &step.kind {
        StepKind::Run(run) => Some(StepBox {
            run: Some(run),
            shape: drawing.shape(scene, run_box(shown, run, step)).1,
        }),
        StepKind::Repeat {
            count,
            steps: inner,
        } => {
            let text = |span| one_line(shown.inspected.sources.slice(span));
            let times = count
                .as_ref()
                .map(|count| format!(" {} times", text(count.span)));
            let title = format!("repeat{}", times.unwrap_or_default());
            let place = drawing.shape(scene, Shape::new(Role::Fragment, title));
            let inside = drawing.scene(Some(place));
            steps(shown, drawing, inside, inner);
            Some(StepBox {
                run: None,
                shape: place.1,
            })
        }
        StepKind::Parallel(strands) => {
            let place = drawing.shape(scene, Shape::new(Role::Fragment, "parallel"));
            let inside = drawing.scene(Some(place));
            for (k, strand) in strands.iter().enumerate() {
                let title = format!("branch {}", k + 1);
                let own = drawing.shape(inside, Shape::new(Role::Fragment, title));
                let inner = drawing.scene(Some(own));
                steps(shown, drawing, inner, &strand.steps);
            }
            Some(StepBox {
                run: None,
                shape: place.1,
            })
        }
        StepKind::Start(_) | StepKind::Error(_) => None,
    }
}

fn run_box(shown: &PageContext<'_>, run: &Run, step: &Step) -> Shape {
    let seen = shown.inspected;
    let text = one_line(seen.sources.slice(step.span));
    let call = text
        .split(" on ")
        .next()
        .unwrap_or_default()
        .trim_end_matches(';');
    let called = seen.index().references_in(run.callee.name.span).first();
    let (title, detail) = match label(run) {
        Some(label) => (
            label.to_owned(),
            call.split_once(':').map_or(call, |(_, c)| c).trim(),
        ),
        None => (call.to_owned(), ""),
    };
    Shape {
        detail: truncated(detail),
        tooltip: text.clone(),
        href: called.and_then(|called| shown.links.href_of_top(seen, called.def)),
        ..Shape::new(Role::Step, truncated(&title))
    }
}

fn label(run: &Run) -> Option<&str> {
    run.label.as_ref().map(|label| label.name.as_str())
}

fn results(branch: &Branch) -> String {
    let names = branch.results.iter().map(|on| match on {
        ResultPattern::Named(name) => name.name.as_str(),
        ResultPattern::Fail(_) => "fail",
        ResultPattern::Any(_) => "any",
    });
    names.collect::<Vec<_>>().join(", ")
}

fn line(from: ShapeId, to: ShapeId, label: String) -> Link {
    let end = |shape| End { shape, port: None };
    Link {
        from: end(from),
        to: end(to),
        delayed: false,
        optional: false,
        label,
    }
}
