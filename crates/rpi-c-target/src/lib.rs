//! Images translated to C: compilation, execution, and comparison with the core. The crate is independent of nets, sources
//! and concrete devices.
//!
//! | file | subject |
//! |---|---|
//! | `compiler.rs` | the C compiler |
//! | `cortex_m4.rs`, `cortex_m4/` | compiler and emulator of a microcontroller |
//! | `process.rs` | the running program and its cycles |
//! | `core_cycle.rs` | what the core has computed in a cycle |
//! | `shadow.rs` | the program in C beside the core, compared bit by bit |
//! | `lockstep.rs` | the same cycles in the core and in C, with devices |
//! | `external.rs` | functions in C that a program in the core calls |
//! | `fmu.rs`, `archive.rs` | libraries and archives of Functional Mock-up Units |

mod archive;
mod compiler;
mod core_cycle;
mod cortex_m4;
mod external;
mod fmu;
mod lockstep;
mod process;
mod shadow;

pub use compiler::{CBinary, CCompiler, CTargetError};
pub use cortex_m4::{Footprint, footprint};
pub use external::{ExternalBank, ExternalError, ExternalProcess};
pub use fmu::package;
pub use lockstep::Lockstep;
pub use process::{CCycle, CProcess, CProgram, DeviceCall};
pub use shadow::{Difference, Shadow};
