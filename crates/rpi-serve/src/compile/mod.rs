//! Compilation of the texts of clients, in the process of the server or in worker processes.
//!
//! ```text
//! loader thread -- Compiler -- text (in process)
//!                           -- process == request ==> worker: confinement, text
//!                                     <== answer ===
//! ```
//! A worker process compiles one text and ends. It has limits of memory and time, the lowest priority, and no
//! descriptors but its pipes. Whatever it does costs its client an error and nobody else anything. Its answer is
//! untrusted input: images and plans are verified. Names of devices are resolved in the server.

mod answer;
mod compiler;
#[cfg(unix)]
mod confinement;
mod frame;
#[cfg(unix)]
mod process;
mod request;
mod settings;
mod text;
#[cfg(unix)]
mod worker;
mod worker_error;

pub(crate) use compiler::Compiler;
pub(crate) use request::{CompileKind, CompileRequest, Language, Source};
pub use settings::{CompilerSettings, WorkerSettings};
pub(crate) use text::{CompileOutput, CompiledCommand};
#[cfg(unix)]
pub use worker::run_compile_worker;
