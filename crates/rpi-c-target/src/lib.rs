//! Images translated to C: compilation, execution, and comparison with the core. The crate is independent of nets, sources
//! and concrete devices.
//!
//! | file | subject |
//! |---|---|
//! | `compiler.rs` | the C compiler |
//! | `process.rs` | the running program and its cycles |
//! | `lockstep.rs` | the same cycles in the core and in C, compared bit by bit |

mod compiler;
mod lockstep;
mod process;

pub use compiler::{CBinary, CCompiler, CTargetError};
pub use lockstep::{Difference, Lockstep};
pub use process::{CCycle, CProcess, DeviceCall};
