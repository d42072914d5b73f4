//! Every result that a branch names is one of the command's, and every result leads somewhere.

use crate::check::body::Body;
use crate::check::names::ends_of;
use crate::check::report::{listed, no_member};
use rpi_diag::{Code, Finding, Fix};
use rpi_syntax::Name;
use rpi_syntax::ast::{self, CommandDecl, EndKind, Ident, OnResult, Run};

impl Body<'_, '_> {
    /// A task ends without naming how.
    pub(super) fn no_results(&mut self, run: &Run) {
        let of = format!("the task `{}`", run.callee.name.name);
        for result in run.branches.iter().flat_map(|branch| &branch.on) {
            if let OnResult::Named(name) = result {
                let finding = no_member(&of, &name.name, name.span, None)
                    .help("a task has no results of its own: branch `on fail` or `on any`");
                self.report(finding);
            }
        }
    }

    /// Every result that is named is one of the command's, and every result leads somewhere.
    pub(super) fn branches(&mut self, command: &CommandDecl, run: &Run) {
        let ends = ends_of(command);
        let mut named: Vec<&Ident> = Vec::new();
        let mut any = run.branches.is_empty();
        for on in run.branches.iter().flat_map(|branch| &branch.on) {
            match on {
                OnResult::Any(_) => any = true,
                OnResult::Fail(_) => {}
                OnResult::Named(result) => {
                    self.branch(command, result, &named);
                    named.push(result);
                }
            }
        }
        let led = |name: &Name| named.iter().any(|result| result.name == *name);
        let lost = ends.iter().filter(|end| end.kind != EndKind::Fail);
        let lost: Vec<&ast::End> = lost.copied().filter(|end| !led(&end.result.name)).collect();
        // A name that is none of its results stands for one of these.
        let slip = |result: &&Ident| ends.iter().all(|end| end.result.name != result.name);
        if !any && !lost.is_empty() && !named.iter().copied().any(|result| slip(&result)) {
            self.report(incomplete(run, &lost));
        }
    }

    fn branch(&mut self, command: &CommandDecl, result: &Ident, named: &[&Ident]) {
        let ends = ends_of(command);
        if let Some(first) = named.iter().find(|known| known.name == result.name) {
            let message = format!("two branches for the result `{}`", result.name);
            let finding = Finding::new(Code::RPI8003, message)
                .at(result.span, "this one is never taken")
                .also(first.span, "the first one")
                .help("name each result once");
            self.report(finding);
        }
        if ends.iter().all(|end| end.result.name != result.name) {
            let names = || ends.iter().map(|end| end.result.name.as_str());
            let near = self.c.suggest(&result.name, names());
            let of = format!("the command `{}`", command.name.name);
            let finding = no_member(&of, &result.name, result.span, near)
                .help(format!("it ends by {}", listed(names())));
            self.report(finding);
        }
    }
}

/// Some results lead nowhere.
fn incomplete(run: &Run, lost: &[&ast::End]) -> Finding {
    let callee = &run.callee.name;
    let names = listed(lost.iter().map(|end| end.result.name.as_str()));
    let mut finding = Finding::new(
        Code::RPI8002,
        format!("nothing follows {names} of `{}`", callee.name),
    )
    .at(callee.span, "these branches do not name all of its results");
    for end in lost {
        finding = finding.also(end.result.span, "it may end by this");
    }
    let all: Vec<&str> = lost.iter().map(|end| end.result.name.as_str()).collect();
    let finding =
        finding.help("add a branch: `| on r then step`, or `| on any then end` for all others");
    match run.branches.last() {
        Some(last) => finding.fix(
            Fix::maybe("end the task then")
                .insert_after(last.span, format!(" | on {} then end", all.join(", "))),
        ),
        None => finding,
    }
}
