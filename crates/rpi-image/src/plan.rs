//! Plan of a task: which command follows which result.
//!
//! A plan is generic over its commands: the compiler identifies a command by its name in the program, the runtime by
//! its index in a list of images.

use alloc::string::String;
use alloc::vec::Vec;

/// Index of the next node of a plan. `None` means that the plan is done.
pub type Target = Option<usize>;

/// Node of the plan of a task: a command, a loop, parallel branches, a jump or the end.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum PlanNode<C> {
    /// Continues with another node.
    Goto(Target),
    /// Entry of a loop: sets the count of this [`PlanNode::Repeat`] to 0 and continues there.
    EnterLoop(usize),
    /// Loop: repeats its body.
    Repeat {
        /// Number of iterations; `None` for an endless loop.
        count: Option<u64>,
        /// First node of the body of the loop.
        body: Target,
        /// Node after the last iteration.
        next: Target,
    },
    /// Parallel branches. The plan continues when all of them have reached their [`PlanNode::Join`].
    Parallel {
        /// First node of each parallel branch.
        branches: Vec<Target>,
        /// Node after the branches.
        then: Target,
    },
    /// End of a parallel branch, which waits for the other branches.
    Join,
    /// Exit from parallel branches because of an error. The other branches are requested to end first.
    CancelBranches {
        /// Node with the parallel branches.
        parallel: usize,
        /// Node after the branches have ended.
        then: Target,
    },
    /// Execution of a command.
    Run {
        /// The command that runs in this step.
        command: C,
        /// Next nodes for named results of the command.
        on_result: Vec<(String, Target)>,
        /// Next node for every other `fail` result; `None` if the task then ends with the error of the command.
        on_fail: Option<Target>,
        /// Next node for every other result; `None` if `on_result` must name all of them.
        default: Option<Target>,
    },
}

impl<C> PlanNode<C> {
    /// Returns the same node with its command replaced by `of(command)`; the targets are unchanged.
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
