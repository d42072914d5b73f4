//! From a file name to findings, nets and an image: the pipeline that the tools share.
//!
//! [`read`] opens a file, [`compile`] takes it as far as its kind and its faults allow, [`lower_to_run`] and [`lower_to_look`] lower
//! one of its commands. [`inspect`] does the same for an editor, which asks for more than findings. This crate knows files and the order of the stages; it must not know what any of them finds, nor
//! what a command does once it runs.

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
