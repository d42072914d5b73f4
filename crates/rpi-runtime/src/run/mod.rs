//! Execution of tasks against a simulated cell, on simulated or real time.
//!
//! ```text
//! host side: tasks plan ahead, recording, display   cycle side: ticks, and nothing else
//!   Host::serve -> control::Control  <-- queues -->  control::Executive <- Cycle::tick
//! ```
//! A task is an ordinary client of the control core: it loads the commands that may follow and adds rules. On simulated
//! time both sides alternate on one thread, so that the same run gives the same bits. On real time the cycle has a
//! thread of its own.

mod camera;
mod cycle;
mod devices;
mod drive;
mod end;
mod host;
mod inputs;
mod job;
mod outcome;
mod plan;
mod print;
mod recorder;
mod samples;
mod share;
mod sides;
mod sights;
mod task;
mod walk;

pub(crate) use print::time as time_text;

pub use camera::Camera;
pub use end::{fault_text, jump_text, stop_text};
pub use inputs::{BadSetting, Setting};
pub use job::{Failure, Job, Limits, Progress, run};
pub use outcome::{Blame, CommandEnd, DeviceEnd, FaultOrigin, Outcome, RunEnd, Status, Trouble};
pub use plan::{Node, Plan};
pub use recorder::{Recorded, RunRecorder, StartRecording, Written};
pub use samples::{Channel, Several, Sink, Source};
pub use share::Share;
pub use sides::sampled_flows;
pub use sights::Sights;
pub use task::{NotStarted, Task, TaskEnd, Workshop};
