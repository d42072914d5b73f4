//! A task ready to load: images of its commands and a plan that refers to them by index.

use std::sync::Arc;

use rpi_driver::{AnalysedNet, Task, TaskPlan};
use rpi_image::Image;
use rpi_runtime::run::ExecutablePlan;

/// A task, ready to be loaded.
#[derive(Clone, PartialEq, Debug)]
pub struct TaskBundle {
    /// Images of the commands.
    pub images: Vec<Arc<Image>>,
    /// For each image, the compiler's upper bound on the work of its primitives in a cycle, in elementary operations,
    /// if known.
    pub work: Vec<Option<u64>>,
    /// Plan with indices into `images`: the order of the commands.
    pub plan: ExecutablePlan,
}

impl TaskBundle {
    /// Creates a script that runs a single command once.
    #[must_use]
    pub fn single((image, work): (Image, Option<u64>)) -> TaskBundle {
        TaskBundle {
            images: vec![Arc::new(image)],
            work: vec![work],
            plan: ExecutablePlan::once(0),
        }
    }

    /// Creates the script of `task` from the nets of its program; `lower` makes an image of a net.
    ///
    /// # Errors
    /// If the task or one of its commands cannot be run.
    pub fn from_task(
        task: &Task,
        nets: &[AnalysedNet],
        lower: impl Fn(&AnalysedNet) -> Result<(Image, Option<u64>), String>,
    ) -> Result<TaskBundle, String> {
        let name = &task.name;
        let plan = task.plan.as_ref();
        let plan = plan.map_err(|why| format!("task {name} cannot be run: {why}"))?;
        let mut used: Vec<String> = Vec::new();
        let plan = with_indices(plan, &mut used);
        let lowered = used.iter().map(|command| {
            let net = nets.iter().find(|net| net.name == *command);
            lower(net.ok_or_else(|| format!("{command} cannot be run alone"))?)
        });
        let lowered: Vec<(Image, Option<u64>)> = lowered.collect::<Result<_, String>>()?;
        let (images, work): (Vec<_>, Vec<_>) = lowered
            .into_iter()
            .map(|(image, work)| (Arc::new(image), work))
            .unzip();
        plan.check(&images)?;
        Ok(TaskBundle { images, work, plan })
    }
}

/// Replaces command names in the plan by indices into `used`, and adds new names to it.
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
