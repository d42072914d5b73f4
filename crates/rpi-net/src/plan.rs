//! Which command follows which result: the nodes of a task's plan, over whatever stands for a command there: its name in a
//! program, its place in a list of images where it is run.

/// Where a plan goes on; none: it is done.
pub type Target = Option<usize>;

/// A node of a plan.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Node<C> {
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
        /// Which one.
        command: C,
        /// What follows these results.
        on: Vec<(String, Target)>,
        /// What follows any other `fail`; none: the task ends with its error.
        on_fail: Option<Target>,
        /// What follows any other result; none if the branches must name them all.
        otherwise: Option<Target>,
    },
}

impl<C> Node<C> {
    /// The same node over what `of` makes of its command.
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
