//! Which command follows which result: the plan of a task.

use rpi_image::Image;
use rpi_image::image::{End, EndKind};

/// Where a plan goes on; none: it is done.
pub type Target = Option<usize>;

/// What a task does.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Plan {
    /// Its nodes; targets are indices.
    pub nodes: Vec<Node>,
    /// The first one.
    pub start: Target,
}

/// A node of a plan.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Node {
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
    /// All of these at once; once each has come to its [`Node::Join`], it goes on.
    Parallel {
        /// Where each strand begins.
        strands: Vec<Target>,
        /// What comes then.
        then: Target,
    },
    /// A strand is over, and waits for those beside it.
    Join,
    /// The strands of a parallel are left by an error: the others are asked to end, and then it goes on.
    Leave {
        /// The node with the strands.
        parallel: usize,
        /// What comes then.
        then: Target,
    },
    /// A command.
    Run {
        /// Its index.
        command: usize,
        /// What follows these results.
        on: Vec<(String, Target)>,
        /// What follows any other `fail`; none: the task ends with its error.
        on_fail: Option<Target>,
        /// What follows any other result; none if the branches must name them all.
        otherwise: Option<Target>,
    },
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
