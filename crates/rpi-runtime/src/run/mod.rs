//! Execution of tasks against a simulated cell, on simulated or real time.
//!
//! ```text
//! host side: tasks plan ahead, recording, display   cycle side: ticks, and nothing else
//!   Host::serve -> control::Control  <-- queues -->  control::Executive <- Cycle::tick
//! ```
//! A task is an ordinary client of the control core: it loads the commands that may follow and adds rules. On simulated
//! time both sides alternate on one thread, so that the same run gives the same bits. On real time the cycle has a
//! thread of its own.

mod budget_check;
mod collector;
mod cycle;
mod devices;
mod end_text;
mod host;
mod inputs;
mod job;
mod outcome;
mod plan;
mod plan_cursor;
mod plan_verify;
mod print;
mod probe;
mod recorder;
mod run_loop;
mod samples;
mod setup;
mod task_runner;

pub(crate) use print::format_duration as time_text;

pub use budget_check::RunBudget;
pub use collector::TickCollector;
pub use devices::sampled_channels;
pub use end_text::{
    abort_text, actuator_discontinuity_text, fault_advice, fault_message, fault_text,
};
pub use inputs::{InputSetting, InputSettingError, ParseInputSettingError};
pub use job::{Limits, Progress, RunError, RunOptions, run};
pub use outcome::{
    CommandEnd, CommandOverruns, DeviceEnd, DeviceProblem, FaultOrigin, Outcome, RunEnd, Status,
};
pub use plan::{ExecutablePlan, Node, PlanError};
pub use probe::FlowProbe;
pub use recorder::{Recorded, RecordingStats, RunRecorder, StartRecording};
pub(crate) use run_loop::SERVE_PERIOD;
pub use samples::{Channel, Sink, SinkList, Source};
pub use setup::sampled_flows;
pub use task_runner::{NotStartedError, Task, TaskCore, TaskEnd};
