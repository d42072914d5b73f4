//! Task plans: a graph that says which command follows which result. It is generic over the reference to a command: a
//! name in a program, or an index into a list of images at run time.

/// Index of the next plan node; `None` ends the plan.
pub type Target = Option<usize>;

/// Node of a task plan.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Node<C> {
    /// Continues at the target.
    Pass(Target),
    /// Enters a loop: resets the counter of this [`Node::Repeat`] to 0 and continues there.
    Enter(usize),
    /// Loop that runs its body a number of times, then continues.
    Repeat {
        /// Number of iterations; `None` repeats for ever.
        times: Option<u64>,
        /// First node of the body.
        body: Target,
        /// Next node after the last iteration.
        then: Target,
    },
    /// Runs several branches at once. Continues when each branch has reached its [`Node::Join`].
    Parallel {
        /// First node of each branch.
        strands: Vec<Target>,
        /// Next node after all branches have joined.
        then: Target,
    },
    /// End of a parallel branch, which waits for the other branches.
    Join,
    /// Exit from parallel branches because of an error: cancels the other branches, then continues.
    Leave {
        /// Index of the [`Node::Parallel`] that is left.
        parallel: usize,
        /// Next node after the exit.
        then: Target,
    },
    /// Runs a command.
    Run {
        /// Command to run.
        command: C,
        /// Next node for each named result.
        on: Vec<(String, Target)>,
        /// Next node for any other `fail` result; `None` ends the task with the command's error.
        on_fail: Option<Target>,
        /// Next node for any other result; `None` if the branches must name all results.
        otherwise: Option<Target>,
    },
}

impl<C> Node<C> {
    /// Returns the same node with its command converted by `of`.
    #[must_use]
    pub fn map<D>(&self, of: impl FnOnce(&C) -> D) -> Node<D> {
        match self {
            &Node::Pass(then) => Node::Pass(then),
            &Node::Enter(repeat) => Node::Enter(repeat),
            &Node::Repeat { times, body, then } => Node::Repeat { times, body, then },
            Node::Parallel { strands, then } => Node::Parallel {
                strands: strands.clone(),
                then: *then,
            },
            Node::Join => Node::Join,
            &Node::Leave { parallel, then } => Node::Leave { parallel, then },
            Node::Run {
                command,
                on,
                on_fail,
                otherwise,
            } => Node::Run {
                command: of(command),
                on: on.clone(),
                on_fail: *on_fail,
                otherwise: *otherwise,
            },
        }
    }
}
