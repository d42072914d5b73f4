//! What the tests share: the allocation trap, the data beside the project, small helpers.
//!
//! Only tests depend on this crate, and it depends on none of ours: any crate can use it without
//! a ring in the dependencies.

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
