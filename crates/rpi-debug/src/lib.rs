//! Debugger of programs: goes through the cycles of a recording forwards and backwards, and shows the value of every flow.
//!
//! A recording holds what the core exchanged with its devices and clients. The debugger compiles its program again with all flows
//! observable, and replays it: each cycle can be computed again, bit for bit (a record-replay debugger, as O'Callahan et al.,
//! Engineering record and replay for deployability, 2017). Conditions are equations of the language, which are compiled with the
//! program.
//!
//! | file | idea |
//! |---|---|
//! | `program.rs` | the program of a recording, compiled again |
//! | `insertion.rs` | where an equation can be added to a text |
//! | `flow_table.rs` | the named flows of a command, in the order of their evaluation |
//! | `stop.rs` | the values of the running commands in one cycle |
//! | `breakpoint.rs` | where a run stops |
//! | `error.rs` | errors |
//! | `debugger.rs` | goes to cycles, and evaluates expressions |
//! | `dap/` | Debug Adapter Protocol, for editors |
//! | `terminal.rs` | lines of commands |

mod breakpoint;
mod dap;
mod debugger;
mod error;
mod flow_table;
mod insertion;
mod program;
mod stop;
mod terminal;

pub use breakpoint::{Breakpoint, Hit, Trigger};
pub use dap::{Launch, serve};
pub use debugger::{Debugger, ExpressionId};
pub use error::DebugError;
pub use flow_table::{Flow, FlowTable};
pub use program::{ALL_FLOWS, CompiledForReplay, Lowering, RecordedProgram, RecordedProgramError};
pub use stop::{RunningCommand, Stop};
pub use terminal::terminal;
