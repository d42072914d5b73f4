//! Plan of a task: which command follows which result.
//!
//! A plan is generic over its commands: the compiler identifies a command by its name in the program, the runtime by
//! its index in a list of images.

use alloc::string::String;
use alloc::vec::Vec;

/// Index of the next node of a plan. `None` means that the plan is done.
pub type Target = Option<usize>;

/// Node of a plan.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Node<C> {
    /// Continues with another node.
    Pass(Target),
    /// Entry of a loop: sets the count of this [`Node::Repeat`] to 0 and continues there.
    Enter(usize),
    /// Loop.
    Repeat {
        /// Number of iterations; `None` for an endless loop.
        times: Option<u64>,
        /// First node of the body.
        body: Target,
        /// Node after the last iteration.
        then: Target,
    },
    /// Parallel branches. The plan continues when all of them have reached their [`Node::Join`].
    Parallel {
        /// First node of each branch.
        strands: Vec<Target>,
        /// Node after the branches.
        then: Target,
    },
    /// End of a parallel branch, which waits for the other branches.
    Join,
    /// Exit from parallel branches because of an error. The other branches are requested to end first.
    Leave {
        /// Node with the parallel branches.
        parallel: usize,
        /// Node after the branches have ended.
        then: Target,
    },
    /// Execution of a command.
    Run {
        /// The command.
        command: C,
        /// Successors of named results.
        on: Vec<(String, Target)>,
        /// Successor of every other `fail` result; `None` if the task then ends with the error of the command.
        on_fail: Option<Target>,
        /// Successor of every other result; `None` if `on` must name all of them.
        otherwise: Option<Target>,
    },
}

impl<C> Node<C> {
    /// Returns the node with its command replaced by the result of `of`.
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
