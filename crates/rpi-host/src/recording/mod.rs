//! Recordings: everything that a control core did, in an MCAP file that viewers open and that can be run again.
//!
//! ```text
//! cycle thread: Taped devices, Watcher -> tape (bounded ring, losses counted) -> Scribe (a thread) -> MCAP
//! host:         requests before they leave, events as they come ------------------^
//! ```
//! | in the file | what it is |
//! |---|---|
//! | `/command/NAME` | exported flows of a command, JSON, each cycle |
//! | `/sensors/DEVICE`, `/set_points/DEVICE` | what commands read of a device and handed over to it, JSON |
//! | `/device/DEVICE` | where a device is after each tick, JSON |
//! | `/events` | starts, ends, switches, faults, answers to requests, losses, JSON |
//! | `/rpi/requests` | what was asked of the core, JSON |
//! | `/rpi/tape` | the [tape](crate::tape): each tick bit for bit |
//! | attachments | the cell, the program's text, the images |
//! | metadata `rpi`, `rpi-end` | tick, policy, program; how many ticks were written and lost |
//!
//! [`rerun()`] makes the same requests in the same ticks of a core whose devices are the tape, and compares every flow,
//! set-point and event. This module must not know how programs are compiled.

mod asked;
mod camera;
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

pub use camera::{Camera, record};
pub use error::RecordingError;
pub use file::Output;
pub use read::Recording;
pub use recorder::{Origin, Recorder, Wanted};
pub use report::{Difference, Rerun};
pub use rerun::rerun;
pub(crate) use told::number_of;
pub use writer::Written;

pub use crate::tape::Taped;
