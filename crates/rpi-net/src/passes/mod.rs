//! What is found out about a net before it is lowered, one file per question.
//!
//! [`PASSES`] lists them in the order in which they run; [`analyse`] runs them.

mod analysis;
pub mod causality;
pub mod dependencies;
pub mod hoist;
pub mod presence;
mod rings;
pub mod schedule;
pub mod users;
pub mod verify;

pub use crate::tree::Item;
pub use analysis::{Analysis, PASSES, Pass, analyse};
pub use dependencies::{Dependence, Dependencies, Reader};
pub use presence::{Presences, Sureness, View};
pub use schedule::Schedule;
pub use users::Users;
