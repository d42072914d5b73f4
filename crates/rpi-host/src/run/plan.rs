//! Which command follows which result: the plan of a task.

use rpi_image::Image;
use rpi_image::image::{End, EndKind};
use rpi_net::plan::Target;

/// A node of a plan: its command is the place of an image in a list.
pub type Node = rpi_net::plan::Node<usize>;

/// What a task does.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Plan {
    /// Its nodes; targets are indices.
    pub nodes: Vec<Node>,
    /// The first one.
    pub start: Target,
}

impl Plan {
    /// One command, once.
    #[must_use]
    pub fn once(command: usize) -> Plan {
        let node = Node::Run {
            command,
            on: Vec::new(),
            on_fail: None,
            otherwise: Some(None),
        };
        Plan {
            nodes: vec![node],
            start: Some(0),
        }
    }

    /// Checks that every result leads somewhere.
    ///
    /// # Errors
    /// Names the command and what is missing or too much.
    pub fn check(&self, images: &[std::sync::Arc<Image>]) -> Result<(), String> {
        self.nodes.iter().try_for_each(|node| match node {
            Node::Run {
                command,
                on,
                otherwise,
                ..
            } => complete(&images[*command], on, otherwise.is_some()),
            _ => Ok(()),
        })
    }
}

fn complete(image: &Image, on: &[(String, Target)], otherwise: bool) -> Result<(), String> {
    let results = match &image.end {
        End::Results(results) => results.as_slice(),
        End::Ports { .. } => &[],
    };
    let command = &image.name;
    if let Some((name, _)) = on
        .iter()
        .find(|(name, _)| results.iter().all(|r| r.name != *name))
    {
        return Err(format!("{command} has no result {name}"));
    }
    let led = |name: &str| on.iter().any(|(own, _)| own == name);
    let mut regular = results.iter().filter(|r| r.kind != EndKind::Fail);
    match regular.find(|r| !otherwise && !led(&r.name)) {
        Some(lost) => Err(format!(
            "nothing is said for the result {} of {command}",
            lost.name
        )),
        None => Ok(()),
    }
}
