//! Task plans for the host: which command follows which result.
//!
//! A task becomes a plan, a graph of nodes. Called tasks are inlined. A command with other arguments than its default
//! ones is an [`Instance`] with its own net.
//!
//! | file | idea |
//! |---|---|
//! | `plan.rs` | conversion of steps to nodes |
//! | `instance.rs` | arguments of commands |

mod instance;
mod plan;

pub(crate) use instance::Instance;
use instance::Instances;

use plan::PlanError;
use std::fmt;

use rpi_diag::Diagnostic;
use rpi_image::plan::Target;
use rpi_sema::elab::task_too_large;
use rpi_sema::typed::{UnitId, UnitKind};

use crate::program::AnalysedProgram;

/// Task of a program, with its plan: which command follows which result.
#[derive(Clone, PartialEq, Debug)]
pub struct Task {
    /// Name of the task.
    pub name: String,
    /// Plan of the task, or the reason why it cannot be run.
    pub plan: Result<TaskPlan, TaskPlanError>,
}

/// Reason why a task cannot be run, as a noun phrase for a message.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct TaskPlanError(String);

impl fmt::Display for TaskPlanError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for TaskPlanError {}

/// Node of the plan of a task. The node identifies its command by name, with the arguments if these differ from the
/// names of the parameters, as in `MoveTo(arm, home)`.
pub type TaskNode = rpi_image::plan::PlanNode<String>;

/// Plan of a task: a graph of nodes, which says which command follows which result.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct TaskPlan {
    /// Nodes of the plan. They refer to each other by index in this list.
    pub nodes: Vec<TaskNode>,
    /// Index of the first node; `None` if the task runs no command.
    pub start: Target,
}

/// Returns the tasks of a program in source order, and the instances of commands (commands with given arguments) that
/// they need. A task that is too large is reported in `diagnostics`, and no further task is returned.
pub(crate) fn tasks(
    front: &AnalysedProgram<'_>,
    diagnostics: &mut Vec<Diagnostic>,
) -> (Vec<Task>, Vec<Instance>) {
    let is_task = |unit: UnitId| front.checked.unit(unit).kind == UnitKind::Task;
    let mut instances = Instances::default();
    let mut tasks = Vec::new();
    for (decl, unit) in front.checked.runnable.iter().copied() {
        if !is_task(unit) || !front.is_error_free(unit) {
            continue;
        }
        let task = front.checked.unit(unit);
        let plan = match plan::plan(front, decl, unit, &mut instances) {
            Ok(plan) => Ok(plan),
            Err(PlanError::Message(why)) => Err(TaskPlanError(why)),
            Err(PlanError::TooLarge) => {
                diagnostics.push(task_too_large(task));
                break;
            }
        };
        let name = task.name.to_string();
        tasks.push(Task { name, plan });
    }
    (tasks, instances.all)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Compiled, Input, InputKind, compile};

    const COMMANDS: &str = "use motion;\nconst two: int = 2;\ncommand A (arm: Arm) let finish done when true; tel\ncommand B (arm: Arm) let finish done when true; tel\ncommand Wait (n: int) let finish done when time > real(n) * 1[ms]; tel\n";

    fn compiled(text: &str) -> Compiled {
        let input = Input {
            path: "t.rpi".into(),
            kind: InputKind::Rpi,
            bytes: text.into(),
        };
        compile(&input).expect("it is text")
    }

    fn planned(task: &str) -> Result<TaskPlan, TaskPlanError> {
        let mut compiled = compiled(&format!("{COMMANDS}{task}"));
        assert!(!compiled.has_errors(), "{:?}", compiled.diagnostics);
        compiled.tasks.pop().expect("there is a task").plan
    }

    /// Command, targets of its named results, target of `fail`, and target of all other results.
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
                on_result: on,
                on_fail,
                default: otherwise,
            } => (command, on, *on_fail, *otherwise),
            TaskNode::Goto(then) => run(plan, *then),
            other => panic!("{other:?} is no command"),
        }
    }

    /// Rule M11.1.
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
    }

    /// Rule M11.6.
    #[test]
    fn strands_meet_again_and_errors_leave_them() {
        let inner =
            "task Inner (arm: Arm) let parallel let A(arm); tel let Wait(1); Wait(2); tel tel\n";
        let outer =
            "task T (arm: Arm) let Inner(arm) on fail then b | on any then end; b: B(arm); tel";
        let plan = planned(&format!("{inner}{outer}")).unwrap();
        let parallel = |node: &TaskNode| match node {
            TaskNode::Parallel {
                branches: strands,
                then,
            } => Some((strands.clone(), *then)),
            _ => None,
        };
        let (strands, then) = plan.nodes.iter().find_map(parallel).unwrap();
        assert_eq!(then, None);
        let (command, _, fail, otherwise) = run(&plan, strands[0]);
        assert_eq!(command, "A");
        assert_eq!(plan.nodes[otherwise.unwrap().unwrap()], TaskNode::Join);
        let TaskNode::CancelBranches { then, .. } = plan.nodes[fail.unwrap().unwrap()] else {
            panic!("an error leaves the strands");
        };
        assert_eq!(run(&plan, then).0, "B");
        let (first, _, _, next) = run(&plan, strands[1]);
        assert_eq!((first, run(&plan, next.unwrap()).0), ("Wait(1)", "Wait(2)"));
    }

    #[test]
    fn arguments_make_instances() {
        let inner =
            "task Inner (one: Arm; n: int) let A(one); repeat n times let Wait(n + 1); tel tel\n";
        let text = format!(
            "{COMMANDS}{inner}task T (left: Arm; arm: Arm) let Inner(left, 2 * 3); A(arm); Wait(two); tel"
        );
        let compiled = compiled(&text);
        let names: Vec<&str> = compiled.nets().iter().map(|net| &*net.name).collect();
        assert_eq!(
            names,
            ["A", "B", "A(one)", "A(left)", "Wait(n + 1)", "Wait(two)"]
        );
        let plan = compiled.tasks[1].plan.as_ref().unwrap();
        let (command, _, _, then) = run(plan, plan.start);
        assert_eq!(command, "A(left)");
        let Some(TaskNode::EnterLoop(at)) = then.and_then(Target::from).map(|at| &plan.nodes[at])
        else {
            panic!("a repetition follows");
        };
        let TaskNode::Repeat {
            count: times,
            body,
            next: then,
        } = &plan.nodes[*at]
        else {
            panic!("a repetition follows");
        };
        assert_eq!(
            (*times, run(plan, *body).0, run(plan, *then).0),
            (Some(6), "Wait(n + 1)", "A")
        );
    }

    #[test]
    fn what_has_no_value_is_told() {
        for (task, word) in [
            ("task T (n: int) let Wait(n); tel", "const n"),
            (
                "task T (n: int) let repeat n times let Wait(1); tel tel",
                "repetitions",
            ),
            ("task T (n: int) let Wait(n + 1); tel", "no value"),
        ] {
            let why = planned(task).unwrap_err().to_string();
            assert!(why.contains(word), "{why}");
        }
    }
}
