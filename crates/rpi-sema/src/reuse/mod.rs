//! Reuse of the results of an earlier check of the same program, for incremental checking.

mod environment;
mod item_hash;
mod memo;
mod unit_memo;
mod versions;

pub(crate) use environment::words_of_statics;
pub use item_hash::ItemHash;
pub use memo::Memo;
pub use unit_memo::UnitMemo;
pub(crate) use unit_memo::{CalledInstance, Effect, StoredUnit};
pub use versions::versions_with_callees;
