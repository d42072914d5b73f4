//! Shared test support: the allocation trap, external test data, small helpers.
//!
//! Only tests depend on this crate, and it depends on no other crate of the workspace. Any crate can therefore use it
//! without a dependency cycle.

mod alloc;
mod expected_output;
mod external_data;
mod gzip;
mod lsp;
mod nets;
mod process;
mod workspace;

pub use alloc::{AllocDisabler, TrappedAllocator, alloc_allowed, no_alloc};
pub use expected_output::{compare_tool_output, compare_with_expected};
pub use external_data::{external_data_dir, external_data_path, report_skip};
pub use gzip::{gzip, read_maybe_gz};
pub use lsp::LspClient;
pub use nets::net_of_additions;
pub use process::{resident_memory_kb, run_test_in_process};
pub use workspace::{files_below, workspace_root};
