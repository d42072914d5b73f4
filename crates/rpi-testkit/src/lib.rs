//! Shared test support: the allocation trap, external test data, small helpers.
//!
//! Only tests depend on this crate, and it depends on no other crate of the workspace. Any crate can therefore use it
//! without a dependency cycle.

mod alloc;
mod gz;
mod lsp;
mod messages;
mod process;
mod shared;
mod workspace;

pub use alloc::{AllocDisabler, Memory, alloc_allowed, no_alloc};
pub use gz::read_maybe_gz;
pub use lsp::LspClient;
pub use messages::{differs, tool_differs};
pub use process::{own_process, resident};
pub use shared::{report_skip, shared_dir, shared_path};
pub use workspace::{files_below, workspace_root};
