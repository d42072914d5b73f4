//! Which command follows which result: the plan of a task, and where one stands in it.

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

/// A place in a plan: a command, and how often each repetition was gone through.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct Cursor {
    node: usize,
    counts: Vec<u64>,
}

/// What follows an end.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) enum After {
    /// This.
    Run(Cursor),
    /// The task is done.
    Done,
    /// The task ends with the error.
    Error,
}

/// A command that may follow, with the results (by index) that it follows.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct Successor {
    pub(super) cursor: Cursor,
    /// Results without an error.
    pub(super) regular: Vec<u32>,
    /// Results with one.
    pub(super) fails: Vec<u32>,
}

/// Nodes that are passed in search of the next command; a plan that passes more runs nothing.
const LONGEST: usize = 10_000;

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

    pub(super) fn first(&self) -> Option<Cursor> {
        self.next_run(self.start, vec![0; self.nodes.len()])
    }

    /// The command at a place.
    pub(super) fn command(&self, cursor: &Cursor) -> usize {
        match &self.nodes[cursor.node] {
            Node::Run { command, .. } => *command,
            _ => 0,
        }
    }

    /// What follows when the command at a place ends by the result of this name; without one, by its port.
    pub(super) fn after(&self, cursor: &Cursor, result: Option<(&str, EndKind)>) -> After {
        let Node::Run {
            on,
            on_fail,
            otherwise,
            ..
        } = &self.nodes[cursor.node]
        else {
            return After::Done;
        };
        let named = result.and_then(|(name, _)| on.iter().find(|(own, _)| own == name));
        let fails = result.is_some_and(|(_, kind)| kind == EndKind::Fail);
        let other = if fails {
            *on_fail
        } else {
            Some(otherwise.unwrap_or(None))
        };
        let Some(target) = named.map(|(_, target)| *target).or(other) else {
            return After::Error;
        };
        self.next_run(target, cursor.counts.clone())
            .map_or(After::Done, After::Run)
    }

    /// All that may follow the command at a place; results that lead to one place share a successor.
    pub(super) fn successors(&self, cursor: &Cursor, image: &Image) -> Vec<Successor> {
        let results = match &image.end {
            End::Results(results) => results.as_slice(),
            End::Ports { .. } => return self.only(cursor),
        };
        let mut all: Vec<Successor> = Vec::new();
        for (k, result) in (0u32..).zip(results) {
            let After::Run(next) = self.after(cursor, Some((&result.name, result.kind))) else {
                continue;
            };
            let at = all
                .iter()
                .position(|s| s.cursor == next)
                .unwrap_or_else(|| {
                    all.push(Successor {
                        cursor: next,
                        regular: Vec::new(),
                        fails: Vec::new(),
                    });
                    all.len() - 1
                });
            match result.kind {
                EndKind::Fail => all[at].fails.push(k),
                EndKind::Finish | EndKind::Yield => all[at].regular.push(k),
            }
        }
        all
    }

    /// What follows a command that has no named results: one thing, or nothing.
    fn only(&self, cursor: &Cursor) -> Vec<Successor> {
        let After::Run(next) = self.after(cursor, None) else {
            return Vec::new();
        };
        vec![Successor {
            cursor: next,
            regular: Vec::new(),
            fails: Vec::new(),
        }]
    }

    /// The next command from here on.
    fn next_run(&self, from: Target, mut counts: Vec<u64>) -> Option<Cursor> {
        let mut at = from;
        for _ in 0..LONGEST {
            let node = at?;
            at = match self.nodes.get(node)? {
                Node::Run { .. } => return Some(Cursor { node, counts }),
                Node::Pass(then) => *then,
                Node::Enter(repeat) => {
                    counts[*repeat] = 0;
                    Some(*repeat)
                }
                Node::Repeat { times, body, then } => {
                    let again = times.is_none_or(|times| counts[node] < times);
                    // Without a number nothing is counted: the same place comes again.
                    counts[node] += u64::from(again && times.is_some());
                    if again { *body } else { *then }
                }
            };
        }
        None
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

#[cfg(test)]
mod tests {
    use super::*;

    fn run(command: usize, then: Target) -> Node {
        Node::Run {
            command,
            on: vec![("back".into(), Some(0))],
            on_fail: None,
            otherwise: Some(then),
        }
    }

    /// The commands that run if each ends by `result`.
    fn walk(plan: &Plan, result: &str, kind: EndKind, most: usize) -> Vec<usize> {
        let mut all = Vec::new();
        let mut at = plan.first();
        while let Some(cursor) = at.filter(|_| all.len() < most) {
            all.push(plan.command(&cursor));
            at = match plan.after(&cursor, Some((result, kind))) {
                After::Run(next) => Some(next),
                After::Done | After::Error => None,
            };
        }
        all
    }

    /// `repeat 2 times let repeat 2 times let 1 tel; 2 tel`
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

    /// M11.4.
    #[test]
    fn branches_are_taken_and_a_fail_ends_it() {
        assert_eq!(walk(&nested(), "back", EndKind::Finish, 4), [1, 1, 1, 1]);
        assert_eq!(walk(&nested(), "broken", EndKind::Fail, 4), [1]);
        let first = nested().first().unwrap();
        assert_eq!(
            nested().after(&first, Some(("broken", EndKind::Fail))),
            After::Error
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
        let first = plan.first().unwrap();
        assert_eq!(plan.after(&first, None), After::Run(first));
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
            None
        );
        assert_eq!(walk(&Plan::once(3), "done", EndKind::Finish, 9), [3]);
    }
}
