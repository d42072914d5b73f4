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
    /// For each the bound on what its primitives do in a cycle, in elementary operations, where a compiler has shown one.
    pub work: Vec<Option<u64>>,
    /// What follows what.
    pub plan: Plan,
}

impl Script {
    /// A command by itself.
    #[must_use]
    pub fn once((image, work): (Image, Option<u64>)) -> Script {
        Script {
            images: vec![Arc::new(image)],
            work: vec![work],
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
        lower: impl Fn(&Net) -> Result<(Image, Option<u64>), String>,
    ) -> Result<Script, String> {
        let name = &task.name;
        let plan = task.plan.as_ref();
        let plan =
            plan.map_err(|why| format!("task {name} needs what cannot be run yet: {why}"))?;
        let mut used: Vec<String> = Vec::new();
        let plan = resolved(plan, &mut used);
        let lowered = used.iter().map(|command| {
            let net = nets.iter().find(|net| net.name == *command);
            lower(net.ok_or_else(|| format!("{command} cannot be run by itself"))?)
        });
        let lowered: Vec<(Image, Option<u64>)> = lowered.collect::<Result<_, String>>()?;
        let (images, work): (Vec<_>, Vec<_>) = lowered
            .into_iter()
            .map(|(image, work)| (Arc::new(image), work))
            .unzip();
        plan.check(&images)?;
        Ok(Script { images, work, plan })
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
