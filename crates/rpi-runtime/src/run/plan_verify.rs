//! Verifier of plans, which may come from another process: every index is in range, and parallel branches are nested.

use rpi_image::plan::Target;

use super::plan::{ExecutablePlan, Node, PlanError};

/// Maximum depth of parallel branches within parallel branches: the search for the next step recurses into them.
const MAX_DEPTH: usize = 64;
/// Maximum number of visits per node. In a plan of the compiler, each node belongs to one branch, apart from joins.
const MAX_VISITS: usize = 64;

/// Walk over all branches of a plan.
struct Walk<'a> {
    plan: &'a ExecutablePlan,
    /// Number of the branch in which each node was visited last.
    visited: Vec<u32>,
    branch: u32,
    visits: usize,
}

/// Verifies a plan for this number of commands.
///
/// # Errors
/// If an index is out of range, a loop or exit leads to a node of another kind, or branches are not nested.
pub(super) fn verify(plan: &ExecutablePlan, commands: usize) -> Result<(), PlanError> {
    let nodes = plan.nodes.as_slice();
    let wrong = nodes
        .iter()
        .position(|node| !is_valid(node, nodes, commands));
    if let Some(node) = wrong {
        return Err(PlanError::InvalidNode(node));
    }
    if !is_in_range(&plan.start, nodes) {
        return Err(PlanError::InvalidNode(nodes.len()));
    }
    let mut walk = Walk {
        plan,
        visited: vec![0; nodes.len()],
        branch: 0,
        visits: 0,
    };
    match walk.is_nested(plan.start, 0) {
        true => Ok(()),
        false => Err(PlanError::InvalidNesting),
    }
}

/// Returns whether a target is the end or the index of a node.
fn is_in_range(target: &Target, nodes: &[Node]) -> bool {
    target.is_none_or(|at| at < nodes.len())
}

/// Returns whether all indices of a node are in range and lead to nodes of the expected kind.
fn is_valid(node: &Node, nodes: &[Node], commands: usize) -> bool {
    let valid = |target: &Target| is_in_range(target, nodes);
    match node {
        Node::Goto(then) => valid(then),
        Node::EnterLoop(repeat) => matches!(nodes.get(*repeat), Some(Node::Repeat { .. })),
        Node::Repeat { body, next, .. } => valid(body) && valid(next),
        Node::Parallel { branches, then } => branches.iter().all(valid) && valid(then),
        Node::Join => true,
        Node::CancelBranches { parallel, then } => {
            matches!(nodes.get(*parallel), Some(Node::Parallel { .. })) && valid(then)
        }
        Node::Run {
            command,
            on_result,
            on_fail,
            default,
        } => {
            let named = on_result.iter().map(|(_, then)| then);
            let mut targets = named.chain(on_fail).chain(default);
            *command < commands && targets.all(valid)
        }
    }
}

impl Walk<'_> {
    /// Returns whether the branches of all parallel nodes that a branch reaches are nested.
    fn is_nested(&mut self, start: Target, depth: usize) -> bool {
        if depth > MAX_DEPTH {
            return false;
        }
        let plan = self.plan;
        self.branch += 1;
        let branch = self.branch;
        let mut next: Vec<usize> = start.into_iter().collect();
        while let Some(at) = next.pop() {
            if std::mem::replace(&mut self.visited[at], branch) == branch {
                continue;
            }
            self.visits += 1;
            if self.visits > MAX_VISITS * plan.nodes.len() {
                return false;
            }
            if let Node::Parallel { branches, .. } = &plan.nodes[at] {
                let nested = branches
                    .iter()
                    .all(|inner| self.is_nested(*inner, depth + 1));
                if !nested {
                    return false;
                }
            }
            plan.push_successors(at, &mut next);
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn verdict(nodes: Vec<Node>) -> Result<(), PlanError> {
        let start = Some(0);
        verify(&ExecutablePlan { nodes, start }, 1)
    }

    fn run(command: usize, then: Target) -> Node {
        Node::Run {
            command,
            on_result: Vec::new(),
            on_fail: None,
            default: Some(then),
        }
    }

    fn parallel(branch: usize, then: Target) -> Node {
        Node::Parallel {
            branches: vec![Some(branch), Some(branch)],
            then,
        }
    }

    #[test]
    fn every_index_must_be_in_range() {
        assert_eq!(verdict(vec![run(0, None)]), Ok(()));
        assert_eq!(verdict(vec![run(1, None)]), Err(PlanError::InvalidNode(0)));
        assert_eq!(
            verdict(vec![Node::Goto(Some(1))]),
            Err(PlanError::InvalidNode(0))
        );
        let wrong_loop = vec![Node::EnterLoop(1), Node::Join];
        assert_eq!(verdict(wrong_loop), Err(PlanError::InvalidNode(0)));
        assert_eq!(verdict(Vec::new()), Err(PlanError::InvalidNode(0)));
    }

    #[test]
    fn branches_must_be_nested_and_not_too_deep() {
        let split = vec![parallel(1, None), run(0, Some(2)), Node::Join];
        assert_eq!(verdict(split), Ok(()));
        assert_eq!(
            verdict(vec![parallel(0, None)]),
            Err(PlanError::InvalidNesting)
        );
        // Each node has both branches in the next one: 2 to the power of 40 steps.
        let mut nodes: Vec<Node> = (1..=40).map(|next| parallel(next, None)).collect();
        nodes.push(Node::Join);
        assert_eq!(verdict(nodes), Err(PlanError::InvalidNesting));
    }
}
