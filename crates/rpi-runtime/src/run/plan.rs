//! Plan of a task: which command follows which result.

use std::fmt;
use std::sync::Arc;

use rpi_image::Image;
use rpi_image::image::{CommandEnd, CommandEndKind};
use rpi_image::plan::Target;

use super::plan_verify;

/// Node of a plan of a task. The node refers to its command by index in a list of images.
pub type Node = rpi_image::plan::IndexedNode;

/// Plan of a task that can be executed: a graph of nodes, which says which command follows which result.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct ExecutablePlan {
    /// Nodes of the plan. Targets are indices into this list.
    pub nodes: Vec<Node>,
    /// Index of the first node; `None` for a plan without commands.
    pub start: Target,
}

/// Error: a plan does not fit the results of its commands.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum PlanError {
    /// The plan has a branch for a result that the command does not have.
    UnknownResult {
        /// Name of the command that lacks the result.
        command: String,
        /// Name of the result that does not exist.
        result: String,
    },
    /// The plan does not handle a result of the command.
    UnhandledResult {
        /// Name of the command with the unhandled result.
        command: String,
        /// Name of the result without a branch.
        result: String,
    },
    /// The node with this index, or the start if there is no such node, refers to a node or command that does not exist
    /// or is of another kind.
    InvalidNode(usize),
    /// Parallel branches are not nested, or nested too deeply.
    InvalidNesting,
}

impl fmt::Display for PlanError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            PlanError::UnknownResult { command, result } => {
                write!(f, "`{command}` has no result `{result}`")
            }
            PlanError::UnhandledResult { command, result } => {
                write!(f, "result `{result}` of `{command}` is not handled")
            }
            PlanError::InvalidNode(node) => write!(f, "invalid plan: node {node}"),
            PlanError::InvalidNesting => {
                f.write_str("invalid plan: parallel branches are not nested, or too deeply")
            }
        }
    }
}

impl std::error::Error for PlanError {}

impl ExecutablePlan {
    /// Returns a plan that runs the command with this index in the list of images once.
    #[must_use]
    pub fn once(command: usize) -> ExecutablePlan {
        let node = Node::Run {
            command,
            on_result: Vec::new(),
            on_fail: None,
            default: Some(None),
        };
        ExecutablePlan {
            nodes: vec![node],
            start: Some(0),
        }
    }

    /// Returns the worst-case time of the plan's commands in one tick, in nanoseconds. `of` holds the worst-case time
    /// of each command.
    ///
    /// A branch runs one command at a time, and no command while its own parallel branches run.
    pub(super) fn worst_case_ns(&self, of: &[u64]) -> u64 {
        self.branch_worst_case_ns(self.start, of)
    }

    fn branch_worst_case_ns(&self, start: Target, of: &[u64]) -> u64 {
        let (mut most, mut seen) = (0, vec![false; self.nodes.len()]);
        let mut next: Vec<usize> = start.into_iter().collect();
        while let Some(at) = next.pop() {
            if std::mem::replace(&mut seen[at], true) {
                continue;
            }
            match &self.nodes[at] {
                Node::Run { command, .. } => most = most.max(of[*command]),
                Node::Parallel { branches, .. } => {
                    let each = branches
                        .iter()
                        .map(|branch| self.branch_worst_case_ns(*branch, of));
                    most = most.max(each.fold(0, u64::saturating_add));
                }
                _ => {}
            }
            self.push_successors(at, &mut next);
        }
        most
    }

    /// Adds to `next` the indices of the nodes that may follow the node `at` within its branch.
    pub(super) fn push_successors(&self, at: usize, next: &mut Vec<usize>) {
        match &self.nodes[at] {
            Node::Goto(then) => next.extend(*then),
            Node::EnterLoop(repeat) => next.push(*repeat),
            Node::Repeat {
                body, next: then, ..
            } => next.extend(body.iter().chain(then)),
            Node::Parallel { then, .. } => {
                let left = self.nodes.iter().filter_map(|node| match node {
                    Node::CancelBranches { parallel, then } if *parallel == at => *then,
                    _ => None,
                });
                next.extend(left.chain(*then));
            }
            // Nodes after the join belong to the enclosing branch.
            Node::Join | Node::CancelBranches { .. } => {}
            Node::Run {
                on_result: on,
                on_fail,
                default: otherwise,
                ..
            } => {
                let named = on.iter().map(|(_, then)| *then);
                next.extend(named.chain(*on_fail).chain(*otherwise).flatten());
            }
        }
    }

    /// Checks that all indices of the plan are valid and that every result of every command is handled.
    ///
    /// # Errors
    /// If the plan is invalid, or handles a result that the command does not have or not every result that it has. The
    /// error names the command and the result.
    pub fn check(&self, images: &[Arc<Image>]) -> Result<(), PlanError> {
        plan_verify::verify(self, images.len())?;
        self.nodes.iter().try_for_each(|node| match node {
            Node::Run {
                command,
                on_result: on,
                default: otherwise,
                ..
            } => check_results(&images[*command], on, otherwise.is_some()),
            _ => Ok(()),
        })
    }
}

/// Checks that `on`, the next node for each result handled by name, names only results of the command, and that the
/// plan handles every result without an error: by name, or by its default if `has_default`.
fn check_results(
    image: &Image,
    on: &[(String, Target)],
    has_default: bool,
) -> Result<(), PlanError> {
    let results = match &image.end {
        CommandEnd::Results(results) => results.as_slice(),
        CommandEnd::Ports { .. } => &[],
    };
    let command = || image.name.clone();
    if let Some((name, _)) = on
        .iter()
        .find(|(name, _)| results.iter().all(|r| r.name != *name))
    {
        return Err(PlanError::UnknownResult {
            command: command(),
            result: name.clone(),
        });
    }
    let is_handled = |name: &str| has_default || on.iter().any(|(own, _)| own == name);
    let mut regular = results.iter().filter(|r| r.kind != CommandEndKind::Fail);
    match regular.find(|r| !is_handled(&r.name)) {
        Some(unhandled) => Err(PlanError::UnhandledResult {
            command: command(),
            result: unhandled.name.clone(),
        }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(command: usize, then: Target) -> Node {
        Node::Run {
            command,
            on_result: Vec::new(),
            on_fail: None,
            default: Some(then),
        }
    }

    #[test]
    fn strands_add_up_and_what_follows_takes_turns() {
        let nodes = vec![
            run(0, Some(1)),
            Node::Parallel {
                branches: vec![Some(2), Some(4)],
                then: Some(6),
            },
            run(1, Some(3)),
            Node::CancelBranches {
                parallel: 1,
                then: Some(7),
            },
            run(2, Some(5)),
            Node::Join,
            Node::Repeat {
                count: None,
                body: Some(0),
                next: None,
            },
            run(3, None),
        ];
        let plan = ExecutablePlan {
            nodes,
            start: Some(0),
        };
        assert_eq!(plan.worst_case_ns(&[10, 20, 30, 40]), 50);
        assert_eq!(plan.worst_case_ns(&[60, 20, 30, 40]), 60);
        assert_eq!(plan.worst_case_ns(&[10, 20, 30, 70]), 70, "after an error");
    }
}
