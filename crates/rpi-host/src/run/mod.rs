//! Running commands one after the other against a simulated cell, on simulated or on real time.
//!
//! ```text
//! host side: loads, frees, records, shows          cycle side: ticks, and nothing else
//!   Host::serve -- ready commands -->                Cycle::tick -> Core, devices
//!               <-- events, samples, dead commands --
//! ```
//! The two sides share nothing but bounded queues. On simulated time they take turns on one thread, so that the same
//! run gives the same bits; on real time the cycle has a thread of its own.

mod clock;
mod cycle;
mod devices;
mod directory;
mod drive;
mod figures;
mod host;
mod inputs;
mod job;
mod links;
mod outcome;
mod print;
mod samples;
mod sequence;
mod sides;

pub(crate) use host::fault_text;

pub use clock::Pace;
pub use figures::{Figures, Spread};
pub use inputs::{BadSetting, Setting};
pub use job::{Failure, Job, Limits, Progress, run};
pub use outcome::{CommandEnd, DeviceEnd, Outcome, RunEnd, Status, Trouble};
pub use samples::{Channel, Several, Sink, Source};
pub use sequence::{Item, Sequence};
