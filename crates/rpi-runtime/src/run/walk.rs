//! Positions in the plan of a task and the steps between them.

use rpi_image::Image;
use rpi_image::image::{End, EndKind};

use super::plan::{Node, Plan};
use rpi_image::plan::Target;

/// A position in a plan: a node and the iteration count of each repetition.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct Cursor {
    node: usize,
    counts: Vec<u64>,
}

/// Next step of a plan.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) enum Place {
    /// Run a command.
    Run(Cursor),
    /// Run several branches in parallel.
    Split {
        /// Node with the branches.
        at: Cursor,
        /// First place of each branch; [`Place::Joined`] for an empty branch.
        strands: Vec<Place>,
    },
    /// The branch has ended and waits for the join.
    Joined,
    /// The parallel branches are left because of an error.
    Left(Exit),
    /// The task has finished.
    Done,
    /// The task ends with the error.
    Error,
}

/// Target of an error that leaves parallel branches.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Exit {
    /// The task ends with the error.
    Error,
    /// The branches of the node with this index end, and the plan continues at the target.
    To(usize, Target),
}

/// Results (by index) of a command that lead to a place.
#[derive(Clone, PartialEq, Eq, Default, Debug)]
pub(super) struct By {
    /// Results without an error.
    pub(super) regular: Vec<u32>,
    /// Results with an error.
    pub(super) fails: Vec<u32>,
}

impl Plan {
    /// Returns the first place of the plan.
    pub(super) fn first(&self) -> Place {
        self.from(self.start, vec![0; self.nodes.len()])
    }

    /// Returns the command at a position.
    pub(super) fn command(&self, cursor: &Cursor) -> usize {
        match &self.nodes[cursor.node] {
            Node::Run { command, .. } => *command,
            _ => 0,
        }
    }

    /// Returns the place that follows when the command ends with the given result; `None` stands for an end by its
    /// port.
    pub(super) fn after(&self, cursor: &Cursor, result: Option<(&str, EndKind)>) -> Place {
        let Node::Run {
            on,
            on_fail,
            otherwise,
            ..
        } = &self.nodes[cursor.node]
        else {
            return Place::Done;
        };
        let named = result.and_then(|(name, _)| on.iter().find(|(own, _)| own == name));
        let fails = result.is_some_and(|(_, kind)| kind == EndKind::Fail);
        let other = if fails {
            *on_fail
        } else {
            Some(otherwise.unwrap_or(None))
        };
        match named.map(|(_, target)| *target).or(other) {
            Some(target) => self.from(target, cursor.counts.clone()),
            None => Place::Error,
        }
    }

    /// Returns the place that follows once all branches of a parallel node have ended.
    pub(super) fn behind(&self, split: &Cursor) -> Place {
        match &self.nodes[split.node] {
            Node::Parallel { then, .. } => self.from(*then, split.counts.clone()),
            _ => Place::Done,
        }
    }

    /// Returns the place at which the plan continues after the branches were left through this exit; `None` if the exit
    /// belongs to an outer node.
    pub(super) fn out_of(&self, split: &Cursor, exit: Exit) -> Option<Place> {
        match exit {
            Exit::To(node, then) if node == split.node => {
                Some(self.from(then, split.counts.clone()))
            }
            _ => None,
        }
    }

    /// Returns all possible next places of a command with the results that lead there.
    pub(super) fn ways(&self, cursor: &Cursor, image: &Image) -> Vec<(Place, By)> {
        let results = match &image.end {
            End::Results(results) => results.as_slice(),
            End::Ports { .. } => return vec![(self.after(cursor, None), By::default())],
        };
        let mut all: Vec<(Place, By)> = Vec::new();
        for (k, result) in (0u32..).zip(results) {
            let place = self.after(cursor, Some((&result.name, result.kind)));
            let known = all.iter().position(|(known, _)| *known == place);
            let at = known.unwrap_or_else(|| {
                all.push((place, By::default()));
                all.len() - 1
            });
            match result.kind {
                EndKind::Fail => all[at].1.fails.push(k),
                EndKind::Finish | EndKind::Yield => all[at].1.regular.push(k),
            }
        }
        all
    }

    /// Returns the next command or parallel node, starting at a target.
    fn from(&self, from: Target, mut counts: Vec<u64>) -> Place {
        let mut at = from;
        // Repetitions of which an empty iteration was found. All further iterations of them are empty as well.
        let mut looked_through = vec![false; self.nodes.len()];
        // The bound ends the search in plans with a cycle of nodes that run no command.
        for _ in 0..=2 * self.nodes.len() {
            let Some(node) = at else { return Place::Done };
            at = match self.nodes.get(node) {
                None => return Place::Done,
                Some(Node::Run { .. }) => return Place::Run(Cursor { node, counts }),
                Some(Node::Join) => return Place::Joined,
                Some(Node::Leave { parallel, then }) => {
                    return Place::Left(Exit::To(*parallel, *then));
                }
                Some(Node::Parallel { strands, then }) => {
                    let begin = |strand: &Target| self.from(*strand, counts.clone());
                    let strands: Vec<Place> = strands.iter().map(begin).collect();
                    if strands.iter().any(|strand| *strand != Place::Joined) {
                        let at = Cursor { node, counts };
                        return Place::Split { at, strands };
                    }
                    *then
                }
                Some(Node::Pass(then)) => *then,
                Some(Node::Enter(repeat)) => {
                    counts[*repeat] = 0;
                    Some(*repeat)
                }
                Some(Node::Repeat { times, body, then }) => {
                    let is_known = std::mem::replace(&mut looked_through[node], true);
                    if is_known && times.is_none() {
                        return Place::Done;
                    }
                    let again = !is_known && times.is_none_or(|times| counts[node] < times);
                    // Endless repetitions are not counted, so that equal positions compare equal.
                    counts[node] += u64::from(again && times.is_some());
                    if again { *body } else { *then }
                }
            };
        }
        Place::Done
    }
}

#[cfg(test)]
mod tests {
    use super::super::plan::Node;
    use super::*;

    fn run(command: usize, then: Target) -> Node {
        Node::Run {
            command,
            on: vec![("back".into(), Some(0))],
            on_fail: None,
            otherwise: Some(then),
        }
    }

    /// Returns the commands that run if each of them ends with `result`.
    fn walk(plan: &Plan, result: &str, kind: EndKind, most: usize) -> Vec<usize> {
        let mut all = Vec::new();
        let mut at = plan.first();
        while let Place::Run(cursor) = at {
            if all.len() == most {
                break;
            }
            all.push(plan.command(&cursor));
            at = plan.after(&cursor, Some((result, kind)));
        }
        all
    }

    /// Plan: `repeat 2 times let repeat 2 times let 1 tel; 2 tel`
    fn nested() -> Plan {
        let repeat = |times, body, then| Node::Repeat {
            times,
            body: Some(body),
            then,
        };
        Plan {
            nodes: vec![
                Node::Enter(1),
                repeat(Some(2), 2, None),
                Node::Enter(3),
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
            walk(&nested(), "done", EndKind::Finish, 99),
            [1, 1, 2, 1, 1, 2]
        );
    }

    /// M11.4: a branch on a result is taken, and an unhandled `fail` ends the task.
    #[test]
    fn branches_are_taken_and_a_fail_ends_it() {
        assert_eq!(walk(&nested(), "back", EndKind::Finish, 4), [1, 1, 1, 1]);
        assert_eq!(walk(&nested(), "broken", EndKind::Fail, 4), [1]);
        let Place::Run(first) = nested().first() else {
            panic!("it begins");
        };
        assert_eq!(
            nested().after(&first, Some(("broken", EndKind::Fail))),
            Place::Error
        );
    }

    #[test]
    fn for_ever_comes_to_the_same_place_again() {
        let nodes = vec![
            Node::Enter(1),
            Node::Repeat {
                times: None,
                body: Some(2),
                then: None,
            },
            run(7, Some(1)),
        ];
        let plan = Plan {
            nodes,
            start: Some(0),
        };
        assert_eq!(walk(&plan, "done", EndKind::Finish, 5), [7; 5]);
        let Place::Run(first) = plan.first() else {
            panic!("it begins");
        };
        assert_eq!(plan.after(&first, None), Place::Run(first));
    }

    #[test]
    fn a_plan_that_runs_nothing_ends() {
        let nodes = vec![Node::Repeat {
            times: None,
            body: Some(0),
            then: None,
        }];
        assert_eq!(
            Plan {
                nodes,
                start: Some(0)
            }
            .first(),
            Place::Done
        );
        assert_eq!(walk(&Plan::once(3), "done", EndKind::Finish, 9), [3]);
    }

    /// Plan with two branches: command 1 twice, and command 2; then command 3. (M11.6)
    fn two_strands() -> Plan {
        let nodes = vec![
            Node::Parallel {
                strands: vec![Some(2), Some(4)],
                then: Some(5),
            },
            Node::Join,
            run(1, Some(3)),
            run(1, Some(1)),
            run(2, Some(1)),
            run(3, None),
        ];
        Plan {
            nodes,
            start: Some(0),
        }
    }

    #[test]
    fn strands_begin_at_once_and_join() {
        let plan = two_strands();
        let Place::Split { at, strands } = plan.first() else {
            panic!("it splits");
        };
        let begins = strands.iter().map(|strand| match strand {
            Place::Run(cursor) => plan.command(cursor),
            other => panic!("{other:?}"),
        });
        assert_eq!(begins.collect::<Vec<_>>(), [1, 2]);
        let Place::Run(second) = &strands[1] else {
            panic!("it runs");
        };
        let done = Some(("done", EndKind::Finish));
        assert_eq!(plan.after(second, done), Place::Joined);
        let Place::Run(then) = plan.behind(&at) else {
            panic!("it goes on");
        };
        assert_eq!(plan.command(&then), 3);
        assert_eq!(plan.after(&then, done), Place::Done);
    }

    #[test]
    fn strands_without_steps_are_passed() {
        let nodes = vec![
            Node::Parallel {
                strands: vec![Some(1), Some(1)],
                then: Some(2),
            },
            Node::Join,
            run(3, None),
        ];
        let plan = Plan {
            nodes,
            start: Some(0),
        };
        assert_eq!(walk(&plan, "done", EndKind::Finish, 5), [3]);
    }
}
