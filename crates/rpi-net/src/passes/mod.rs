//! What is found out about a net before it is lowered, one file per question.

pub mod dependencies;
pub mod presence;
pub mod schedule;
pub mod users;

pub use dependencies::{Dependence, Dependencies, Item, Reader};
pub use presence::{Presences, Sureness, View};
pub use schedule::Schedule;
pub use users::Users;
