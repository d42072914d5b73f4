//! Compiler pipeline shared by the tools: from a file name to diagnostics, nets and an image.
//!
//! [`read`] opens a file, [`compile`] compiles it as far as its kind and its errors allow, [`lower_for_execution`] and
//! [`lower_for_observation`] lower one of its commands. [`inspect`] compiles for an editor, which needs more than diagnostics.
//! This crate handles files and the order of the stages; it must not depend on the content of diagnostics or on the
//! execution of commands.
//!
//! Each stage has a type that states what has been established:
//!
//! | stage | type | established |
//! |---|---|---|
//! | parsing | `Modules` | the syntax trees of all modules |
//! | checks | [`CheckedProgram`](rpi_sema::CheckedProgram) | types and units of every callable |
//! | facts | `AnalysedProgram` | clocks and presence of flows; units without errors |
//! | elaboration | [`ElaboratedUnit`](rpi_sema::elab::ElaboratedUnit) | a net, not yet analysed |
//! | passes | [`AnalysedNet`] | a net with an order of evaluation, without errors |
//! | lowering | [`Image`](rpi_image::Image) | an image |
//!
//! A net is elaborated and analysed once. A command with claims has another net for execution if the options leave the
//! claims out or make them faults; it is analysed once as well.

mod analysed_net;
mod analysis_summary;
mod cancel_fix;
mod cell;
mod compile;
mod coverage_points;
mod doctext;
mod duration;
pub mod emit;
mod external;
mod faults;
mod file_loader;
mod file_parser;
mod fixes;
pub mod graph;
pub mod import;
mod input;
mod inspect;
mod instance_diagnostics;
mod library;
mod lowering;
mod machine;
mod modules;
mod node;
mod parted_file;
mod points;
mod points_text;
mod program;
mod program_memo;
mod program_tests;
mod project;
mod roots;
mod session;
mod task;
mod typed_program;
mod unit_analysis;
mod unused_outputs;
mod violation;
mod watch;

pub use analysed_net::AnalysedNet;
pub use analysis_summary::AnalysisSummary;
pub use cell::ArmAxes;
pub use compile::{
    CompileOptions, Compiled, Program, UnboundCommand, compile, compile_example, compile_with,
};
pub use coverage_points::CoveragePoints;
pub use doctext::{doc_blocks, doc_links, examples};
pub use duration::{DurationError, format_duration, parse_duration};
pub use external::unlinked_functions;
pub use faults::FaultLocation;
pub use file_loader::{DiskLoader, FileLoader};
pub use input::{Input, InputError, InputKind, read, read_error, utf8};
pub use inspect::{Focus, Inspection, inspect};
pub use library::{library_modules, library_text};
pub use lowering::{
    LowerError, lower_for_execution, lower_for_observation, lower_for_observation_in_tick,
    lower_for_tick, lower_with_work,
};
pub use machine::{MACHINE, MachineError, machine_text, read_machine};
pub use node::{CompiledNode, Node, compile_node};
pub use points::{PointsError, check_points};
pub use program_tests::Test;
pub use project::{MANIFEST, Project, files_of};
pub use rpi_sema::elab::ClaimPolicy;
pub use session::CheckSession;
pub use task::{Task, TaskNode, TaskPlan, TaskPlanError};
pub use typed_program::{TypedProgram, check_typed};
pub use watch::UnknownFlow;
