//! Motion of an arm along a path, such that a takeover at any moment keeps every limit of its axes.
//!
//! The set-point at time t is `q(t) = q_path(s(t)) + r(t)`:
//!
//! - [`path`]: `q_path(s)` is the inverse kinematics along a geometric path with the parameter `s`;
//! - [`time_law`]: `s(t)` is a jerk-limited time law;
//! - [`residual`]: `r(t)` is what the arm had at the takeover and the path does not have (position, velocity and
//!   acceleration of each axis). It decays under its own bounds.
//!
//! In every cycle the core holds a *held brake*: a way to rest of `s` on the path, together with the rest of `r`, that
//! [`verify`] has checked against position, velocity, acceleration and jerk of every axis. A new plan replaces it only
//! after its own brake has been verified. So a plan may be greedy, late or missing: no set-point is ever commanded that
//! was not verified. To pause or to cancel means to make no new plan.
//!
//! [`MotionCore`] allocates when it is created. Afterwards nothing allocates or panics, and the work of each cycle is
//! counted and bounded ([`WorkBudget`]), but for the set-points of the previous motion, at most 48 in the cycle that plans
//! a takeover within the bounds of the tool.
//!
//! Sources: Lange and Suppa, Trajectory generation for immediate path-accurate jerk-limited stopping of industrial
//! robots, ICRA 2015; Biagiotti and Melchiorri, Trajectory Planning for Automatic Machines and Robots, 2008; Pham and
//! Pham, A new approach to time-optimal path parameterization based on reachability analysis, T-RO 2018.
#![no_std]

extern crate alloc;

pub mod arm;
pub mod arm_angle;
pub mod check;
pub mod chunk;
mod course;
pub mod curve_bound;
mod entry;
mod held_axis;
pub mod joint_motion;
pub mod joint_path;
pub mod joint_tracker;
pub mod motion_core;
pub mod node;
pub mod node_table;
pub mod online;
pub mod passage;
pub mod path;
pub mod path_error;
pub mod path_start;
mod plan;
pub mod ranges;
pub mod residual;
pub mod set_point;
pub mod speed_limit;
pub mod stop_margin;
mod third_derivative;
pub mod time_law;
mod tool_entry;
mod tool_residual;
mod tool_trace;
pub mod verify;
mod window;
pub mod work_budget;

pub use arm::{Arm, JointState};
pub use check::{PathReport, check_path, scan_path};
pub use joint_motion::{JointGoal, JointMotion, JointSetPoint};
pub use joint_tracker::{BackwardDifferences, JointTracker, TrackedSetPoint};
pub use motion_core::MotionCore;
pub use passage::time_of_passage;
pub use path::Path;
pub use path_error::{PathError, PathErrorKind};
pub use path_start::path_start;
pub use set_point::{Controls, EntryPreference, MotionError, SetPoint};
pub use speed_limit::{SpeedBound, SpeedLimit};
pub use work_budget::WorkBudget;

/// Values of all axes, such as positions in rad (m for a prismatic joint); entries beyond the axes of the arm are 0.
pub type Joints = [f64; rpi_kin::MAX_AXES];
