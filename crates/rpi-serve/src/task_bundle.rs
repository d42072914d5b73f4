//! A task ready to load: images of its commands and a plan that refers to them by index.

use std::fmt;
use std::sync::Arc;

use rpi_driver::{AnalysedNet, Task, TaskPlan};
use rpi_image::Image;
use rpi_runtime::run::{ExecutablePlan, PlanError};

/// Images of a task's commands, and the plan that runs them, ready to be loaded by a server.
#[derive(Clone, PartialEq, Debug)]
pub struct TaskBundle {
    /// Images of the commands; the plan refers to them by index.
    pub images: Vec<Arc<Image>>,
    /// For each image, the compiler's upper bound on the work of its primitives in a cycle, in elementary operations;
    /// `None` if unknown.
    pub work: Vec<Option<u64>>,
    /// Order in which the commands run, with indices into `images`.
    pub plan: ExecutablePlan,
}

/// Error: a program's task cannot be run.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum TaskBundleError {
    /// The plan of the task cannot be made.
    InvalidPlan {
        /// Name of the task.
        task: String,
        /// Description of the error.
        reason: String,
    },
    /// No net exists for the command with this name, because the command has parameters without a value.
    NotRunnable(String),
    /// The net of a command cannot be lowered; the text has the reason.
    Lowering(String),
    /// The plan refers to a result that a command does not have, or to a missing command.
    Plan(PlanError),
}

impl fmt::Display for TaskBundleError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            TaskBundleError::InvalidPlan { task, reason } => {
                write!(f, "task {task} cannot be run: {reason}")
            }
            TaskBundleError::NotRunnable(command) => write!(f, "{command} cannot be run alone"),
            TaskBundleError::Lowering(reason) => f.write_str(reason),
            TaskBundleError::Plan(error) => write!(f, "{error}"),
        }
    }
}

impl std::error::Error for TaskBundleError {}

impl TaskBundle {
    /// Creates a bundle that runs a single command once.
    #[must_use]
    pub fn single((image, work): (Image, Option<u64>)) -> TaskBundle {
        TaskBundle {
            images: vec![Arc::new(image)],
            work: vec![work],
            plan: ExecutablePlan::once(0),
        }
    }

    /// Creates the bundle of `task` from the nets of its program. `lower` returns the image of a net, with the upper
    /// bound on its work per cycle.
    ///
    /// # Errors
    /// If the task or one of its commands cannot be run.
    pub fn from_task<E: fmt::Display>(
        task: &Task,
        nets: &[AnalysedNet],
        lower: impl Fn(&AnalysedNet) -> Result<(Image, Option<u64>), E>,
    ) -> Result<TaskBundle, TaskBundleError> {
        let plan = task.plan.as_ref();
        let plan = plan.map_err(|reason| TaskBundleError::InvalidPlan {
            task: task.name.clone(),
            reason: reason.to_string(),
        })?;
        let mut used: Vec<String> = Vec::new();
        let plan = with_indices(plan, &mut used);
        let (mut images, mut work) = (Vec::new(), Vec::new());
        for command in &used {
            let net = nets.iter().find(|net| net.name == *command);
            let net = net.ok_or_else(|| TaskBundleError::NotRunnable(command.clone()))?;
            let lowered = lower(net).map_err(|e| TaskBundleError::Lowering(e.to_string()))?;
            images.push(Arc::new(lowered.0));
            work.push(lowered.1);
        }
        plan.check(&images).map_err(TaskBundleError::Plan)?;
        Ok(TaskBundle { images, work, plan })
    }
}

/// Replaces command names in a plan by indices into `used`. Names that are not in `used` are added to it.
fn with_indices(plan: &TaskPlan, used: &mut Vec<String>) -> ExecutablePlan {
    let nodes = plan.nodes.iter();
    ExecutablePlan {
        nodes: nodes
            .map(|node| node.map(|name| intern(name, used)))
            .collect(),
        start: plan.start,
    }
}

fn intern(name: &str, used: &mut Vec<String>) -> usize {
    let known = used.iter().position(|u| u == name);
    known.unwrap_or_else(|| {
        used.push(name.to_owned());
        used.len() - 1
    })
}
