//! Tasks (M11): every step that is named is there, every result of a command leads somewhere, and a successor takes over
//! what its predecessor may leave moving.

use super::Checker;
use super::names::ends_of;
use super::report::{listed, no_member, not_a, unknown};
use super::statement::counted;
use crate::program::{DeclId, DeclKind, Lookup, ModuleId, twice};
use rpi_diag::{Code, Finding, Fix};
use rpi_syntax::Name;
use rpi_syntax::ast::{
    self, Arg, Branch, CommandDecl, EndKind, Ident, Next, OnResult, Run, Statement, StatementKind,
    Step, StepKind, TaskDecl, VarDecl,
};

/// Steps that can be reached by name, the innermost list last.
type Labels<'a> = Vec<(&'a Ident, &'a Run)>;

impl<'a> Checker<'a> {
    /// Checks a task.
    pub(super) fn task(&mut self, id: DeclId, task: &'a TaskDecl) {
        let module = self.program.decl(id).module;
        let mut labels = Labels::new();
        self.steps(module, &task.steps, None, &mut labels);
    }

    /// Checks a list of steps, which is followed by another run of itself if it is repeated.
    fn steps(
        &mut self,
        module: ModuleId,
        steps: &'a [Step],
        again: Option<&'a Run>,
        labels: &mut Labels<'a>,
    ) {
        let outer = labels.len();
        for run in steps.iter().filter_map(run_of) {
            let Some(label) = &run.label else { continue };
            let same = labels[outer..]
                .iter()
                .find(|(known, _)| known.name == label.name);
            if let Some((first, _)) = same {
                let finding = twice(&label.name, label.span, first.span);
                self.findings.push(finding);
            }
            labels.push((label, run));
        }
        for (k, step) in steps.iter().enumerate() {
            let next = steps.get(k + 1).map_or(again, run_of);
            match &step.kind {
                StepKind::Run(run) => self.run(module, run, next, labels),
                StepKind::Repeat { steps, .. } => {
                    let first = steps.first().and_then(run_of);
                    self.steps(module, steps, first, labels);
                }
                StepKind::Start(label) => {
                    self.label(label, labels);
                }
                StepKind::Broken(_) => {}
            }
        }
        labels.truncate(outer);
    }

    /// The step of a name; reports that there is none.
    fn label(&mut self, label: &Ident, labels: &Labels<'a>) -> Option<&'a Run> {
        let found = labels
            .iter()
            .rev()
            .find(|(known, _)| known.name == label.name);
        if found.is_none() {
            let names = labels.iter().map(|(known, _)| known.name.as_str());
            let near = self.suggest(&label.name, names);
            self.findings
                .push(unknown("step", &label.name, label.span, near));
        }
        found.map(|(_, run)| *run)
    }

    fn run(&mut self, module: ModuleId, run: &'a Run, next: Option<&'a Run>, labels: &Labels<'a>) {
        match self.callee(module, run) {
            Some(DeclKind::Command(command)) => {
                self.arguments(run, &command.params);
                self.branches(command, run);
                self.successors(module, command, run, next, labels);
            }
            Some(DeclKind::Task(task)) => {
                self.arguments(run, &task.params);
                self.no_results(run);
            }
            _ => {}
        }
        for branch in &run.branches {
            if let Next::Step(label) = &branch.then {
                self.label(label, labels);
            }
        }
    }

    /// The command or task that a step runs; reports anything else.
    fn callee(&mut self, module: ModuleId, run: &'a Run) -> Option<DeclKind<'a>> {
        let name = &run.callee.name;
        let Lookup::Found(id) = self.program.lookup(module, &name.name) else {
            let runs = |id: DeclId| is_run(self.program.decl(id).kind);
            let near = self.suggest(&name.name, self.program.visible(module, runs));
            let finding = unknown("command or task", &name.name, name.span, near);
            self.findings.push(finding);
            return None;
        };
        let decl = self.program.decl(id);
        let (kind, span) = (decl.kind, decl.span);
        if !is_run(kind) && !matches!(kind, DeclKind::Broken(_)) {
            let finding = not_a(
                "a command or task",
                &name.name,
                kind.what(),
                name.span,
                span,
            );
            self.findings.push(finding);
            return None;
        }
        Some(kind)
    }

    fn arguments(&mut self, run: &Run, params: &[VarDecl]) {
        let needed = params.iter().filter(|param| param.default.is_none());
        let least: usize = needed.map(|param| param.names.len()).sum();
        let names: Vec<&Ident> = params.iter().flat_map(|param| &param.names).collect();
        let (given, most) = (run.args.len(), names.len());
        let callee = &run.callee.name;
        let mut known = true;
        for name in run.args.iter().filter_map(|arg| arg.name.as_ref()) {
            if names.iter().all(|known| known.name != name.name) {
                known = false;
                let near = self.suggest(&name.name, names.iter().map(|n| n.name.as_str()));
                let of = format!("`{}`", callee.name);
                let finding = no_member(&of, &name.name, name.span, near);
                self.findings.push(finding);
            }
        }
        if known && (given < least || given > most) {
            let what = counted(most, "parameter");
            let finding = Finding::new(
                Code::RPI1010,
                format!("`{}` has {what}, {given} given", callee.name),
            )
            .at(callee.span, "not so many as it has");
            self.findings.push(finding);
        }
    }

    /// A task ends without naming how.
    fn no_results(&mut self, run: &Run) {
        let of = format!("the task `{}`", run.callee.name.name);
        for result in run.branches.iter().flat_map(|branch| &branch.on) {
            if let OnResult::Named(name) = result {
                let finding = no_member(&of, &name.name, name.span, None)
                    .help("a task has no results of its own: branch `on fail` or `on any`");
                self.findings.push(finding);
            }
        }
    }

    /// Every result that is named is one of the command's, and every result leads somewhere.
    fn branches(&mut self, command: &CommandDecl, run: &Run) {
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
            self.findings.push(incomplete(run, &lost));
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
            self.findings.push(finding);
        }
        if ends.iter().all(|end| end.result.name != result.name) {
            let names = || ends.iter().map(|end| end.result.name.as_str());
            let near = self.suggest(&result.name, names());
            let of = format!("the command `{}`", command.name.name);
            let finding = no_member(&of, &result.name, result.span, near)
                .help(format!("it ends by {}", listed(names())));
            self.findings.push(finding);
        }
    }

    /// Whoever follows a `yield` takes over every device that may be moving then.
    fn successors(
        &mut self,
        module: ModuleId,
        command: &CommandDecl,
        run: &'a Run,
        next: Option<&'a Run>,
        labels: &Labels<'a>,
    ) {
        let moving = given_to(&driven(command), command, run);
        let yields = ends_of(command).into_iter();
        for end in yields.filter(|end| end.kind == EndKind::Yield) {
            let Some(follows) = target(run, &end.result.name, next, labels) else {
                continue;
            };
            let Lookup::Found(id) = self.program.lookup(module, &follows.callee.name.name) else {
                continue;
            };
            let DeclKind::Command(successor) = self.program.decl(id).kind else {
                continue;
            };
            let taken = given_to(&driven(successor), successor, follows);
            let left: Vec<&str> = moving
                .iter()
                .copied()
                .filter(|d| !taken.contains(d))
                .collect();
            if !left.is_empty() {
                self.findings
                    .push(not_taken_over(command, end, follows, &left));
            }
        }
    }
}

fn run_of(step: &Step) -> Option<&Run> {
    match &step.kind {
        StepKind::Run(run) => Some(run),
        _ => None,
    }
}

fn is_run(kind: DeclKind<'_>) -> bool {
    matches!(kind, DeclKind::Command(_) | DeclKind::Task(_))
}

/// The step that follows a result.
fn target<'a>(
    run: &'a Run,
    result: &Name,
    next: Option<&'a Run>,
    labels: &Labels<'a>,
) -> Option<&'a Run> {
    let named = |on: &OnResult| matches!(on, OnResult::Named(name) if name.name == *result);
    let any = |on: &OnResult| matches!(on, OnResult::Any(_));
    let branch = |is: &dyn Fn(&OnResult) -> bool| -> Option<&'a Branch> {
        run.branches.iter().find(|branch| branch.on.iter().any(is))
    };
    match branch(&named).or_else(|| branch(&any)) {
        Some(branch) => match &branch.then {
            Next::Step(label) => {
                let found = labels
                    .iter()
                    .rev()
                    .find(|(known, _)| known.name == label.name);
                found.map(|(_, run)| *run)
            }
            Next::End(_) => None,
        },
        None => next.filter(|_| run.branches.is_empty()),
    }
}

/// The parameters of a command by which it writes to devices.
fn driven(command: &CommandDecl) -> Vec<&Name> {
    let mut written = Vec::new();
    targets(&command.body.statements, &mut written);
    let params = command.params.iter().flat_map(|param| &param.names);
    params
        .map(|param| &param.name)
        .filter(|param| written.contains(param))
        .collect()
}

/// The names of what statements define a part of, also those in fragments and states.
fn targets<'s>(statements: &'s [Statement], written: &mut Vec<&'s Name>) {
    for statement in statements {
        match &statement.kind {
            StatementKind::Equation(equation) => {
                let parts = equation.targets.iter().filter(|t| !t.path.is_empty());
                written.extend(parts.map(|target| &target.name.name));
            }
            StatementKind::Fragment(fragment) => targets(&fragment.body.statements, written),
            StatementKind::Automaton(automaton) => {
                let states = automaton.states.iter();
                states.for_each(|state| targets(&state.body.statements, written));
            }
            _ => {}
        }
    }
}

/// What a step gives for these parameters, as far as it is given by name.
fn given_to<'r>(params: &[&Name], command: &CommandDecl, run: &'r Run) -> Vec<&'r str> {
    let names: Vec<&Name> = command
        .params
        .iter()
        .flat_map(|param| &param.names)
        .map(|name| &name.name)
        .collect();
    let of = |(k, arg): (usize, &'r Arg)| {
        let param = match &arg.name {
            Some(name) => Some(&name.name),
            None => names.get(k).copied(),
        };
        let value = super::names::plain_name(&arg.value)?;
        params.contains(&param?).then_some(value.as_str())
    };
    run.args.iter().enumerate().filter_map(of).collect()
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

fn not_taken_over(command: &CommandDecl, end: &ast::End, follows: &Run, left: &[&str]) -> Finding {
    let (successor, devices) = (&follows.callee.name, listed(left.iter().copied()));
    let message = format!(
        "`{}` does not take over {devices} from `{}`",
        successor.name, command.name.name
    );
    Finding::new(Code::RPI6201, message)
        .at(successor.span, format!("it does not drive {devices}"))
        .also(end.result.span, format!("here {devices} may still be moving"))
        .help("this `yield` is passed over and the command goes on until it is at rest; let the successor drive the device, or branch on another result")
}
