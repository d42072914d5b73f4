//! Results of commands: every result that a branch names must exist, and every result must lead somewhere.

use crate::check::bodies::body::Body;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::join_names;
use crate::check::diagnostics::report::no_member;
use crate::check::exprs::names::end_statements;
use rpi_diag::{Code, Diagnostic, Fix};
use rpi_syntax::Name;
use rpi_syntax::ast::{self, CommandDecl, CommandEndKind, Ident, ResultPattern, Run};

/// Reports the branches of a step that runs a task if they name a result, because a task has no named results.
pub(super) fn report_task_results(cx: &mut Body<'_, '_>, run: &Run) {
    let of = format!("the task `{}`", run.callee.name.name);
    for result in run.branches.iter().flat_map(|branch| &branch.results) {
        if let ResultPattern::Named(name) = result {
            let diagnostic = no_member(&of, &name.name, name.span, None)
                .help("a task has no named results: branch `on fail` or `on any`");
            report::report_diagnostic(cx, diagnostic);
        }
    }
}

/// Checks that the branches of a step name results of its command, and that there is a branch for each result.
pub(super) fn check_branches(cx: &mut Body<'_, '_>, command: &CommandDecl, run: &Run) {
    let ends = end_statements(command);
    let mut named: Vec<&Ident> = Vec::new();
    let mut any = run.branches.is_empty();
    for on in run.branches.iter().flat_map(|branch| &branch.results) {
        match on {
            ResultPattern::Any(_) => any = true,
            ResultPattern::Fail(_) => {}
            ResultPattern::Named(result) => {
                check_branch(cx, command, result, &named);
                named.push(result);
            }
        }
    }
    let led = |name: &Name| named.iter().any(|result| result.name == *name);
    let lost = ends.iter().filter(|end| end.kind != CommandEndKind::Fail);
    let lost: Vec<&ast::CommandEnd> = lost.copied().filter(|end| !led(&end.result.name)).collect();
    // An undefined result name was probably meant as one of the missing results.
    let slip = |result: &&Ident| ends.iter().all(|end| end.result.name != result.name);
    if !any && !lost.is_empty() && !named.iter().copied().any(|result| slip(&result)) {
        report::report_diagnostic(cx, unhandled_results(run, &lost));
    }
}

fn check_branch(cx: &mut Body<'_, '_>, command: &CommandDecl, result: &Ident, named: &[&Ident]) {
    let ends = end_statements(command);
    if let Some(first) = named.iter().find(|known| known.name == result.name) {
        let message = format!("two branches for the result `{}`", result.name);
        let diagnostic = Diagnostic::new(Code::RPI8003, message)
            .primary(result.span, "this one is never taken")
            .secondary(first.span, "the first one")
            .help("name each result once");
        report::report_diagnostic(cx, diagnostic);
    }
    if ends.iter().all(|end| end.result.name != result.name) {
        let names = || ends.iter().map(|end| end.result.name.as_str());
        let near = cx.checker.suggest(&result.name, names());
        let of = format!("the command `{}`", command.name.name);
        let diagnostic = no_member(&of, &result.name, result.span, near)
            .help(report::members_help("result", names()));
        report::report_diagnostic(cx, diagnostic);
    }
}

/// Returns the diagnostic for the results `lost` of a command, for which the step has no branch.
fn unhandled_results(run: &Run, lost: &[&ast::CommandEnd]) -> Diagnostic {
    let callee = &run.callee.name;
    let names = join_names(lost.iter().map(|end| end.result.name.as_str()));
    let mut diagnostic = Diagnostic::new(
        Code::RPI8002,
        format!("no branch for {names} of `{}`", callee.name),
    )
    .primary(callee.span, "the branches do not cover all of its results");
    for end in lost {
        diagnostic = diagnostic.secondary(end.result.span, "possible result");
    }
    let all: Vec<&str> = lost.iter().map(|end| end.result.name.as_str()).collect();
    let diagnostic = diagnostic.help(format!(
        "add a branch with the next step: `| on {} then ...`, or `| on any then end` to end the task",
        all.join(", ")
    ));
    match run.branches.last() {
        Some(last) => diagnostic.fix(
            Fix::maybe("end the task in these cases")
                .insert_after(last.span, format!(" | on {} then end", all.join(", "))),
        ),
        None => diagnostic,
    }
}
