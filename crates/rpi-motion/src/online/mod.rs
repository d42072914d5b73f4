//! Online trajectory generator: time-optimal motion of one or more axes from any state to any state.
//!
//! [`OnlineMotion::to_position`] plans a motion to a target position with velocity and acceleration,
//! [`OnlineMotion::to_velocity`] a motion to a target velocity. Velocity, acceleration and jerk stay within
//! [`AxisLimits`], which may differ by direction. A plan needs no allocation and a bounded number of steps, and cannot
//! fail once the request has been checked.
//!
//! The method: of all motions of one axis with a duration T, one travels farthest and one nearest. Both have three to
//! seven phases of maximum jerk, hold or cruise, and are known in closed form for every T (`family`, `pieces`,
//! `lines`). The limits
//! are convex, so a target position can be reached in T exactly if it lies between both travels. This gives
//!
//! - the time-optimal motion: the first T at which one of both reaches the target. The travel is piecewise monotone, and
//!   the limits of the pieces and their extrema are closed forms, so a bracketed search finds every root (`root`);
//! - the durations that are possible at all, for the synchronisation of axes and for a minimum duration;
//! - a motion of exactly the duration T, if need be as the weighted mean of both (`timed`).
//!
//! Sources: Kröger, On-Line Trajectory Generation in Robotic Systems, 2010 (Reflexxes); Berscheid and Kröger, Jerk-limited
//! Real-time Trajectory Generation with Arbitrary Target States, RSS 2021 (Ruckig): problem, return into the limits,
//! synchronisation; Pontryagin et al., The Mathematical Theory of Optimal Processes, 1962: structure of extremal motions.

mod axis;
mod brake;
mod family;
mod limits;
mod lines;
mod motion;
mod pieces;
mod profile;
mod root;
mod straight;
mod timed;
mod velocity;
mod velocity_axis;

pub use limits::{AxisLimits, OnlineError, OnlineErrorKind};
pub use motion::{MotionOptions, OnlineMotion, Synchronization};
pub use profile::{AxisProfile, PositionExtrema};
