//! Add missing cases: of a `merge` over an enum, and of the results of a step.

use lsp_types::CodeActionKind;
use rpi_diag::{FileId, Span};
use rpi_sema::query::DefKind;
use rpi_syntax::ast::{
    ExprKind, ItemKind, Merge, ResultPattern, Run, Step, StepKind, TypeKind, Visitor, Walker,
};

use super::code_context::CodeContext;
use super::{Refactoring, insertion};

/// Returns the refactorings that add the missing cases to the `merge` or the step at the selection.
pub(super) fn add_cases(context: &CodeContext<'_>) -> Vec<Refactoring> {
    let merge = innermost_merge(context).and_then(|merge| merge_cases(context, merge));
    let step = step_at(context).and_then(|(span, run)| result_branches(context, span, run));
    merge.into_iter().chain(step).collect()
}

fn innermost_merge<'s>(context: &CodeContext<'s>) -> Option<&'s Merge> {
    let around = context.expressions.iter();
    let merges = around.filter_map(|expr| match &expr.kind {
        ExprKind::Merge(merge) if expr.span.contains(context.selection) => {
            Some((expr.span, &**merge))
        }
        _ => None,
    });
    let innermost = merges.min_by_key(|(span, _)| span.end - span.start);
    innermost.map(|(_, merge)| merge)
}

/// Adds a case for each value of the enum without one, with the expression of the last case.
fn merge_cases(context: &CodeContext<'_>, merge: &Merge) -> Option<Refactoring> {
    let last = merge.cases.last()?;
    let missing: Vec<String> = enum_values(context, last.value.span)?
        .into_iter()
        .filter(|name| merge.cases.iter().all(|case| *case.value.name != **name))
        .collect();
    (!missing.is_empty()).then_some(())?;
    let value = context.slice(last.then.span);
    let old = &*last.value.name;
    let case = |name: &String| format!(" ({name} -> {})", value.replace(old, name));
    let cases: String = missing.iter().map(case).collect();
    let rest = &context.text[last.then.span.end as usize..];
    let close = u32::try_from(rest.find(')')?).ok()?;
    let at = last.then.span.end + close + 1;
    Some(Refactoring::new(
        "add the missing cases",
        CodeActionKind::REFACTOR_REWRITE,
        vec![insertion(at, cases)],
    ))
}

/// Returns the names of the values of the enum that declares the value at a place.
fn enum_values(context: &CodeContext<'_>, value: Span) -> Option<Vec<String>> {
    let index = context.seen.index();
    let def = index.def(index.reference_at(FileId(0), value.start)?.def);
    (def.kind == DefKind::EnumValue).then_some(())?;
    let types = context.seen.items().filter_map(|item| match &item.kind {
        ItemKind::Type(defs) => Some(defs),
        _ => None,
    });
    let mut enums = types
        .flatten()
        .filter_map(|one| match &one.ty.as_ref()?.kind {
            TypeKind::Enum(values) => Some(values),
            _ => None,
        });
    let values = enums.find(|values| values.iter().any(|one| one.name.span == def.span))?;
    Some(values.iter().map(|one| one.name.name.to_string()).collect())
}

fn step_at<'s>(context: &CodeContext<'s>) -> Option<(Span, &'s Run)> {
    let mut runs = Runs(Vec::new());
    Walker::new(&mut runs).item(context.item?);
    let mut around = runs.0.into_iter();
    around.rfind(|(span, _)| span.contains(context.selection))
}

struct Runs<'s>(Vec<(Span, &'s Run)>);

impl<'s> Visitor<'s> for Runs<'s> {
    fn visits_expressions(&self) -> bool {
        false
    }

    fn visit_step(&mut self, step: &'s Step) {
        if let StepKind::Run(run) = &step.kind {
            self.0.push((step.span, run));
        }
    }
}

/// Adds a branch that ends the task for each result of the command without a branch.
fn result_branches(context: &CodeContext<'_>, step: Span, run: &Run) -> Option<Refactoring> {
    let index = context.seen.index();
    let command = index
        .reference_at(FileId(0), run.callee.name.span.start)?
        .def;
    (index.def(command).kind == DefKind::Command).then_some(())?;
    let patterns = || run.branches.iter().flat_map(|branch| &branch.results);
    let covers_all = patterns().any(|one| matches!(one, ResultPattern::Any(_)));
    let is_covered = |name: &str| {
        patterns().any(|one| matches!(one, ResultPattern::Named(known) if *known.name == *name))
    };
    let mut missing: Vec<String> = Vec::new();
    for id in index.members(command) {
        let name = index.def(id).name.to_string();
        if !is_covered(&name) && !missing.contains(&name) {
            missing.push(name);
        }
    }
    (!covers_all && !missing.is_empty()).then_some(())?;
    let apart = if run.branches.is_empty() { " " } else { " | " };
    let branches: Vec<String> = missing
        .iter()
        .map(|name| format!("on {name} then end"))
        .collect();
    let text = context.slice(step);
    let end = step.start + u32::try_from(text.trim_end_matches(';').trim_end().len()).ok()?;
    Some(Refactoring::new(
        "add branches for the other results",
        CodeActionKind::REFACTOR_REWRITE,
        vec![insertion(end, format!("{apart}{}", branches.join(" | ")))],
    ))
}
