//! Recordings of everything a control core did: MCAP files that viewers can open and that can be replayed.
//!
//! ```text
//! cycle thread: Taped devices, Watcher -> tape (bounded ring, losses are counted) -> Scribe (a thread) -> MCAP
//! host:         requests before they are sent, events as they arrive -----------------^
//! ```
//! | in the file | content |
//! |---|---|
//! | `/command/NAME` | exported flows of a command in each cycle, JSON |
//! | `/sensors/DEVICE`, `/set_points/DEVICE` | values that commands read from a device and set-points that they wrote to it, JSON |
//! | `/device/DEVICE` | state of a device after each tick, JSON |
//! | `/events` | starts, ends, takeovers, faults, answers to requests, lost ticks, JSON |
//! | `/rpi/requests` | requests to the core, JSON |
//! | `/rpi/tape` | the [tape](rpi_runtime::tape): bit-exact log of each tick |
//! | attachments | cell description, source of the program, images |
//! | metadata `rpi`, `rpi-end` | tick length, policy, program; number of ticks written and lost |
//!
//! [`rerun()`] replays a recording: it makes the same requests in the same ticks on a core whose devices are the tape,
//! and compares every flow, set-point and event. This module must not depend on the compiler.

mod asked;
mod checksum;
mod error;
mod file;
mod json;
mod names;
mod read;
mod recorder;
mod report;
mod rerun;
mod told;
mod writer;

pub use error::RecordingError;
pub use file::Output;
pub use read::Recording;
pub use recorder::{Origin, Recorder, Wanted, record};
pub use report::{Difference, Rerun};
pub use rerun::rerun;
