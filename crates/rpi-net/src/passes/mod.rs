//! Analyses and checks of a net before lowering, one file per pass.
//!
//! [`PASSES`] lists them in the order in which they run; [`analyse`] runs them.

mod analysis;
pub mod causality;
mod clocks;
mod conjunction;
pub mod dependencies;
mod ends;
mod faults;
pub mod hoist;
mod idle;
pub mod live;
mod overlap;
pub mod presence;
mod proof;
pub mod rings;
pub mod schedule;
mod setpoints;
pub mod users;
pub mod verify;
pub mod work;
pub mod writers;

pub use crate::tree::Item;
pub use analysis::{Analysis, PASSES, Pass, analyse, analyse_unless_ring, has_ring};
pub use conjunction::Conjunction;
pub use dependencies::{Dependence, Dependencies, Reader};
pub use ends::{is_endless, is_unreachable};
pub use faults::{CanFault, FaultKind, can_fault};
pub use presence::{Presences, Sureness, View};
pub use schedule::Schedule;
pub use users::Users;
pub use work::{Machine, Work, over_budget};
pub use writers::{Pair, Resource, Writers};
