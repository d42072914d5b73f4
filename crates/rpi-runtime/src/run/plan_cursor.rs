//! Positions in the plan of a task and the steps between them.

use rpi_image::Image;
use rpi_image::image::{CommandEnd, CommandEndKind};

use super::plan::{ExecutablePlan, Node};
use rpi_image::plan::Target;

/// Position in the plan of a task: the index of a node, and the iteration count of each loop around the node.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct PlanCursor {
    node: usize,
    counts: Vec<u64>,
}

/// Next step of a task according to its plan.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) enum NextStep {
    /// Run the command at this position of the plan.
    Run(PlanCursor),
    /// Run several branches of the plan in parallel.
    Parallel {
        /// Position of the parallel node with the branches.
        at: PlanCursor,
        /// First step of each branch; [`NextStep::Joined`] for an empty branch.
        branches: Vec<NextStep>,
    },
    /// The parallel branch has ended. It waits until its sibling branches have ended.
    Joined,
    /// Leave all sibling branches because of an error in one of them; the value says where the plan continues.
    Exited(BranchExit),
    /// The task has ended without an error.
    Done,
    /// End the task with the error of its latest command, because the plan does not handle the error.
    Error,
}

/// Exit from parallel branches because of an error in one of them: where the plan continues.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum BranchExit {
    /// The task ends with the error of the command in the branch.
    Error,
    /// The branches of the parallel node with this index end, and the plan continues at the target.
    To(usize, Target),
}

/// Results of a command, by index in its image, that lead to the same next step of the plan.
#[derive(Clone, PartialEq, Eq, Default, Debug)]
pub(super) struct ResultSet {
    /// Indices of the results without an error.
    pub(super) regular: Vec<u32>,
    /// Indices of the results with an error.
    pub(super) failing: Vec<u32>,
}

impl ExecutablePlan {
    /// Returns the first step of the plan: its first command or parallel branches.
    pub(super) fn first(&self) -> NextStep {
        self.resolve_target(self.start, vec![0; self.nodes.len()])
    }

    /// Returns the index of the command at a position of the plan.
    pub(super) fn command(&self, cursor: &PlanCursor) -> usize {
        match &self.nodes[cursor.node] {
            Node::Run { command, .. } => *command,
            _ => 0,
        }
    }

    /// Returns the step of the plan that follows when the command at `cursor` ends with the given result: its name and
    /// kind. `None` stands for an end without a named result.
    pub(super) fn next_after(
        &self,
        cursor: &PlanCursor,
        result: Option<(&str, CommandEndKind)>,
    ) -> NextStep {
        let Node::Run {
            on_result: on,
            on_fail,
            default: otherwise,
            ..
        } = &self.nodes[cursor.node]
        else {
            return NextStep::Done;
        };
        let named = result.and_then(|(name, _)| on.iter().find(|(own, _)| own == name));
        let fails = result.is_some_and(|(_, kind)| kind == CommandEndKind::Fail);
        let other = if fails {
            *on_fail
        } else {
            Some(otherwise.unwrap_or(None))
        };
        match named.map(|(_, target)| *target).or(other) {
            Some(target) => self.resolve_target(target, cursor.counts.clone()),
            None => NextStep::Error,
        }
    }

    /// Returns the step of the plan that follows once all branches of the parallel node at `split` have ended.
    pub(super) fn after_join(&self, split: &PlanCursor) -> NextStep {
        match &self.nodes[split.node] {
            Node::Parallel { then, .. } => self.resolve_target(*then, split.counts.clone()),
            _ => NextStep::Done,
        }
    }

    /// Returns the step of the plan that follows after the branches of the parallel node at `split` were left through
    /// this exit; `None` if the exit belongs to an outer parallel node or ends the task.
    pub(super) fn after_exit(&self, split: &PlanCursor, exit: BranchExit) -> Option<NextStep> {
        match exit {
            BranchExit::To(node, then) if node == split.node => {
                Some(self.resolve_target(then, split.counts.clone()))
            }
            _ => None,
        }
    }

    /// Returns all steps of the plan that may follow the command at `cursor`, each with the results that lead to it.
    /// `image` is that of the command.
    pub(super) fn possible_next(
        &self,
        cursor: &PlanCursor,
        image: &Image,
    ) -> Vec<(NextStep, ResultSet)> {
        let results = match &image.end {
            CommandEnd::Results(results) => results.as_slice(),
            CommandEnd::Ports { .. } => {
                return vec![(self.next_after(cursor, None), ResultSet::default())];
            }
        };
        let mut all: Vec<(NextStep, ResultSet)> = Vec::new();
        for (k, result) in (0u32..).zip(results) {
            let place = self.next_after(cursor, Some((&result.name, result.kind)));
            let known = all.iter().position(|(known, _)| *known == place);
            let at = known.unwrap_or_else(|| {
                all.push((place, ResultSet::default()));
                all.len() - 1
            });
            match result.kind {
                CommandEndKind::Fail => all[at].1.failing.push(k),
                CommandEndKind::Finish | CommandEndKind::Yield => all[at].1.regular.push(k),
            }
        }
        all
    }

    /// Follows the jumps and loops of the plan from the node `from` to the next command or parallel node and returns
    /// that step. `counts` holds the iteration count of each loop, by node index.
    fn resolve_target(&self, from: Target, mut counts: Vec<u64>) -> NextStep {
        let mut at = from;
        // Repetitions of which an empty iteration was found. All further iterations of them are empty as well.
        let mut looked_through = vec![false; self.nodes.len()];
        // The bound ends the search in plans with a cycle of nodes that run no command.
        for _ in 0..=2 * self.nodes.len() {
            let Some(node) = at else {
                return NextStep::Done;
            };
            at = match self.nodes.get(node) {
                None => return NextStep::Done,
                Some(Node::Run { .. }) => return NextStep::Run(PlanCursor { node, counts }),
                Some(Node::Join) => return NextStep::Joined,
                Some(Node::CancelBranches { parallel, then }) => {
                    return NextStep::Exited(BranchExit::To(*parallel, *then));
                }
                Some(Node::Parallel { branches, then }) => {
                    let begin = |branch: &Target| self.resolve_target(*branch, counts.clone());
                    let branches: Vec<NextStep> = branches.iter().map(begin).collect();
                    if branches.iter().any(|branch| *branch != NextStep::Joined) {
                        let at = PlanCursor { node, counts };
                        return NextStep::Parallel { at, branches };
                    }
                    *then
                }
                Some(Node::Goto(then)) => *then,
                Some(Node::EnterLoop(repeat)) => {
                    counts[*repeat] = 0;
                    Some(*repeat)
                }
                Some(Node::Repeat {
                    count: times,
                    body,
                    next: then,
                }) => {
                    let is_known = std::mem::replace(&mut looked_through[node], true);
                    if is_known && times.is_none() {
                        return NextStep::Done;
                    }
                    let again = !is_known && times.is_none_or(|times| counts[node] < times);
                    // Endless repetitions are not counted, so that equal positions compare equal.
                    counts[node] += u64::from(again && times.is_some());
                    if again { *body } else { *then }
                }
            };
        }
        NextStep::Done
    }
}

#[cfg(test)]
mod tests {
    use super::super::plan::Node;
    use super::*;

    fn run(command: usize, then: Target) -> Node {
        Node::Run {
            command,
            on_result: vec![("back".into(), Some(0))],
            on_fail: None,
            default: Some(then),
        }
    }

    /// Returns the commands that run if each of them ends with `result`.
    fn walk(plan: &ExecutablePlan, result: &str, kind: CommandEndKind, most: usize) -> Vec<usize> {
        let mut all = Vec::new();
        let mut at = plan.first();
        while let NextStep::Run(cursor) = at {
            if all.len() == most {
                break;
            }
            all.push(plan.command(&cursor));
            at = plan.next_after(&cursor, Some((result, kind)));
        }
        all
    }

    /// Plan: `repeat 2 times let repeat 2 times let 1 tel; 2 tel`
    fn nested() -> ExecutablePlan {
        let repeat = |times, body, then| Node::Repeat {
            count: times,
            body: Some(body),
            next: then,
        };
        ExecutablePlan {
            nodes: vec![
                Node::EnterLoop(1),
                repeat(Some(2), 2, None),
                Node::EnterLoop(3),
                repeat(Some(2), 4, Some(5)),
                run(1, Some(3)),
                run(2, Some(1)),
            ],
            start: Some(0),
        }
    }

    #[test]
    fn repetitions_nest() {
        assert_eq!(
            walk(&nested(), "done", CommandEndKind::Finish, 99),
            [1, 1, 2, 1, 1, 2]
        );
    }

    /// M11.4: a branch on a result is taken, and an unhandled `fail` ends the task.
    #[test]
    fn branches_are_taken_and_a_fail_ends_it() {
        assert_eq!(
            walk(&nested(), "back", CommandEndKind::Finish, 4),
            [1, 1, 1, 1]
        );
        assert_eq!(walk(&nested(), "broken", CommandEndKind::Fail, 4), [1]);
        let NextStep::Run(first) = nested().first() else {
            panic!("it begins");
        };
        assert_eq!(
            nested().next_after(&first, Some(("broken", CommandEndKind::Fail))),
            NextStep::Error
        );
    }

    #[test]
    fn for_ever_comes_to_the_same_place_again() {
        let nodes = vec![
            Node::EnterLoop(1),
            Node::Repeat {
                count: None,
                body: Some(2),
                next: None,
            },
            run(7, Some(1)),
        ];
        let plan = ExecutablePlan {
            nodes,
            start: Some(0),
        };
        assert_eq!(walk(&plan, "done", CommandEndKind::Finish, 5), [7; 5]);
        let NextStep::Run(first) = plan.first() else {
            panic!("it begins");
        };
        assert_eq!(plan.next_after(&first, None), NextStep::Run(first));
    }

    #[test]
    fn a_plan_that_runs_nothing_ends() {
        let nodes = vec![Node::Repeat {
            count: None,
            body: Some(0),
            next: None,
        }];
        assert_eq!(
            ExecutablePlan {
                nodes,
                start: Some(0)
            }
            .first(),
            NextStep::Done
        );
        assert_eq!(
            walk(&ExecutablePlan::once(3), "done", CommandEndKind::Finish, 9),
            [3]
        );
    }

    /// Plan with two branches: command 1 twice, and command 2; then command 3. (M11.6)
    fn two_strands() -> ExecutablePlan {
        let nodes = vec![
            Node::Parallel {
                branches: vec![Some(2), Some(4)],
                then: Some(5),
            },
            Node::Join,
            run(1, Some(3)),
            run(1, Some(1)),
            run(2, Some(1)),
            run(3, None),
        ];
        ExecutablePlan {
            nodes,
            start: Some(0),
        }
    }

    #[test]
    fn strands_begin_at_once_and_join() {
        let plan = two_strands();
        let NextStep::Parallel { at, branches } = plan.first() else {
            panic!("it splits");
        };
        let begins = branches.iter().map(|branch| match branch {
            NextStep::Run(cursor) => plan.command(cursor),
            other => panic!("{other:?}"),
        });
        assert_eq!(begins.collect::<Vec<_>>(), [1, 2]);
        let NextStep::Run(second) = &branches[1] else {
            panic!("it runs");
        };
        let done = Some(("done", CommandEndKind::Finish));
        assert_eq!(plan.next_after(second, done), NextStep::Joined);
        let NextStep::Run(then) = plan.after_join(&at) else {
            panic!("it goes on");
        };
        assert_eq!(plan.command(&then), 3);
        assert_eq!(plan.next_after(&then, done), NextStep::Done);
    }

    #[test]
    fn strands_without_steps_are_passed() {
        let nodes = vec![
            Node::Parallel {
                branches: vec![Some(1), Some(1)],
                then: Some(2),
            },
            Node::Join,
            run(3, None),
        ];
        let plan = ExecutablePlan {
            nodes,
            start: Some(0),
        };
        assert_eq!(walk(&plan, "done", CommandEndKind::Finish, 5), [3]);
    }
}
