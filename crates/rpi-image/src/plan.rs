//! Plan of a task: which command follows which result.
//!
//! A plan is generic over its commands: the compiler identifies a command by its name in the program, the runtime by
//! its index in a list of images.

use alloc::string::String;
use alloc::vec::Vec;

use crate::encode_enum;

/// Index of the node of a plan that is executed next. `None` is the end of the plan.
pub type Target = Option<usize>;

/// Node of the plan of a task. `C` identifies a command: by name in the compiler, by index in the runtime.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum PlanNode<C> {
    /// Jump: the plan continues with the given node.
    Goto(Target),
    /// Entry of a loop: sets the iteration count of the [`PlanNode::Repeat`] with this index to 0 and continues with
    /// that node.
    EnterLoop(usize),
    /// Head of a loop. The plan comes back here after each iteration of the body.
    Repeat {
        /// Number of iterations; `None` for an endless loop.
        count: Option<u64>,
        /// First node of the body of the loop, which is executed in each iteration.
        body: Target,
        /// Node after the last iteration.
        next: Target,
    },
    /// Start of parallel branches. The plan continues after they have all reached their [`PlanNode::Join`].
    Parallel {
        /// First node of each of the parallel branches.
        branches: Vec<Target>,
        /// Node that follows when all branches have ended.
        then: Target,
    },
    /// End of a parallel branch, which waits for the other branches.
    Join,
    /// Exit from parallel branches because of an error in one of them. The plan requests the other branches to end, and
    /// waits for them.
    CancelBranches {
        /// Index in the plan of the [`PlanNode::Parallel`] that started the branches.
        parallel: usize,
        /// Node that follows when all branches have ended.
        then: Target,
    },
    /// Execution of a command. The result of the command selects the next node.
    Run {
        /// Command that this node executes.
        command: C,
        /// Next node for each result that the task handles by name: pairs of the name of the result and the node.
        on_result: Vec<(String, Target)>,
        /// Next node for a `fail` result without an entry in `on_result`; `None` if such a result ends the task with an
        /// error.
        on_fail: Option<Target>,
        /// Next node for any other result without an entry in `on_result`; `None` if `on_result` names all of them.
        default: Option<Target>,
    },
}

impl<C> PlanNode<C> {
    /// Returns the same node with its command replaced by `of(command)`; the indices of the next nodes are unchanged.
    #[must_use]
    pub fn map<D>(&self, of: impl FnOnce(&C) -> D) -> PlanNode<D> {
        match self {
            &PlanNode::Goto(then) => PlanNode::Goto(then),
            &PlanNode::EnterLoop(repeat) => PlanNode::EnterLoop(repeat),
            &PlanNode::Repeat {
                count: times,
                body,
                next: then,
            } => PlanNode::Repeat {
                count: times,
                body,
                next: then,
            },
            PlanNode::Parallel {
                branches: strands,
                then,
            } => PlanNode::Parallel {
                branches: strands.clone(),
                then: *then,
            },
            PlanNode::Join => PlanNode::Join,
            &PlanNode::CancelBranches { parallel, then } => {
                PlanNode::CancelBranches { parallel, then }
            }
            PlanNode::Run {
                command,
                on_result: on,
                on_fail,
                default: otherwise,
            } => PlanNode::Run {
                command: of(command),
                on_result: on.clone(),
                on_fail: *on_fail,
                default: *otherwise,
            },
        }
    }
}

/// Node of a plan in which commands are indices into a list of images.
pub type IndexedNode = PlanNode<usize>;

encode_enum!(IndexedNode {
    0 = Goto(then),
    1 = EnterLoop(repeat),
    2 = Repeat { count, body, next },
    3 = Parallel { branches, then },
    4 = Join,
    5 = CancelBranches { parallel, then },
    6 = Run { command, on_result, on_fail, default },
});
