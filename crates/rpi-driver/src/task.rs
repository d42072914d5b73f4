//! Tasks as the host runs them: which command follows which.
//!
//! Sequences and repetitions of a program's commands, each called with the names of its own parameters; a task that
//! does more is refused with the reason.

use rpi_syntax::ast::{Arg, CommandDecl, ExprKind, File, ItemKind, Run, Step, StepKind, TaskDecl};

/// A task.
#[derive(Clone, PartialEq, Debug)]
pub struct Task {
    /// Its name.
    pub name: String,
    /// Its steps, or why it cannot be run.
    pub steps: Result<Vec<TaskStep>, String>,
}

/// A step of a task.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum TaskStep {
    /// The command of this name.
    Run(String),
    /// All of these, so many times; without a number for ever.
    Repeat(Option<u64>, Vec<TaskStep>),
}

/// The tasks of a file, in the order of the text.
pub(crate) fn tasks(file: &File) -> Vec<Task> {
    let tasks = file.items.iter().filter_map(|item| match &item.kind {
        ItemKind::Task(task) => Some(task.as_ref()),
        _ => None,
    });
    tasks
        .map(|task: &TaskDecl| Task {
            name: task.name.name.to_string(),
            steps: steps(file, &task.steps),
        })
        .collect()
}

fn steps(file: &File, all: &[Step]) -> Result<Vec<TaskStep>, String> {
    all.iter().map(|one| step(file, one)).collect()
}

fn step(file: &File, step: &Step) -> Result<TaskStep, String> {
    match &step.kind {
        StepKind::Run(run) => command(file, run),
        StepKind::Repeat { count, steps: body } => {
            let times = count.as_ref().map(|count| whole(&count.kind)).transpose()?;
            Ok(TaskStep::Repeat(times, steps(file, body)?))
        }
        StepKind::Start(_) => Err("a task that begins with a named step".to_owned()),
        StepKind::Broken(_) => Err("a step that cannot be read".to_owned()),
    }
}

fn command(file: &File, run: &Run) -> Result<TaskStep, String> {
    let name = run.callee.name.name.to_string();
    if !run.branches.is_empty() {
        return Err(format!("branches on the results of {name}"));
    }
    let declared = file.items.iter().find_map(|item| match &item.kind {
        ItemKind::Command(command) if command.name.name.to_string() == name => Some(command),
        _ => None,
    });
    let declared = declared.ok_or_else(|| format!("{name}, which is no command of this file"))?;
    match takes_its_own(declared, &run.args) {
        true => Ok(TaskStep::Run(name)),
        false => Err(format!(
            "other arguments for {name} than its parameters by their names"
        )),
    }
}

/// True if each parameter is given what has its own name: that is what it has when it is run by itself.
fn takes_its_own(command: &CommandDecl, args: &[Arg]) -> bool {
    let params = command.params.iter().flat_map(|var| &var.names);
    let mut pairs = params.zip(args);
    pairs.all(|(param, arg)| matches!(&arg.value.kind, ExprKind::Name(name) if *name == param.name))
}

fn whole(count: &ExprKind) -> Result<u64, String> {
    let text = match count {
        ExprKind::Number(number) => number.text.to_string(),
        _ => return Err("a number of repetitions that is computed".to_owned()),
    };
    text.parse().map_err(|_| format!("{text} repetitions"))
}
