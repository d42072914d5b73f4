//! Results of commands: every result that a branch names must exist, and every result must lead somewhere.

use crate::check::bodies::body::Body;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::listed;
use crate::check::diagnostics::report::no_member;
use crate::check::exprs::names::ends_of;
use rpi_diag::{Code, Finding, Fix};
use rpi_syntax::Name;
use rpi_syntax::ast::{self, CommandDecl, EndKind, Ident, OnResult, Run};

/// Reports branches that name a result of a task, which has no named results.
pub(super) fn report_task_results(cx: &mut Body<'_, '_>, run: &Run) {
    let of = format!("the task `{}`", run.callee.name.name);
    for result in run.branches.iter().flat_map(|branch| &branch.on) {
        if let OnResult::Named(name) = result {
            let finding = no_member(&of, &name.name, name.span, None)
                .help("a task has no named results: branch `on fail` or `on any`");
            report::report_diagnostic(cx, finding);
        }
    }
}

/// Checks that the branches of a step name results of the command, and that every result leads somewhere.
pub(super) fn check_branches(cx: &mut Body<'_, '_>, command: &CommandDecl, run: &Run) {
    let ends = ends_of(command);
    let mut named: Vec<&Ident> = Vec::new();
    let mut any = run.branches.is_empty();
    for on in run.branches.iter().flat_map(|branch| &branch.on) {
        match on {
            OnResult::Any(_) => any = true,
            OnResult::Fail(_) => {}
            OnResult::Named(result) => {
                check_branch(cx, command, result, &named);
                named.push(result);
            }
        }
    }
    let led = |name: &Name| named.iter().any(|result| result.name == *name);
    let lost = ends.iter().filter(|end| end.kind != EndKind::Fail);
    let lost: Vec<&ast::End> = lost.copied().filter(|end| !led(&end.result.name)).collect();
    // An undefined result name was probably meant as one of the missing results.
    let slip = |result: &&Ident| ends.iter().all(|end| end.result.name != result.name);
    if !any && !lost.is_empty() && !named.iter().copied().any(|result| slip(&result)) {
        report::report_diagnostic(cx, incomplete(run, &lost));
    }
}

fn check_branch(cx: &mut Body<'_, '_>, command: &CommandDecl, result: &Ident, named: &[&Ident]) {
    let ends = ends_of(command);
    if let Some(first) = named.iter().find(|known| known.name == result.name) {
        let message = format!("two branches for the result `{}`", result.name);
        let finding = Finding::new(Code::RPI8003, message)
            .at(result.span, "this one is never taken")
            .also(first.span, "the first one")
            .help("name each result once");
        report::report_diagnostic(cx, finding);
    }
    if ends.iter().all(|end| end.result.name != result.name) {
        let names = || ends.iter().map(|end| end.result.name.as_str());
        let near = cx.checker.suggest(&result.name, names());
        let of = format!("the command `{}`", command.name.name);
        let finding = no_member(&of, &result.name, result.span, near)
            .help(format!("its results are {}", listed(names())));
        report::report_diagnostic(cx, finding);
    }
}

/// Returns the diagnostic for results without a branch.
fn incomplete(run: &Run, lost: &[&ast::End]) -> Finding {
    let callee = &run.callee.name;
    let names = listed(lost.iter().map(|end| end.result.name.as_str()));
    let mut finding = Finding::new(
        Code::RPI8002,
        format!("no branch for {names} of `{}`", callee.name),
    )
    .at(callee.span, "the branches do not cover all of its results");
    for end in lost {
        finding = finding.also(end.result.span, "possible result");
    }
    let all: Vec<&str> = lost.iter().map(|end| end.result.name.as_str()).collect();
    let finding =
        finding.help("add a branch: `| on r then step`, or `| on any then end` for all others");
    match run.branches.last() {
        Some(last) => finding.fix(
            Fix::maybe("end the task in these cases")
                .insert_after(last.span, format!(" | on {} then end", all.join(", "))),
        ),
        None => finding,
    }
}
