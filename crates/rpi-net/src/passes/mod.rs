//! Analyses and checks of a net before lowering, one file per pass.
//!
//! [`PASSES`] lists them in the order in which they run; [`analyse`] runs them.

mod analysis;
mod cancellation;
pub mod causality;
mod clocks;
mod conjunction;
mod dead_state;
pub mod dependencies;
pub mod dependency_cycles;
mod fact_prover;
mod fault_analysis;
pub mod hoist;
pub mod mark_live;
mod model_check;
pub mod presence;
pub mod schedule;
mod setpoint_coverage;
mod termination;
pub mod unused_flows;
pub mod users;
pub mod verify;
pub mod work;
pub mod writers;

pub use crate::fragment_tree::Item;
pub use analysis::{Analysis, PASSES, Pass, analyse, analyse_unless_cyclic, has_dependency_cycle};
pub use cancellation::is_cancel_ignored;
pub use conjunction::Conjunction;
pub use dependencies::{Dependencies, Dependency, Reader};
pub use fault_analysis::{FaultKind, PossibleFault, possible_faults, unguarded_operations};
pub use presence::{FlowPresence, Presences, View};
pub use schedule::Schedule;
pub use termination::{is_endless, is_unreachable};
pub use users::Readers;
pub use work::{MachineProfile, WorkBounds, over_budget};
pub use writers::{Resource, WriterPair, Writers};
