//! Tasks as the host runs them: which command follows which result.
//!
//! A task becomes a plan of nodes that lead to one another. Tasks that it calls are put in its place. Commands and tasks are
//! called with names, of devices and constants; a command with other names than its parameters have is an [`Instance`], with a
//! net of its own. A task that does more is refused with the reason.

use std::collections::BTreeMap;

use rpi_syntax::Name;
use rpi_syntax::ast::{
    Arg, Branch, ExprKind, File, ItemKind, Next, OnResult, Run, Step, StepKind, TaskDecl, VarDecl,
};

/// A task.
#[derive(Clone, PartialEq, Debug)]
pub struct Task {
    /// Its name.
    pub name: String,
    /// What it does, or why it cannot be run.
    pub plan: Result<TaskPlan, String>,
}

/// Where a plan goes on; none: the task is done.
pub type Target = Option<usize>;

/// What a task does.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct TaskPlan {
    /// Its nodes; targets are indices.
    pub nodes: Vec<TaskNode>,
    /// The first one.
    pub start: Target,
}

/// A node of a plan.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum TaskNode {
    /// Goes on there.
    Pass(Target),
    /// A repetition begins: this node counts from 0 again, and it goes on there.
    Enter(usize),
    /// So many times the body, without a number for ever; then it goes on.
    Repeat {
        /// How many times.
        times: Option<u64>,
        /// What is repeated.
        body: Target,
        /// What comes then.
        then: Target,
    },
    /// A command.
    Run {
        /// Its name, with the arguments where these are not called as its parameters: `MoveTo(arm, home)`.
        command: String,
        /// What follows these results.
        on: Vec<(String, Target)>,
        /// What follows any other `fail`; none: the task ends with its error.
        on_fail: Option<Target>,
        /// What follows any other result; none if the branches must name them all.
        otherwise: Option<Target>,
    },
}

/// A command with arguments that are not called as its parameters.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) struct Instance {
    /// The command's name.
    pub(crate) command: String,
    /// What each of its parameters is: a device or a constant.
    pub(crate) args: Vec<Name>,
}

impl Instance {
    /// `MoveTo(arm, home)`: the name of its net.
    pub(crate) fn name(&self) -> String {
        let args: Vec<&str> = self.args.iter().map(Name::as_str).collect();
        format!("{}({})", self.command, args.join(", "))
    }
}

/// The tasks of a file, in the order of the text.
pub(crate) fn tasks(file: &File) -> Vec<Task> {
    declared(file)
        .map(|task| Task {
            name: task.name.name.to_string(),
            plan: plan(file, task).map(|built| built.0),
        })
        .collect()
}

/// The instances of commands that the tasks of a file need, each once.
pub(crate) fn instances(file: &File) -> Vec<Instance> {
    let plans = declared(file).filter_map(|task| plan(file, task).ok());
    let mut all: Vec<Instance> = plans.flat_map(|(_, instances)| instances).collect();
    all.sort();
    all.dedup();
    all
}

fn declared(file: &File) -> impl Iterator<Item = &TaskDecl> {
    file.items.iter().filter_map(|item| match &item.kind {
        ItemKind::Task(task) => Some(task.as_ref()),
        _ => None,
    })
}

fn plan(file: &File, task: &TaskDecl) -> Result<(TaskPlan, Vec<Instance>), String> {
    let mut builder = Builder {
        file,
        nodes: Vec::new(),
        instances: Vec::new(),
        within: Vec::new(),
        names: BTreeMap::new(),
    };
    let start = builder.task(task, None, None)?;
    let nodes = builder.nodes;
    Ok((TaskPlan { nodes, start }, builder.instances))
}

struct Builder<'f> {
    file: &'f File,
    nodes: Vec<TaskNode>,
    instances: Vec<Instance>,
    /// What the parameters of the task that is being put in place stand for; those of the outermost for themselves.
    names: BTreeMap<Name, Name>,
    /// The tasks that are being put in place, outermost first.
    within: Vec<String>,
}

/// Where the steps of a task lead when nothing else is said.
#[derive(Clone)]
struct Scope {
    /// Behind the task.
    exit: Target,
    /// After a `fail` that no branch names.
    fail: Option<Target>,
    /// The named steps.
    labels: Vec<(String, usize)>,
}

impl<'f> Builder<'f> {
    /// Puts a task in place; gives its first node.
    fn task(
        &mut self,
        task: &TaskDecl,
        exit: Target,
        fail: Option<Target>,
    ) -> Result<Target, String> {
        let name = task.name.name.to_string();
        if self.within.contains(&name) {
            return Err(format!("{name}, which would run itself"));
        }
        self.within.push(name);
        let scope = Scope {
            exit,
            fail,
            labels: Vec::new(),
        };
        let start = self.steps(&task.steps, exit, scope);
        self.within.pop();
        start
    }

    /// Puts steps in place, which lead to `behind`; gives the first.
    fn steps(
        &mut self,
        steps: &[Step],
        behind: Target,
        mut scope: Scope,
    ) -> Result<Target, String> {
        let first = self.nodes.len();
        self.nodes.resize(first + steps.len(), TaskNode::Pass(None));
        for (at, step) in (first..).zip(steps) {
            if let StepKind::Run(run) = &step.kind
                && let Some(label) = &run.label
            {
                scope.labels.push((label.name.to_string(), at));
            }
        }
        for (at, step) in (first..).zip(steps) {
            let last = at + 1 == first + steps.len();
            let next = if last { behind } else { Some(at + 1) };
            self.nodes[at] = self.step(step, next, &scope)?;
        }
        let mut start = if steps.is_empty() {
            behind
        } else {
            Some(first)
        };
        for step in steps {
            if let StepKind::Start(label) = &step.kind {
                start = Some(labelled(&scope, &label.name.to_string())?);
            }
        }
        Ok(start)
    }

    fn step(&mut self, step: &Step, next: Target, scope: &Scope) -> Result<TaskNode, String> {
        match &step.kind {
            StepKind::Run(run) => self.run(run, next, scope),
            StepKind::Repeat { count, steps } => {
                let times = count.as_ref().map(|count| whole(&count.kind)).transpose()?;
                self.repeat(times, steps, next, scope)
            }
            StepKind::Start(_) => Ok(TaskNode::Pass(next)),
            StepKind::Broken(_) => Err("a step that cannot be read".to_owned()),
        }
    }

    fn repeat(
        &mut self,
        times: Option<u64>,
        steps: &[Step],
        then: Target,
        scope: &Scope,
    ) -> Result<TaskNode, String> {
        let at = self.nodes.len();
        self.nodes.push(TaskNode::Pass(None));
        let body = self.steps(steps, Some(at), scope.clone())?;
        self.nodes[at] = TaskNode::Repeat { times, body, then };
        Ok(TaskNode::Enter(at))
    }

    fn run(&mut self, run: &Run, next: Target, scope: &Scope) -> Result<TaskNode, String> {
        let name = run.callee.name.name.to_string();
        let branches = branches(&run.branches, scope)?;
        let otherwise = branches.any.or(run.branches.is_empty().then_some(next));
        let on_fail = branches.fail.or(branches.any).or(scope.fail);
        let called = declared(self.file).find(|task| task.name.name.to_string() == name);
        if let Some(task) = called {
            let args = self.arguments(&name, &task.params, &run.args)?;
            if let Some((result, _)) = branches.named.first() {
                return Err(format!(
                    "the result {result} of {name}, which is a task and has none"
                ));
            }
            let params = task.params.iter().flat_map(|var| &var.names);
            let inner = params.map(|param| param.name.clone()).zip(args).collect();
            let outer = std::mem::replace(&mut self.names, inner);
            let start = self.task(task, otherwise.unwrap_or(next), on_fail)?;
            self.names = outer;
            return Ok(TaskNode::Pass(start));
        }
        Ok(TaskNode::Run {
            command: self.called(name, &run.args)?,
            on: branches.named,
            on_fail,
            otherwise,
        })
    }

    /// The name of a command's net for its arguments.
    fn called(&mut self, name: String, args: &[Arg]) -> Result<String, String> {
        let params = self.command(&name)?;
        let args = self.arguments(&name, params, args)?;
        let mut names = params.iter().flat_map(|var| &var.names).zip(&args);
        if names.all(|(param, arg)| param.name == *arg) {
            return Ok(name);
        }
        let instance = Instance {
            command: name,
            args,
        };
        let name = instance.name();
        self.instances.push(instance);
        Ok(name)
    }

    /// What each parameter is given, in the order of the parameters.
    fn arguments(&self, name: &str, params: &[VarDecl], args: &[Arg]) -> Result<Vec<Name>, String> {
        let params = params.iter().flat_map(|var| &var.names);
        let mut unnamed = args.iter().filter(|arg| arg.name.is_none());
        let mut found = Vec::new();
        for param in params {
            let is_meant = |arg: &&Arg| arg.name.as_ref().is_some_and(|n| n.name == param.name);
            let arg = args.iter().find(is_meant).or_else(|| unnamed.next());
            let arg = arg.ok_or_else(|| format!("an argument of {name} for {}", param.name))?;
            let given = arg.value.unparen().as_name().ok_or_else(|| {
                format!(
                    "{} of {name} without calculation: give the value a name by `const`",
                    param.name
                )
            })?;
            found.push(self.names.get(given).unwrap_or(given).clone());
        }
        Ok(found)
    }

    /// The parameters of a command.
    fn command(&self, name: &str) -> Result<&'f [VarDecl], String> {
        let found = self.file.items.iter().find_map(|item| match &item.kind {
            ItemKind::Command(command) if *command.name.name == *name => {
                Some(command.params.as_slice())
            }
            _ => None,
        });
        found.ok_or_else(|| format!("{name}, which is no command or task of this file"))
    }
}

#[derive(Default)]
struct Branches {
    named: Vec<(String, Target)>,
    fail: Option<Target>,
    any: Option<Target>,
}

/// What the branches say; of two for one result the first counts.
fn branches(all: &[Branch], scope: &Scope) -> Result<Branches, String> {
    let mut found = Branches::default();
    for branch in all {
        let then = match &branch.then {
            Next::End(_) => scope.exit,
            Next::Step(label) => Some(labelled(scope, &label.name.to_string())?),
        };
        for on in &branch.on {
            match on {
                OnResult::Named(result) => found.named.push((result.name.to_string(), then)),
                OnResult::Fail(_) => found.fail = found.fail.or(Some(then)),
                OnResult::Any(_) => found.any = found.any.or(Some(then)),
            }
        }
    }
    Ok(found)
}

fn labelled(scope: &Scope, label: &str) -> Result<usize, String> {
    let found = scope.labels.iter().rev().find(|(name, _)| name == label);
    found
        .map(|(_, at)| *at)
        .ok_or_else(|| format!("the step {label}, which is not there"))
}

fn whole(count: &ExprKind) -> Result<u64, String> {
    let text = match count {
        ExprKind::Number(number) => number.text.to_string(),
        _ => return Err("a number of repetitions that is computed".to_owned()),
    };
    text.parse().map_err(|_| format!("{text} repetitions"))
}

#[cfg(test)]
mod tests {
    use super::*;

    const COMMANDS: &str = "command A (arm: Arm) let finish done when true; tel\ncommand B (arm: Arm) let finish done when true; tel\n";

    fn planned(task: &str) -> Result<TaskPlan, String> {
        let text = format!("{COMMANDS}{task}");
        let parsed = rpi_syntax::parse(rpi_diag::FileId(0), &text, rpi_syntax::Mode::Rpi);
        tasks(&parsed.file).pop().expect("there is a task").plan
    }

    /// A command that is run, where its named results lead, and `fail` and all others.
    type Step<'p> = (
        &'p str,
        &'p [(String, Target)],
        Option<Target>,
        Option<Target>,
    );

    fn run(plan: &TaskPlan, at: Target) -> Step<'_> {
        match &plan.nodes[at.expect("it goes on")] {
            TaskNode::Run {
                command,
                on,
                on_fail,
                otherwise,
            } => (command, on, *on_fail, *otherwise),
            TaskNode::Pass(then) => run(plan, *then),
            other => panic!("{other:?} is no command"),
        }
    }

    /// M11.1.
    #[test]
    fn branches_lead_to_named_steps() {
        let plan = planned(
            "task T (arm: Arm) let start b; a: A(arm) on any then end; b: B(arm) on done then a | on fail then end; tel",
        );
        let plan = plan.unwrap();
        let (command, on, fail, otherwise) = run(&plan, plan.start);
        assert_eq!((command, fail, otherwise), ("B", Some(None), None));
        let (command, _, fail, otherwise) = run(&plan, on[0].1);
        assert_eq!((command, fail, otherwise), ("A", Some(None), Some(None)));
    }

    #[test]
    fn tasks_within_tasks_are_put_in_place() {
        let inner = "task Inner (arm: Arm) let A(arm); tel\n";
        let outer =
            "task T (arm: Arm) let Inner(arm) on fail then b | on any then end; b: B(arm); tel";
        let plan = planned(&format!("{inner}{outer}")).unwrap();
        let (command, _, fail, otherwise) = run(&plan, plan.start);
        assert_eq!((command, otherwise), ("A", Some(None)));
        assert_eq!(run(&plan, fail.unwrap()).0, "B");
        let circle = planned("task T (arm: Arm) let T(arm); tel");
        assert!(circle.unwrap_err().contains("itself"));
    }

    #[test]
    fn arguments_make_instances() {
        let inner = "task Inner (one: Arm) let A(one); B(arm: one); tel\n";
        let text =
            format!("{COMMANDS}{inner}task T (left: Arm; arm: Arm) let Inner(left); A(arm); tel");
        let parsed = rpi_syntax::parse(rpi_diag::FileId(0), &text, rpi_syntax::Mode::Rpi);
        let names: Vec<String> = instances(&parsed.file).iter().map(Instance::name).collect();
        assert_eq!(names, ["A(left)", "A(one)", "B(left)", "B(one)"]);
        let plan = tasks(&parsed.file).pop().unwrap().plan.unwrap();
        let (command, _, _, then) = run(&plan, plan.start);
        assert_eq!(command, "A(left)");
        let (command, _, _, then) = run(&plan, then.unwrap());
        assert_eq!(command, "B(left)");
        assert_eq!(run(&plan, then.unwrap()).0, "A");
    }

    #[test]
    fn what_cannot_be_run_is_told() {
        for (steps, word) in [
            ("C(arm);", "no command"),
            ("A();", "argument"),
            ("A(arm + arm);", "const"),
            ("A(arm) on done then x;", "step x"),
            ("repeat n times let A(arm); tel", "computed"),
        ] {
            let why = planned(&format!("task T (arm: Arm) let {steps} tel")).unwrap_err();
            assert!(why.contains(word), "{why}");
        }
    }
}
