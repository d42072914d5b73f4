//! Bounded work of one cycle.

/// Maximum work of a cycle of a motion. Less work never breaks a limit: the arm follows the plan that it has, brakes on
/// its path if no new plan is ready, and takes over later or more slowly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WorkBudget {
    /// Number of nodes (places of the path with derivatives) while the arm moves along the path.
    pub nodes: usize,
    /// Number of nodes in the first cycles of a takeover that is prepared while the arm follows its previous motion.
    pub nodes_at_takeover: usize,
    /// Number of samples at which time laws are verified.
    pub samples: usize,
    /// Number of set-points of a takeover within the bounds of the tool that are verified, with one inverse kinematics
    /// each.
    pub set_points: usize,
}

impl Default for WorkBudget {
    /// Returns the budget for a desktop processor: at most 200 µs per cycle.
    fn default() -> Self {
        Self {
            nodes: 16,
            nodes_at_takeover: 32,
            samples: 400,
            set_points: 80,
        }
    }
}
