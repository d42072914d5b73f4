//! Compiler pipeline shared by the tools: from a file name to diagnostics, nets and an image.
//!
//! [`read`] opens a file, [`compile`] compiles it as far as its kind and its errors allow, [`lower_to_run`] and
//! [`lower_to_look`] lower one of its commands. [`inspect`] compiles for an editor, which needs more than diagnostics.
//! This crate handles files and the order of the stages; it must not depend on the content of diagnostics or on the
//! execution of commands.

mod agreed;
mod compile;
mod doctext;
pub mod emit;
mod faults;
mod files;
mod fixes;
pub mod graph;
pub mod import;
mod input;
mod inspect;
mod machine;
mod marks;
mod modules;
mod node;
mod period;
mod project;
mod source;
mod task;
mod tests;
mod typed;
mod unwanted;
mod violation;

pub use compile::{
    Asked, Compiled, Program, Unset, compile, compile_example, compile_with, lower_for_tick,
    lower_to_look, lower_to_run, lower_with_work,
};
pub use doctext::{doc_blocks, doc_links, examples};
pub use faults::FaultPlace;
pub use files::{Disk, Files};
pub use input::{Input, InputError, Kind, read, unreadable, utf8};
pub use inspect::{Inspected, inspect};
pub use machine::{MACHINE, machine_text, read_machine};
pub use marks::Marks;
pub use modules::{library_modules, library_text};
pub use node::{Node, NodeCompiled, compile_node};
pub use period::{parse_period, period_text};
pub use project::{MANIFEST, Project, files_of};
pub use rpi_sema::elab::Claims;
pub use source::Told;
pub use task::{Task, TaskNode, TaskPlan};
pub use tests::Test;
pub use typed::{Typed, typed};
