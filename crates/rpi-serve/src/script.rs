//! What a program's task needs to run: images of its commands, and a plan that names them by their place.

use std::sync::Arc;

use rpi_driver::{Task, TaskPlan};
use rpi_host::run::Plan;
use rpi_image::Image;
use rpi_net::Net;

/// A task, ready to be loaded.
#[derive(Clone, PartialEq, Debug)]
pub struct Script {
    /// Its commands.
    pub images: Vec<Arc<Image>>,
    /// What follows what.
    pub plan: Plan,
}

impl Script {
    /// A command by itself.
    #[must_use]
    pub fn once(image: Image) -> Script {
        Script {
            images: vec![Arc::new(image)],
            plan: Plan::once(0),
        }
    }

    /// A task of a program with these nets, its commands lowered by `lower`.
    ///
    /// # Errors
    /// What keeps the task, or one of its commands, from being run.
    pub fn of_task(
        task: &Task,
        nets: &[Net],
        lower: impl Fn(&Net) -> Result<Image, String>,
    ) -> Result<Script, String> {
        let name = &task.name;
        let plan = task.plan.as_ref();
        let plan =
            plan.map_err(|why| format!("task {name} needs what cannot be run yet: {why}"))?;
        let mut used: Vec<String> = Vec::new();
        let plan = resolved(plan, &mut used);
        let images = used.iter().map(|command| {
            let net = nets.iter().find(|net| net.name == *command);
            lower(net.ok_or_else(|| format!("{command} cannot be run by itself"))?).map(Arc::new)
        });
        let images: Vec<Arc<Image>> = images.collect::<Result<_, _>>()?;
        plan.check(&images)?;
        Ok(Script { images, plan })
    }
}

/// The plan with commands as indices into `used`.
fn resolved(plan: &TaskPlan, used: &mut Vec<String>) -> Plan {
    let nodes = plan.nodes.iter();
    Plan {
        nodes: nodes
            .map(|node| node.map(|name| index(name, used)))
            .collect(),
        start: plan.start,
    }
}

fn index(name: &str, used: &mut Vec<String>) -> usize {
    let known = used.iter().position(|u| u == name);
    known.unwrap_or_else(|| {
        used.push(name.to_owned());
        used.len() - 1
    })
}
